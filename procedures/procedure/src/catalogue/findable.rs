//! The quantities that a procedure can identify, so that an impossible limit is rejected before anything moves.

/// A quantity that an identification may contain, if the run determines it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Findable {
    /// `#` is a placeholder for a number from 1 on.
    pub name: String,
    /// SI symbol; empty for a share or a count.
    pub unit: &'static str,
}

impl Findable {
    /// Whether a name matches this quantity.
    pub fn is(&self, name: &str) -> bool {
        let plain: Vec<&str> = name.split('_').map(|word| if is_number(word) { "#" } else { word }).collect();
        self.name == name || self.name == plain.join("_")
    }
}

fn is_number(word: &str) -> bool {
    !word.is_empty() && word.bytes().all(|byte| byte.is_ascii_digit())
}

/// Quantities from lists of names by unit, separated by spaces.
pub(super) fn findable(by_unit: &[(&'static str, &str)]) -> Vec<Findable> {
    let of_unit = |(unit, names): &(&'static str, &str)| {
        let unit = *unit;
        names.split_whitespace().map(|name| Findable { name: name.to_owned(), unit }).collect::<Vec<_>>()
    };
    by_unit.iter().flat_map(of_unit).collect()
}

#[cfg(test)]
mod tests {
    use crate::{catalogue, procedure};

    #[test]
    fn every_procedure_names_what_it_finds() {
        for procedure in catalogue() {
            let mut names: Vec<_> = procedure.finds().into_iter().map(|findable| findable.name).collect();
            assert!(!names.is_empty(), "{}", procedure.id());
            let count = names.len();
            names.sort();
            names.dedup();
            assert_eq!(names.len(), count, "{} names one twice", procedure.id());
        }
        let unit_of = |id: &str, name: &str| {
            let found = procedure(id).unwrap().finds().into_iter().find(|findable| findable.is(name));
            found.map(|findable| findable.unit)
        };
        assert_eq!((unit_of("friction", "tau_c"), unit_of("friction", "tau_x")), (Some("Nm"), None));
        assert_eq!(unit_of("presliding", "element_3_slip"), Some("Nm"));
        assert_eq!(unit_of("identify_joint", "stiffness.beta_0"), Some("rad"));
        assert_eq!(unit_of("identify_joint", "beta_0"), None);
        assert_eq!(unit_of("compensation", "rho_2_full"), Some("rad²"));
        // A digit that belongs to a name is no placeholder.
        assert_eq!((unit_of("stiffness", "beta_0"), unit_of("stiffness", "beta_1")), (Some("rad"), None));
    }
}
