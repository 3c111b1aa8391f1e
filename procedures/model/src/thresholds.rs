//! Every threshold of the diagnosis and of the data checks: value, unit, meaning, and what it was calibrated on.
//!
//! Thresholds that are fractions share four round levels where no recording or simulated run decides otherwise.
//! Numerical guards and published quantiles stay where they are used. `evaluate` is `cargo run --release -p
//! jointbench-model --example evaluate --`, `--test` a test of this crate. The tables in docs/diagnosis.md are printed
//! from these lists, and a test holds both together.

/// A share that several decisions use.
pub struct Level {
    /// Name of the constant.
    pub name: &'static str,
    /// Its value, a fraction.
    pub value: f64,
    /// What it stands for.
    pub meaning: &'static str,
}

/// One threshold, as the documents show it.
pub struct Threshold {
    /// Name of the constant.
    pub name: &'static str,
    /// Its value in `unit`.
    pub value: f64,
    /// Its value as it is written: the name of a level, or a number.
    pub written: &'static str,
    /// Quantity that the value counts or is a share of.
    pub unit: &'static str,
    /// Decision that uses it.
    pub meaning: &'static str,
    /// The command, runs or convention that it comes from.
    pub calibrated_on: &'static str,
}

macro_rules! levels {
    ($($name:ident = $value:literal, $meaning:literal;)*) => {
        $(#[doc = $meaning] const $name: f64 = $value;)*

        /// All levels, in the order of the documents.
        pub const LEVELS: &[Level] = &[$(Level { name: stringify!($name), value: $value, meaning: $meaning }),*];
    };
}

/// Constants, and the list that prints them.
#[macro_export]
macro_rules! thresholds {
    (
        $(#[$doc:meta])* $list:ident:
        $($name:ident = $value:expr, $unit:literal, $meaning:literal, $calibrated:literal;)*
    ) => {
        $(#[doc = concat!($meaning, " [", $unit, "]")] pub const $name: f64 = $value;)*

        $(#[$doc])*
        pub const $list: &[$crate::thresholds::Threshold] = &[$($crate::thresholds::Threshold {
            name: stringify!($name),
            value: $value,
            written: stringify!($value),
            unit: $unit,
            meaning: $meaning,
            calibrated_on: $calibrated,
        }),*];
    };
}

levels! {
    TENTH = 0.1, "enough to matter";
    HALF = 0.5, "the larger part";
    MOST = 0.7, "most of it";
    NEARLY_ALL = 0.9, "as good as all of it";
}

thresholds! {
    /// Values of the decision that are convention, published or computed, in the order of the documents.
    CONVENTIONS:
    ALPHA = 0.05, "probability", "family-wise error of everything that is named or shown (`Options::alpha`)", "convention; `evaluate --part null` measures 0.4 %";
    FLIPS = 499.0, "sign flips", "permutations of the max-T test (`Options::flips`)", "smallest p-value 0.002";
    ONE_ERROR = 1.0, "standard errors", "the gain of an effect exceeds its own standard error over blocks so many times", "one-standard-error rule (Breiman and others 1984)";
    TIE_ERRORS = 2.0, "standard errors", "two models, or two orders of a wave, tie where their validation errors differ by less", "normal distribution, 5 %";
    DELAY_ROWS = 1.5, "rows", "a shorter delay is not named: two readings of a row lie up to a row apart, and a held value lags by half a row", "computed; seven mock runs, 0.9 to 1.1 rows late";
    MOST_EFFECTS = 4.0, "effects", "largest number of effects that a diagnosis adds", "presentation";
    RANGE_MARGIN = 0.02, "fraction of range", "so far beyond the fitted range is not beyond", "presentation";
}

thresholds! {
    /// Tuned thresholds of the decision, in the order of the documents: which effects are named, and the verdict.
    DECISION:
    PRACTICAL_SHARE = 0.02, "fraction of squared error", "smallest fraction of the remaining error that is worth a name (`Options::practical_share`), or shows in a map", "`evaluate --part power`";
    DECISION_SHARE = 0.03, "fraction of squared validation error", "smallest fraction that an effect must take where samples are judged", "`evaluate FOLDER`: flat from 2 to 5 %";
    LEFT_SHARE = TENTH, "fraction of squared validation error", "a residual map, a function of an axis, a line in time or neighbouring moments that take more are structure; a rejected effect that takes more is listed; an effect at a bound, or with unexplained structure, has to take more", "nulls of `evaluate FOLDER`; well-explained runs in steps: at most 11 %";
    FORMULA_ERROR = 0.002, "fraction of squared error", "the formula of an effect may leave this fraction of its contribution (4.5 % in RMS; encoders none)", "`evaluate --part hidden,null`";
    LARGER_PART = HALF, "fraction of squared error", "an effect that removes more of the residual is no remainder of another formula; more in common to all repeats is structure; an effect whose size may be zero has to remove more; a wave of which more is missing at other speeds is an alias", "the larger one of two parts; `evaluate --part hidden,null`, `--test beats`";
    SAME_SHAPE = NEARLY_ALL, "fraction of squared column", "a column that others reproduce to this fraction has their shape: that of the model, a function of an axis, an offset of each leg", "`--test humps`, `--test legs`; mock joint A, seeds 17001 to 17012";
    SIMPLER_GAIN = 0.8, "fraction of gain", "a simpler effect is preferred where it has this fraction of the gain of the best", "`evaluate --part hidden,null`";
    BIASED_COEFFICIENT = 0.25, "fraction of coefficient", "a coefficient that moves by this fraction with an effect is biased without it", "mock joint A, seeds 17001 to 17012; `evaluate --part hidden --first 70500`: without it one wrong name";
    MOST_EXPLAINED = MOST, "fraction of squared error", "an effect explains this fraction of what any function of its axis explains, or of the residual around reversals; otherwise it is only a part of the missing effect", "`--test humps`; simulated joints around reversals: presliding 83 to 98 %, nothing else above 63 %";
    PERIODS_SEEN = 2.0, "periods", "a wave that was seen less often is a curve over the angle", "`--test waves`";
    WHOLE_CURVE = 0.98, "fraction of what any function of the axis explains", "the bound for such a wave", "`--test waves`";
    FLOOR_RATIO = 1.3, "ratio of RMS", "a validation error beyond this multiple of the noise floor is structure; form error in the place of a friction direction must not be better by more", "`evaluate --part hidden,null`";
    EVENT_ERRORS = 7.0, "standard deviations", "a section whose mean exceeds the scatter of sections of its length by this, and half a count of the encoders, is an event", "`evaluate --part null`: none in 800 runs; readings that jump: 7.4 to 51";
    NEGLIGIBLE_RMS = 0.002, "fraction of RMS of the response", "a residual below this is negligible (encoders excepted)", "`evaluate --part hidden,null`; `--test loops`, `--test past`";
    FOLD_COVERAGE = 0.05, "fraction of squared column", "folds without a fold that hold less do not decide its coefficient", "`--test loops`";
    WIDE_INTERVAL = 10.0, "ratio of limits", "a nonlinear parameter or a noise floor with a wider interval is not identified", "`--example coverage`, `--test repeats`";
}

thresholds! {
    /// Thresholds of the report and of the next run, in the order of the documents: they change what is said of an effect
    /// or a region, never which effect is named.
    REPORT:
    REGION_OVERLAP = MOST, "fraction of region", "regions that overlap this much are one failure", "presentation";
    REGION_WORSE = 1.5, "ratio", "unless one is this much worse", "presentation";
    AXIS_DOMINATES = HALF, "fraction of squared error", "an axis whose function removes this fraction is where the model fails", "presentation";
    AXIS_SHADOW = NEARLY_ALL, "fraction of that", "an axis that removes less than this fraction of it is only its shadow", "presentation";
    SECOND_AXIS_GAIN = 1.1, "ratio", "a second axis is named where both show this much more", "presentation";
    NOTHING_IN_COMMON = 0.01, "fraction of squared error", "less in common to all repeats is nothing", "presentation";
    LISTED_LOSS = 0.99, "ratio of validation RMS", "a rejected effect is listed where it would lower the error to this ratio", "presentation";
    SMALL_REDUCTION = 0.05, "fraction of validation RMS", "a smaller reduction is small", "presentation";
    STRONG_P_VALUE = 0.01, "probability", "a larger p-value is weak evidence", "convention";
    MASKED_RATIO = 2.0, "ratio", "effects whose joint gain exceeds this multiple of the single one mask each other", "`evaluate --part hidden,null`";
    DETECTION_POWER = 1.3, "standard errors", "added to the critical size for 80 % power (z₀.₈ = 0.84, the rest for the scatter of the standard error)", "`evaluate --part detectable`";
    OWN_SCATTER_SHARE = TENTH, "fraction of variance", "least fraction of the scatter of a score that counts as noise", "`evaluate --part detectable`";
    TRADE_OFF_CORRELATION = 0.95, "correlation", "parameters that are correlated more trade off, and time that moves so with the temperature is confounded with it", "presentation";
    COLUMN_CORRELATION = NEARLY_ALL, "correlation", "a column that moves with the temperature may be the cause as well", "presentation";
    BEYOND_SHARE = 0.01, "fraction of points", "fewer points beyond are not listed", "presentation";
    ELEMENT_WEIGHT = 0.05, "fraction of Coulomb friction", "a bristle with less weight is not stated", "presentation";
    WIDER_INTERVAL = 1.5, "ratio", "an interval that is so much wider in a comparison is stated", "presentation";
    FEWER_ROWS = 0.8, "ratio", "and fewer rows, or a smaller error, are the reason", "presentation";
    SEPARATED_Z = 4.0, "standard deviations", "models are separated where their predictions lie this far apart", "`--test next_run`";
    USELESS_Z = 1.0, "standard deviations", "a run that separates less is not recommended", "`--test next_run`";
    NEARLY_COVERED = NEARLY_ALL, "fraction of speed or load", "so much of a speed or load is as good as all of it", "presentation";
    WORTH_SEEING = 0.05, "fraction of response", "an unseen effect below this size is not worth a run; one whose detection limit is larger is not testable: it could hide an effect that is worth a run", "`--test next_run`";
}

thresholds! {
    /// Thresholds of the signals, in the order of the documents: which rows are compared, and which effects a run can show.
    SIGNALS:
    NOISE_ERRORS = 3.0, "standard errors", "what noise hardly ever reaches by chance: structure of samples, what an alias misses, a step or a delay in time", "normal distribution, 0.3 %";
    SETTLED_SHARE = 0.04, "fraction of size", "speed and load of a steady state deviate less from their median", "`--test steps`";
    KEPT_SHARE = 0.2, "fraction of speed", "the halves of a steady state differ less, in addition to their scatter", "`--test steps`";
    STEADY_SPEED = 5.0, "scatters", "a mean speed of a steady state exceeds its scatter so many times; half as many where the speed oscillates, as in a slow step over gear teeth", "`--test teeth`";
    EVEN_SPEED = 0.05, "fraction of speed", "speeds that differ less are one constant speed", "`--test legs`, `--test beats`";
    EVEN_PART = 0.4, "fraction of leg", "least part of a leg at constant speed; on the half wave of a sine 0.28 of the speeds are nearly equal", "computed";
    RECORDING_GAP = 10.0, "samples", "a longer gap in time begins another recording", "`--test past`";
    RECORDING_JUMP = 50.0, "usual changes", "so does a larger jump of the position, if it exceeds 0.5 rad", "`--test past`";
    TREND_NOISES = 6.0, "standard deviations", "a trend changes where the signal has left its extreme by more", "normal distribution, for the samples of a run";
    OTHER_DIRECTION = TENTH, "fraction of samples", "a run that moves back in fewer has one direction, if its swings are short", "unit tests of `segments`";
    SWING = 0.01, "fraction of travel", "a swing back is short if it is smaller", "unit tests of `segments`";
    PERIOD_CORRELATION = 0.98, "correlation", "a signal that correlates more with itself after a time has this period", "unit tests of `segments`";
    ON_MULTIPLES = HALF, "resultant length", "readings are multiples of a count if their phase in it has a larger one: a noise below 0.19 counts", "computed";
    OFF_MULTIPLES = 0.25, "resultant length", "and the motion that the torque predicts has a smaller one", "unit tests of `held_side`";
    CURVE_RANGE = 3.0, "ratio of speeds or torques", "a curve over speed or torque is determined from this ratio on", "`evaluate --part hidden`";
    SAME_TURNS = 0.01, "fraction of turns", "motor and link that turn alike have no gear between their angles", "`--test one_way`";
    OSCILLATION = NEARLY_ALL, "correlation", "speeds without a common sample correlate so much where the motion itself oscillates", "unit tests of `residual_acceleration`";
    SAME_MOTION = 0.02, "fraction of variance", "the inputs of two repeats differ by less", "`--test repeats`";
    SAME_LENGTH = 0.3, "fraction of length", "steps at one speed whose lengths differ by more start at other positions: other conditions", "`--test repeats`";
    SMALL_LEVEL = 0.01, "fraction of largest value", "set points and loads that differ by less are equal", "`--test repeats`";
    SAME_LEVEL = 0.03, "fraction of set point", "equal set points, loads and states of a hysteresis differ by less; set points share a bin of a map", "`--test repeats`";
    PAIRS_EACH_ROW = 0.25, "pairs", "with fewer pairs for each row, repeats are compared by phase", "`--test repeats`";
    SAME_ANGLE = 0.2, "fraction of RMS", "angles of repeats that differ by more, relative to unrelated angles, are unrelated", "`--test repeats`";
    DWELL_NOISE = TENTH, "fraction of usual step", "if the median change is larger, the current has no dwells", "`--test iron`";
    DWELL_CHANGE = 0.01, "fraction of usual step", "the current of a dwell changes by less", "`--test iron`";
    DWELL_NOISES = 5.0, "median changes", "or by less than this", "`--test iron`";
    HISTORY_SHARE = TENTH, "fraction of squared error", "an unknown initial state of the hysteresis explains so much", "`--test past`";
    GRAVITY_OWN_SHARE = 0.01, "fraction of squared column", "motion and measured load leave so much of a wave over the link angle", "`--test poses`";
    GRAVITY_SHARE = 0.02, "partial R²", "such a wave explains so much: gravity that is not measured", "`--test poses`";
    AT_REST = 1e-3, "fraction of fastest speed", "a slower operating point is at rest", "`--test operating_points`";
    LOAD_OF_DRIVE = 0.2, "fraction of RMS of motor torque", "a smaller load is the noise of its sensor", "`--test measured`";
    LOADED_ROWS = 0.05, "fraction of rows", "a load that is larger in so many rows is a load", "`--test measured`";
    COGGING_TURN = 0.33, "turns", "least covered part of a turn for a wave over the motor angle", "`evaluate --part hidden`";
    WHOLE_TURN = 0.8, "turns or periods", "an angle that covers more covers a whole turn; least part of the longest wave over the link angle where samples are judged", "`evaluate FOLDER`";
    FOLLOWED_ROWS = 0.02, "fraction of rows", "the filter passes the highest order of an angle in so many rows", "`evaluate FOLDER`";
    DRIFT_START = TENTH, "fraction of run", "earliest time constant of a drift", "`evaluate --part hidden`";
    SEVERAL_SPEEDS = 1.2, "ratio", "speeds of a brake with a smaller ratio are one", "`evaluate --part hidden`";
    KURTOSIS_ERRORS = 4.0, "standard errors", "changes of an offset with a larger excess kurtosis are events and no random walk", "`--test repeats`";
    NO_CURRENT = 0.02, "fraction of largest current", "a smaller current of a brake is zero", "`--test iron`";
    DRIVE_AXIS = NEARLY_ALL, "fraction", "the map over the motor torque, which follows from the motion, is ranked by this fraction of what it removes", "presentation";
    TIME_AXIS = NEARLY_ALL, "correlation", "an axis that correlates more with time is time", "presentation";
}

thresholds! {
    /// Thresholds of the data checks, in the order of the documents: they decide on a warning or a refusal, never on an effect.
    CHECKS:
    CHECK_BLOCK_S = 0.2, "s", "columns are compared over blocks of this length: short enough for a reversal, long enough for coarse encoders", "unit tests of `unit_mismatch`";
    CLASH_RATIO = 1.2, "ratio", "columns or facts that state the same quantity differ by less: rounding, filters, delay, torsion", "unit tests of `unit_mismatch` and `metadata`";
    IN_COMMON = NEARLY_ALL, "fraction of variance", "two columns with less in common are not compared", "unit tests of `unit_mismatch` and `torque_sign`";
    ALIKE_BLOCKS = 0.6, "fraction of blocks", "an angle within one turn agrees with the other one in at least so many blocks", "unit tests of `unit_mismatch`";
    ALIKE_RATIO = TENTH, "fraction of ratio", "blocks that agree so well with the median agree", "unit tests of `unit_mismatch`";
    GEAR_ERROR = 0.01, "fraction of gear ratio", "a larger error of the gear ratio is a warning", "one tooth of 100";
    GEAR_TRAVEL_RAD = 1.0, "rad", "least travel of the link for this check", "unit tests of `unit_mismatch`";
    GEAR_SPEED = HALF, "fraction of fastest speed", "slower blocks are not compared, because the joint twists at reversals", "unit tests of `unit_mismatch`";
    FINE_ANGLES = 0.999, "fraction of variance", "with less in common one of the angles is too coarse for this check", "unit tests of `unit_mismatch`";
    CLAMPED_RAD = 0.1, "rad", "an angle that moves less may be clamped", "a joint twists less";
    COMPUTED_COLUMN = 1e-5, "fraction of RMS", "a load that equals a multiple of the current to this fraction was computed from it", "digits of a text file";
    DRIVEN_WORK = HALF, "fraction of work", "more work against the motion in both directions is a wrong sign", "unit tests of `unit_mismatch`";
    NOISE_BLOCKS = 40.0, "blocks", "fewer blocks do not show that a current is white noise", "unit tests of `unit_mismatch`";
    TORQUE_RATIO = 2.0, "ratio", "motor and link torque differ by less: efficiency of the gear, friction under load", "unit tests of `torque_sign`";
    SLIPPED_IN_COMMON = MOST, "fraction of variance", "the two torques have so much in common where a unit or sign is wrong; the rest is friction", "unit tests of `torque_sign`";
    LOAD_SHARE = 0.25, "fraction of RMS", "so much of the torque varies at steady speed: a load", "unit tests of `torque_sign`";
    STEADY_CHANGE = HALF, "fraction of speed", "a speed that changes less is steady in this check", "unit tests of `torque_sign`";
    CANCELLED_WORK = 0.2, "fraction of work", "a magnitude does less net work: its work cancels", "unit tests of `unsigned_current`";
    MAGNITUDE_DIP = TENTH, "fraction of mean", "a magnitude falls so far at reversals, the current against a load does not", "unit tests of `unsigned_current`";
    LARGEST_CURRENT_A = 24.0, "A", "a larger current has another unit, where no rated current is stated", "ten times two coils of 1.2 A, the largest of the data sheets (Magtrol 2025)";
    LARGEST_CURRENT = 20.0, "ratio to rated current", "a larger current of a brake has another unit", "mA for A is 1000";
    SMALL_CURRENT = 0.01, "fraction of rated current", "a current that stays below, and moves the torque, has another unit", "mA for A is 1000";
    LEAST_TORQUE_PER_CURRENT = 0.1, "Nm/A", "smallest plausible torque for each ampere", "data sheets: 4 to 22; a tenth of that for the smallest brakes";
    LARGEST_TORQUE_PER_CURRENT = 220.0, "Nm/A", "largest plausible torque for each ampere", "data sheets: 4 to 22; ten times as much behind a gear of 1:10";
    BRAKE_MARGIN = 3.0, "ratio", "a torque for each ampere so far beyond these limits has another unit", "mA for A is 1000";
    CURRENT_IN_COMMON = 0.2, "fraction of variance", "the current of a brake explains at least so much of its torque", "unit tests of `brake_range`";
    VARYING_CURRENT = TENTH, "fraction of largest current", "a current that varies less is constant", "unit tests of `brake_range`";
    FINE_READINGS = NEARLY_ALL, "fraction of samples", "where fewer neighbours differ, the column is too coarse for the next checks", "unit tests of `sensor_faults`";
    STUCK_S = 0.3, "s", "shortest time with one value during motion of a stuck sensor", "unit tests of `sensor_faults`";
    STUCK_SAMPLES = 40.0, "samples", "least number of samples in that time", "unit tests of `sensor_faults`";
    SATURATED_SAMPLES = 4.0, "samples", "so many samples at the end of a range in a row are saturated", "unit tests of `sensor_faults`";
    SATURATED_SHARE = 0.003, "fraction of samples", "fewer saturated samples are no warning", "unit tests of `sensor_faults`";
    SPIKE_CHANGES = 25.0, "usual changes", "an outlier differs so far from both neighbours", "unit tests of `sensor_faults`";
    SPIKE_RANGE = 0.15, "fraction of range", "and so far", "unit tests of `sensor_faults`";
    SPIKE_COUNTS = 1.5, "counts", "and so far: a reading that flickers by one count of its resolution is no outlier", "unit tests of `sensor_faults`";
    SPIKE_NEIGHBOURS = 0.2, "fraction of outlier", "its neighbours agree to this", "unit tests of `sensor_faults`";
    PULSE_SAMPLES = 5.0, "samples", "the speed before and after an outlier is taken over so many samples", "unit tests of `sensor_faults`";
    PULSE_SPEED = 0.02, "fraction of largest speed", "where the speed changes by more, the drive accelerates, and the pulse is no fault", "unit tests of `sensor_faults`";
    HELD_IN_COMMON = HALF, "fraction of variance", "the twist of a clamped joint has so much in common with the torque", "`field-cases`";
}

/// The tables of docs/diagnosis.md: levels, conventions and thresholds of the decision, thresholds of the report, of the
/// signals, and of the data checks.
pub fn tables() -> [String; 6] {
    let level = |l: &Level| format!("| {} | {} | {} |\n", l.name, l.value, l.meaning);
    let levels: String = LEVELS.iter().map(level).collect();
    [
        format!("| level | value | means |\n| --- | --- | --- |\n{levels}"),
        table(CONVENTIONS),
        table(DECISION),
        table(REPORT),
        table(SIGNALS),
        table(CHECKS),
    ]
}

/// One list as the documents show it.
pub fn table(list: &[Threshold]) -> String {
    let row = |t: &Threshold| {
        let level = if LEVELS.iter().any(|l| l.name == t.written) { t.written } else { "" };
        format!("| {} | {} | {level} | {} | {} | {} |\n", t.name, t.value, t.unit, t.meaning, t.calibrated_on)
    };
    let rows: String = list.iter().map(row).collect();
    format!(
        "| threshold | value | level | unit | decides | calibrated on |\n| --- | --- | --- | --- | --- | --- |\n{rows}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_documents_show_every_level_and_threshold() {
        let docs = include_str!("../../../docs/diagnosis.md");
        let missing = tables().into_iter().filter(|table| !docs.contains(table));
        let missing: String = missing.collect::<Vec<_>>().join("\n");
        assert!(missing.is_empty(), "replace the tables of thresholds in docs/diagnosis.md with:\n{missing}");
    }

    #[test]
    fn no_two_thresholds_share_a_name() {
        let mut names: Vec<&str> = CONVENTIONS
            .iter()
            .chain(DECISION)
            .chain(REPORT)
            .chain(SIGNALS)
            .chain(CHECKS)
            .map(|t| t.name)
            .chain(LEVELS.iter().map(|l| l.name))
            .collect();
        names.sort_unstable();
        assert!(names.windows(2).all(|pair| pair[0] != pair[1]), "{names:?}");
    }
}
