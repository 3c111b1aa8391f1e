//! Prints the effects that are not in a model.

use jointbench_model::{Invisible, LeftOut, Silent, words};

pub fn print(silent: &[Silent], hidden: &[Invisible], left_out: &[LeftOut], unit: &str) {
    if let Some(text) = silences(silent, unit) {
        println!("{text}");
    }
    for effect in left_out {
        println!("rejected: {} ({})", effect.effect, effect.why);
    }
    for (why, effects) in alike(hidden) {
        println!("not testable with this run: {} ({why})", effects.join(", "));
    }
}

/// Groups the effects by reason, in the order of first occurrence.
fn alike(hidden: &[Invisible]) -> Vec<(&str, Vec<&str>)> {
    let mut alike: Vec<(&str, Vec<&str>)> = Vec::new();
    for one in hidden {
        match alike.iter_mut().find(|(why, _)| *why == one.why) {
            Some((_, effects)) => effects.push(&one.effect),
            None => alike.push((&one.why, vec![&one.effect])),
        }
    }
    alike
}

const HEADING: &str =
    "tested, not significant (95 % upper limits of the RMS contribution, part of which others may compensate)";

/// Upper limits, the smallest first.
fn silences(silent: &[Silent], unit: &str) -> Option<String> {
    let upper = |s: &Silent| s.upper_rms.unwrap_or(f64::INFINITY);
    let mut silent: Vec<&Silent> = silent.iter().collect();
    silent.sort_by(|a, b| upper(a).total_cmp(&upper(b)));
    let within = |s: &Silent| s.sought.as_ref().map_or_else(String::new, |sought| format!(" ({sought})"));
    let sized = |s: &&Silent| format!("{} < {}{}", s.effect, words::figure(upper(s), unit), within(s));
    let sized: Vec<String> = silent.iter().map(sized).collect();
    (!sized.is_empty()).then(|| format!("{HEADING}: {}", sized.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_named_with_its_upper_limit_the_smallest_first() {
        let silent = |effect: &str, nm: f64| Silent {
            effect: effect.into(),
            minimum_detectable_rms: nm / 2.0,
            upper_rms: Some(nm),
            sought: None,
        };
        let mut all: Vec<Silent> = [5e-3, 2e-3, 4e-3, 3e-3].iter().map(|nm| silent("gravity", *nm)).collect();
        all.push(Silent { sought: Some("1 to 60 waves a turn".into()), ..silent("cogging", 1.2e-4) });
        let text = silences(&all, "Nm").unwrap();
        assert!(
            text.starts_with(
                "tested, not significant (95 % upper limits of the RMS contribution, part of which others may compensate): \
                 cogging < 120 µNm (1 to 60 waves a turn), gravity < 2.00 mNm, "
            ),
            "{text}"
        );
        assert!(text.ends_with(", gravity < 4.00 mNm, gravity < 5.00 mNm"), "{text}");
        assert_eq!(silences(&[], "Nm"), None);
    }
}
