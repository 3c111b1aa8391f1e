//! Suggests a known name for an unknown name.

/// The known name that is nearest to `name`, if it is near enough: one letter wrong, missing, added, or two letters
/// swapped. A long name may have two such mistakes.
pub fn nearest<'k>(name: &str, known: impl IntoIterator<Item = &'k str>) -> Option<&'k str> {
    let near = |known: &'k str| {
        let length = name.chars().count().max(known.chars().count());
        let allowed = match length {
            ..=2 => return None,
            3..=7 => 1,
            _ => 2,
        };
        Some((mistakes(&name.to_lowercase(), &known.to_lowercase()), known))
            .filter(|(mistakes, _)| *mistakes <= allowed)
    };
    known.into_iter().filter_map(near).min_by_key(|(mistakes, _)| *mistakes).map(|(_, known)| known)
}

/// A hint for an unknown name: the suggested name, or all known names.
pub fn instead(name: &str, known: &[&str]) -> String {
    match nearest(name, known.iter().copied()) {
        Some(near) => format!("did you mean {near}?"),
        None => format!("there are {}", known.join(", ")),
    }
}

/// Rewrites serde's message about an unknown word in plain words. Other messages stay unchanged.
pub fn plainly(fault: &str) -> String {
    let parts: Vec<&str> = fault.split('`').collect();
    match parts.as_slice() {
        ["unknown variant " | "unknown field ", word, _, known @ ..] if !known.is_empty() => {
            let known: Vec<&str> = known.iter().step_by(2).copied().collect();
            format!("unknown value {word}: {}", instead(word, &known))
        }
        _ => fault.to_owned(),
    }
}

/// Fewest letters to change, add, remove or swap with the next letter (optimal string alignment).
fn mistakes(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut rows = vec![(0..=b.len()).collect::<Vec<usize>>()];
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let wrong = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut least = wrong.min(rows[i - 1][j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                least = least.min(rows[i - 2][j - 2] + 1);
            }
            row.push(least);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_near_is_meant() {
        let known = ["gear_ratio", "poles", "pole_pairs", "sin", "tau_c"];
        let meant = |name| nearest(name, known);
        assert_eq!(meant("gear_ratoi"), Some("gear_ratio"));
        assert_eq!(meant("Gearratios"), Some("gear_ratio"), "two mistakes in a long name");
        assert_eq!((meant("tau_x"), meant("tua_x"), meant("pole")), (Some("tau_c"), None, Some("poles")));
        assert_eq!((meant("note"), meant("si"), meant("x")), (None, Some("sin"), None));
    }

    #[test]
    fn serde_speaks_plainly() {
        let message = plainly("unknown variant `silnet`, expected one of `none`, `silent`, `late`");
        assert_eq!(message, "unknown value silnet: did you mean silent?");
        let message = plainly("unknown field `mok`, expected `joint` or `load`");
        assert_eq!(message, "unknown value mok: there are joint, load");
        assert_eq!(
            plainly("invalid type: integer `3`, expected a string"),
            "invalid type: integer `3`, expected a string"
        );
    }

    #[test]
    fn an_unknown_value_gets_the_whole_list() {
        assert_eq!(instead("silnet", &["silent", "late"]), "did you mean silent?");
        assert_eq!(instead("nosuch", &["silent", "late"]), "there are silent, late");
    }
}
