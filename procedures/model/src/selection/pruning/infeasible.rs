//! Removes an added effect whose coefficients are physically impossible.

use crate::regression::linear_model::LinearModel;
use crate::selection::floating_search::FloatingSearch;

impl<'p> FloatingSearch<'_, 'p> {
    /// The added effect whose coefficients are physically impossible in a model.
    pub(crate) fn infeasible(&self, terms: &LinearModel<'p>) -> Option<&'p str> {
        let coefficients = terms.linear().coefficients;
        let mut sized =
            terms.terms.iter().zip(&coefficients).filter(|(term, _)| !self.initial_terms.contains(&term.id()));
        sized.find(|(term, coefficients)| !term.allows(coefficients)).map(|(term, _)| term.id())
    }
}

#[cfg(test)]
mod tests {
    use crate::selection::tiny::Tiny;
    use jointbench_instrument::Kind;

    #[test]
    fn negative_coulomb_friction_is_infeasible() {
        let removed = |coulomb: f64| {
            let tiny = Tiny::new(Kind::Friction, &["viscous"], |row| {
                coulomb * row.direction + row.velocity + 0.1 * row.scatter
            });
            tiny.removed(&["coulomb"], |search| search.infeasible(&search.now))
        };
        assert_eq!(removed(-2.0).as_deref(), Some("coulomb"));
        assert_eq!(removed(2.0), None);
    }
}
