//! Every threshold that decides on the result of a procedure. docs/verdicts.md prints the table from this list.
//!
//! The models that procedures compare have the thresholds of [`jointbench_model::thresholds`].

use jointbench_model::thresholds;
#[cfg(test)]
use jointbench_model::thresholds::table;

thresholds! {
    /// All thresholds, in the order of the documents.
    ALL:
    AMBIGUOUS_COULOMB = 0.15, "fraction of Coulomb torque", "a Coulomb torque that changes by more, if quadratic drag replaces the Stribeck effect, is not determined", "chosen, not calibrated";
    LINE_SPAN = 0.7, "fraction of highest speed", "the line over speed starts at most at this speed, so that it spans several speeds", "geometry of the default speeds";
    SMALL_RISE = 0.1, "fraction of Coulomb torque", "a smaller Stribeck rise is negligible", "chosen, not calibrated";
    EXPLAINED = 0.9, "r²", "from this value on, speed explains the friction of one direction", "chosen, not calibrated";
    SMALL_REST = 0.02, "fraction of Coulomb torque", "it also explains friction whose residual has a smaller RMS", "chosen, not calibrated";
    LEAST_SPAN_K = 2.0, "K", "with a smaller temperature span the result is inconclusive", "chosen, not calibrated";
    NO_CHANGE = 0.01, "fraction of friction", "a smaller change with temperature is none", "chosen, not calibrated";
    FASTER_LEG = 1.05, "ratio of speeds", "a faster leg magnetises or demagnetises the brake and is no stroke", "geometry of the profile";
    VAGUE_OFFSET = 0.5, "half interval relative to the offset", "from this value on, an offset is not determined", "chosen, not calibrated";
    BETTER_CURVE = 0.85, "ratio of validation RMS", "a nonlinear curve replaces the line if its error is smaller", "chosen, not calibrated";
    SAME_CURVE = 0.005, "fraction of torsion", "curves whose errors differ by less are equally good, because no formula is exact", "chosen, not calibrated";
    LOST_MOTION = 0.03, "fraction of highest torque", "lost motion is the torsion within this torque to either side", "catalogues of strain wave gears: 3 or 4 % of the rated torque";
    WIDEST_PRESLIDING = 0.25, "half interval relative to the value", "a parameter with a wider interval is not identified", "chosen, not calibrated";
    SAME_AMPLITUDE = 0.05, "fraction of torque", "steps whose largest torques differ by less have the same amplitude", "geometry of the default amplitudes";
    JOLT = 0.05, "fraction of peak torque", "a torque that rises by more within 0.1 s has a dynamic part", "a smaller jolt changes the result by less";
    REMANENCE = 0.005, "fraction of rated torque", "a larger ripple (peak to peak) is remanence", "chosen, not calibrated";
    SAME_RANGE = 1.01, "ratio of currents", "the largest currents of two compared runs differ by less", "chosen, not calibrated";
    MAIN_CAUSE = 0.5, "fraction of squared error", "a part that takes so much is the cause of the error", "chosen, not calibrated";
    TARGET_BITS = 15.0, "bits", "resolution that the correction is compared with", "the second document reaches 14 bits";
    POLE_PAIRS_APART = 0.5, "ratio of amplitudes", "the number of pole pairs is uncertain if the second-best order exceeds this fraction of the best", "chosen, not calibrated";
    START_APART = 3.0, "ratio of standard deviations", "zeros of power-ups that scatter by more than this multiple of the repeatability differ", "chosen, not calibrated";
    SAME_SET_POINT = 0.02, "fraction of speed", "measured speeds that differ by less belong to one set point", "chosen, not calibrated";
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn the_documents_show_every_threshold() {
        let docs = include_str!("../../../docs/verdicts.md");
        assert!(
            docs.contains(&table(ALL)),
            "replace the table of thresholds in docs/verdicts.md with:\n{}",
            table(ALL)
        );
    }

    #[test]
    fn no_two_thresholds_share_a_name() {
        let names: HashSet<&str> = ALL.iter().map(|threshold| threshold.name).collect();
        assert_eq!(names.len(), ALL.len());
    }
}
