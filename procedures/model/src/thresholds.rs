//! Every threshold of the diagnosis: value, unit, meaning, and what it was calibrated on.
//!
//! Numerical guards and published quantiles stay where they are used. `evaluate` is
//! `cargo run --release -p jointbench-model --example evaluate --`, `--test` a test of this crate. The table in
//! docs/diagnosis.md is printed from this list, and a test holds both together.

/// One threshold, as the documents show it.
pub struct Threshold {
    /// Name of the constant.
    pub name: &'static str,
    /// Its value in `unit`.
    pub value: f64,
    /// Quantity that the value counts or is a share of.
    pub unit: &'static str,
    /// Decision that uses it.
    pub meaning: &'static str,
    /// The command, runs or convention that it comes from.
    pub calibrated_on: &'static str,
}

macro_rules! thresholds {
    ($($name:ident = $value:literal, $unit:literal, $meaning:literal, $calibrated:literal;)*) => {
        $(#[doc = concat!($meaning, " [", $unit, "]")] pub const $name: f64 = $value;)*

        /// All of them, in the order of the documents.
        pub const ALL: &[Threshold] = &[$(Threshold {
            name: stringify!($name),
            value: $value,
            unit: $unit,
            meaning: $meaning,
            calibrated_on: $calibrated,
        }),*];
    };
}

thresholds! {
    ALPHA = 0.05, "probability", "family-wise error of everything that is named or shown (`Options::alpha`)", "convention; `evaluate --part null` measures 0.4 %";
    PRACTICAL_SHARE = 0.02, "fraction of squared error", "smallest fraction of the remaining error that is worth a name (`Options::practical_share`), or shows in a map", "`evaluate --part power`";
    FLIPS = 499.0, "sign flips", "permutations of the max-T test (`Options::flips`)", "smallest p-value 0.002";
    DECISION_SHARE = 0.03, "fraction of squared validation error", "smallest fraction that an effect must take where samples are judged", "`evaluate FOLDER`: flat from 2 to 5 %";
    LEFT_SHARE = 0.1, "fraction of squared validation error", "a function of an axis, a line in time or neighbouring moments that take more are structure", "nulls of `evaluate FOLDER`";
    LEFT_ERRORS = 3.0, "standard errors", "and exceed their own error so many times", "nulls of `evaluate --part styles --first 300000 --family friction`";
    FORMULA_ERROR = 0.002, "fraction of squared error", "the formula of an effect may leave this fraction of its contribution (4.5 % in RMS; encoders none)", "`evaluate --part hidden,null`";
    UNMISTAKABLE_SHARE = 0.5, "fraction of squared error", "an effect that removes this fraction of the residual is no remainder of another formula", "`evaluate --part hidden,null`";
    PERIODIC_SHARE = 0.04, "fraction of squared error", "a wave that is sought among many orders takes at least this fraction", "`evaluate --part hidden,null`";
    MANY_ORDERS = 30.0, "orders", "so many orders are many", "`evaluate --part hidden,null`";
    MEANS_FOLLOW_RAD = 1.5, "rad", "a wave that advances further between two means may be an alias", "`--test beats`";
    ALIAS_SHARE = 0.5, "fraction of amplitude", "a wave that shows less of its amplitude at other speeds is an alias", "`--test beats`";
    ALIAS_ERRORS = 3.0, "standard errors", "and misses it by so many standard errors", "`--test beats`";
    SAME_SPEED = 0.1, "fraction of speed", "speeds this near to each other are one", "`--test beats`";
    COMPARABLE_SPEED = 2.0, "ratio of speeds", "a wave is expected only at speeds up to this ratio: beyond it, the drive controller dominates", "`--test beats`";
    BETWEEN_LEGS = 0.9, "fraction of squared column", "from this fraction on a column differs from leg to leg and hardly within one", "`--test legs`";
    STEP_OVER_READINGS = 2.0, "standard deviations", "a step in time of this size is none of the scatter of the readings", "`--test legs`";
    SIMPLER_GAIN = 0.8, "fraction of gain", "a simpler effect is as good where it brings this fraction of the gain of the best", "`evaluate --part hidden,null`";
    MOST_EXCHANGES = 2.0, "exchanges", "added effects that may be swapped for others", "`evaluate --part hidden,null`";
    STAND_IN_LOSS = 0.9, "ratio of squared validation errors", "a candidate above this ratio to a model that was given up only stands in for it", "`evaluate --part hidden,null`";
    BIASED_COEFFICIENT = 0.25, "fraction of coefficient", "a coefficient that moves by this fraction with an effect is biased without it", "mock joint A, seeds 17001 to 17012";
    BIAS_TOLERANCE = 0.1, "fraction of squared column", "below this fraction of its own an effect looks like the model, or is a function of the axis", "mock joint A, seeds 17001 to 17012";
    HYSTERESIS_SHARE = 0.72, "fraction of squared error", "an effect with a memory explains this fraction around reversals", "simulated joints: 83 to 98 %, nothing else above 63 %";
    DELAY_HALF_WIDTHS = 2.0, "half widths of the 95 % interval", "a delay lies so far from zero", "519 joints without a delay: none; 13 with 9 to 14 ms: at least 2.6";
    DELAY_ROWS = 1.5, "rows", "a delay is longer than this: of which moment of its row a reading is is unknown", "seven mock runs, 0.9 to 1.1 rows late";
    DELAY_POWER = 0.43, "half widths of the 95 % interval", "added to the delay threshold for 80 % power", "z₀.₈ / z₀.₉₇₅";
    DETECTION_POWER = 1.3, "standard errors", "added to the critical size for 80 % power (z₀.₈ = 0.84, the rest for the scatter of the standard error)", "`evaluate --part detectable`";
    NEEDED_WHERE_OPEN = 0.1, "increase of squared validation error", "an effect at a bound, or with unexplained structure, stays where removing it costs this much", "`evaluate --part hidden,null`";
    NEEDED_WITHOUT_SIZE = 0.5, "increase of squared validation error", "the same of an effect whose coefficients could all be zero", "`evaluate --part hidden,null`";
    NEEDED_WITHOUT_SIZE_AND_SHAPE = 1.0, "increase of squared validation error", "the same of an effect of neither size nor shape", "`evaluate --part hidden,null`";
    STRUCTURE_SHARE = 0.15, "fraction of squared validation error", "a residual map that removes more is structure", "null runs: at most 2 %; well-explained runs: 11 %";
    WHOLE_EXPLANATION = 0.7, "fraction of what any function of the axis explains", "an effect that explains less is only a part of the missing effect", "`--test humps`";
    PERIODS_SEEN = 2.0, "periods", "a wave that was seen less often is a curve over the angle", "`--test waves`";
    WHOLE_CURVE = 0.98, "fraction of what any function of the axis explains", "the bound for such a wave", "`--test waves`";
    SAMPLES_FOLLOW_RAD = 1.0, "rad", "a wave that advances further from sample to sample is not followed", "`--test beats`";
    REPEATABLE_SHARE = 0.6, "fraction of squared error", "more in common to all repeats is structure", "`evaluate --part hidden,null`";
    FLOOR_RATIO = 1.3, "ratio of RMS", "a validation error beyond this multiple of the noise floor is structure", "`evaluate --part hidden,null`";
    EVENT_ERRORS = 7.0, "standard deviations", "a stretch that lies so far out of what stretches of its length scatter by, and by more than half a count of the encoders, is an event", "`evaluate --part null`: none in 800 runs; readings that jump: 7.4 to 51";
    NEGLIGIBLE_RMS = 0.002, "fraction of RMS of the response", "a residual below this is negligible (encoders excepted)", "`evaluate --part hidden,null`";
    FLOOR_INTERVAL_RATIO = 3.0, "ratio", "a noise floor with a wider interval is only about", "`--test repeats`";
    SCATTER_BAND = 0.3, "fraction of alpha", "error probability of a band that calls scatter structure", "220 null runs with coloured noise";
    AXIS_FUNCTION = 0.9, "fraction of squared contribution", "a contribution that its map reproduces to this fraction is a function of the axis", "`--test humps`";
    REGION_OVERLAP = 0.7, "fraction of region", "regions that overlap this much are one failure", "presentation";
    REGION_WORSE = 1.5, "ratio", "unless one is this much worse", "presentation";
    AXIS_DOMINATES = 0.5, "fraction of squared error", "an axis whose function removes this fraction is where the model fails", "presentation";
    AXIS_SHADOW = 0.9, "fraction of that", "an axis that removes less than this fraction of it is only its shadow", "presentation";
    OWN_SCATTER_SHARE = 0.25, "fraction of variance", "least fraction of the scatter of a score that counts as noise", "`evaluate --part detectable`";
    FOLD_COVERAGE = 0.05, "fraction of squared column", "folds without a fold that hold less do not decide its coefficient", "`--test loops`";
    COMPONENT_OWN_SHARE = 0.8, "fraction of gain", "a component that keeps this fraction together with another effect explains something else", "`evaluate --part hidden,null`";
    BETTER_FORM = 0.01, "fraction of squared error a parameter", "another form must take this fraction for each parameter more", "`evaluate --part hidden,null`";
    SECOND_AXIS_GAIN = 1.1, "ratio", "a second axis is named where both show this much more", "presentation";
    NOTHING_IN_COMMON = 0.01, "fraction of squared error", "less in common to all repeats is nothing", "presentation";
    TOLD_LOSS = 0.99, "ratio of validation RMS", "a rejected effect is listed where it would lower the error to this ratio", "presentation";
    STRONG_P_VALUE = 0.01, "probability", "a larger p-value is weak evidence", "convention";
    SMALL_REDUCTION = 0.05, "fraction of validation RMS", "a smaller reduction is small", "presentation";
    MASKED_RATIO = 2.0, "ratio", "effects whose joint gain exceeds this multiple of the single one mask each other", "`evaluate --part hidden,null`";
    TRADE_OFF_CORRELATION = 0.95, "correlation", "parameters that are correlated more trade off, and time that moves so with the temperature is confounded with it", "presentation";
    WIDE_INTERVAL = 10.0, "ratio", "a nonlinear parameter with a wider interval is not identified", "`--example coverage`";
    COLUMN_CORRELATION = 0.9, "correlation", "a column that moves with the temperature may be the cause as well", "presentation";
    RANGE_MARGIN = 0.02, "fraction of range", "so far beyond the fitted range is not beyond", "presentation";
    BEYOND_SHARE = 0.01, "fraction of points", "fewer points beyond are not listed", "presentation";
    SEPARATED_Z = 4.0, "standard deviations", "models are separated where their predictions lie this far apart", "`--test next_run`";
    USELESS_Z = 1.0, "standard deviations", "a run that separates less is not recommended", "`--test next_run`";
    NEARLY_COVERED = 0.9, "fraction of speed or load", "so much of a speed or load is as good as all of it", "presentation";
    WORTH_SEEING = 0.05, "fraction of response", "an unseen effect below this size is not worth a run; one whose detection limit is larger is not testable: it could hide an effect that is worth a run", "`--test next_run`";
}

/// The table of docs/diagnosis.md.
pub fn table() -> String {
    let rows = ALL
        .iter()
        .map(|t| format!("| {} | {} | {} | {} | {} |\n", t.name, t.value, t.unit, t.meaning, t.calibrated_on));
    let head = "| threshold | value | unit | decides | calibrated on |\n| --- | --- | --- | --- | --- |\n";
    std::iter::once(head.to_owned()).chain(rows).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_documents_show_every_threshold() {
        let docs = include_str!("../../../docs/diagnosis.md");
        assert!(docs.contains(&table()), "replace the table of thresholds in docs/diagnosis.md with:\n{}", table());
    }

    #[test]
    fn no_two_thresholds_share_a_name() {
        let mut names: Vec<&str> = ALL.iter().map(|t| t.name).collect();
        names.sort_unstable();
        assert!(names.windows(2).all(|pair| pair[0] != pair[1]), "{names:?}");
    }
}
