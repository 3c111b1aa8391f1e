//! Removes an added effect that explains nothing beyond a free function of the axis with structure.

use crate::effect::Regime;
use crate::regression::linear_model::Term;
use crate::regression::partial_regression::PartialRegression;
use crate::regression::significance::alone;
use crate::residual_analysis::maps::Maps;
use crate::selection::floating_search::FloatingSearch;
use crate::selection::pruning::Trial;
use crate::thresholds::SAME_SHAPE;

/// An added effect that only follows structure over an axis that is not its own: together with a free function of
/// that axis it explains nothing. Example: a wave whose mean changes from step to step follows any curve over speed a
/// little.
pub fn spurious<'p>(trial: &Trial<'_, '_, 'p>) -> Option<&'p str> {
    over(trial.search, trial.maps(), trial.axis()?)
}

fn over<'p>(search: &FloatingSearch<'_, 'p>, maps: &Maps, axis: &str) -> Option<&'p str> {
    let options = search.options;
    let functions = maps.functions(axis);
    let is_spurious = |term: &&Term<'p>| {
        let without = search.now.without(term.id());
        let mut basis = without.tangent();
        functions.iter().for_each(|f| {
            basis.push(f);
        });
        let left = basis.rest(&without.response());
        let partial = PartialRegression::new(basis, left, search.now.problem);
        let orthogonalized = partial.orthogonalized(&term.columns);
        orthogonalized.visible > 1.0 - SAME_SHAPE
            && (orthogonalized.share < options.practical_share || alone(term, &partial, options) > options.alpha)
    };
    search.added().filter(|term| term.effect.traits().regime != Regime::Hysteresis).find(is_spurious).map(Term::id)
}

#[cfg(test)]
mod tests {
    use crate::selection::pruning::Trial;
    use crate::selection::tiny::Tiny;
    use jointbench_instrument::Kind;

    #[test]
    fn a_temperature_that_follows_structure_over_speed_is_spurious() {
        let hump = |velocity: f64| f64::from(u8::from(velocity.abs() == 6.0));
        let removed = |of_hump: f64, of_temperature: f64| {
            let temperature = |row: crate::selection::tiny::Row| 4.0 * hump(row.velocity) + 3.0 * row.leg_scatter;
            let tiny = Tiny::warmed(
                Kind::Friction,
                &["coulomb"],
                |row| 25.0 + temperature(row),
                |row| {
                    let size = of_hump * hump(row.velocity) + of_temperature * temperature(row);
                    (5.0 + size) * row.direction + 0.1 * row.scatter
                },
            );
            tiny.removed(&["temperature_coulomb"], |search| {
                super::over(search, Trial::new(search).maps(), "motor_velocity_rad_s")
            })
        };
        assert_eq!(removed(4.0, 0.0).as_deref(), Some("temperature_coulomb"));
        assert_eq!(removed(0.0, 1.0), None);
    }
}
