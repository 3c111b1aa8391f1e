//! Number and torque of the poles, before and after demagnetising.

use super::Part;
use super::ripple::{ORDERS, Ripple, Turning, Wave};
use crate::catalogue::brake_run::load_gear_ratio;
use crate::catalogue::remanence::{self, Remanence};
use crate::findings::{Hold, Unusable, bounded, holds, quantity};
use crate::identification::{Axis, Figure, Form, Identification, Mark, Quantity, Series, Verdict};
use jointbench_instrument::RunTable;
use jointbench_model::words;

const FOREIGN: Unusable = Unusable::InsufficientData(
    "The run has no brake torque over an angle.",
    "Run brake_poles on a bench with a link encoder.",
);
const LITTLE: Unusable =
    Unusable::InsufficientData("The run ended before two turns of the demagnetised brake.", "Repeat the run.");

/// One order in both measurements.
struct Order {
    number: usize,
    before: Ripple,
    after: Ripple,
    /// What demagnetising has removed: it belongs to the poles.
    removed: Ripple,
}

impl Order {
    fn of(number: usize, before: &[Vec<Wave>], after: &[Vec<Wave>]) -> Option<Self> {
        let waves = |turns: &[Vec<Wave>]| turns.iter().map(|orders| orders[number - 1]).collect::<Vec<_>>();
        let (before, after) = (waves(before), waves(after));
        let removed: Vec<Wave> = before
            .iter()
            .zip(&after)
            .map(|(b, a)| Wave { direction: b.direction, parts: [b.parts[0] - a.parts[0], b.parts[1] - a.parts[1]] })
            .collect();
        Some(Self {
            number,
            before: Ripple::of(&before, 1)?,
            after: Ripple::of(&after, 1)?,
            removed: Ripple::of(&removed, ORDERS)?,
        })
    }
}

pub(super) fn identify(run: &RunTable) -> Result<Identification, Unusable> {
    let (link_rad, torque_nm) = run.column("position_rad").zip(run.column("brake_torque_nm")).ok_or(FOREIGN)?;
    let turning = Turning { link_rad, torque_nm, gear_ratio: load_gear_ratio(run) };
    let held = holds(run, 0.5);
    let of = |part: Part| -> (Vec<Hold>, Vec<Vec<Wave>>) {
        let turns = held.iter().filter(|hold| hold.repeat == part as i64 && hold.velocity_rad_s != 0.0);
        turns.filter_map(|hold| Some((hold.clone(), turning.waves(hold)?))).unzip()
    };
    let ((before, waves_before), (after, waves_after)) = (of(Part::Magnetised), of(Part::Demagnetised));
    let [magnetised, demagnetised] = [&before, &after].map(|holds| Remanence::of(run, holds));
    let (magnetised, demagnetised) = magnetised.zip(demagnetised).ok_or(LITTLE)?;
    let checked: Vec<Hold> = held.iter().filter(|hold| hold.repeat == Part::Checked as i64).cloned().collect();
    let remanence = Remanence::of(run, &checked).ok_or(LITTLE)?;
    let orders: Vec<Order> = (1..=ORDERS).filter_map(|number| Order::of(number, &waves_before, &waves_after)).collect();
    if orders.len() < ORDERS {
        return Err(LITTLE);
    }
    let clean = remanence.is_clean();
    let (result, mut quantities) = result(&orders);
    quantities.extend(remanence.quantities());
    Ok(Identification {
        verdict: if clean { Verdict::Identified } else { Verdict::Inconclusive },
        summary: format!("{result} After demagnetising: {}", lower_case(&remanence.sentence())),
        advice: (!clean).then(|| {
            "The rotor is still magnetised. Run demagnetise with more turns before the next measurement.".into()
        }),
        quantities,
        figures: vec![
            Figure {
                series: vec![magnetised.series(0, "magnetised at standstill"), demagnetised.series(0, "demagnetised")],
                ..remanence::over_angle("Torque without current over one turn, before and after")
            },
            spectrum(&orders),
        ],
        ..Identification::default()
    })
}

/// The largest significant order, or the bound of all of them.
fn result(orders: &[Order]) -> (String, Vec<Quantity>) {
    let largest = |a: &&Order, b: &&Order| a.removed.amplitude.total_cmp(&b.removed.amplitude);
    let Some(poles) = orders.iter().filter(|order| order.removed.is_significant()).max_by(largest) else {
        let most_nm = orders.iter().map(|order| order.removed.most()).fold(0.0, f64::max);
        let most = words::figure(most_nm, "Nm");
        let title = "Amplitude of poles of any order, less than (95 %)";
        return (
            format!("No poles found: amplitude less than {most} (95 %) for up to {ORDERS} poles per turn."),
            vec![quantity(["amplitude_most", "T_p", title, "Nm"], most_nm, None)],
        );
    };
    let Order { number, before, after, .. } = poles;
    let around = [(after.amplitude - after.reach).max(0.0), after.most()];
    let left = if after.is_significant() {
        bounded((after.amplitude, around), "Nm")
    } else {
        format!("less than {} (95 %)", words::figure(after.most(), "Nm"))
    };
    let sentence = format!(
        "{number} poles per turn of the brake, amplitude {} after magnetising at standstill, {left} after demagnetising.",
        bounded((before.single.value, before.single.ci95), "Nm")
    );
    let amplitude = |name: &str, title: &str, value: f64, ci95| quantity([name, "T_p", title, "Nm"], value, Some(ci95));
    (
        sentence,
        vec![
            // An integer that was tested against all others at 95 %.
            quantity(["poles", "p", "Poles per turn of the brake", ""], *number as f64, None),
            amplitude(
                "amplitude",
                "Amplitude of the poles, magnetised at standstill",
                before.single.value,
                before.single.ci95,
            ),
            amplitude("amplitude_after", "Amplitude of the same order, demagnetised", after.amplitude, around),
        ],
    )
}

fn spectrum(orders: &[Order]) -> Figure {
    let series = |label: &str, mark: Mark, of: fn(&Order) -> f64| {
        let x = orders.iter().map(|order| order.number as f64).collect();
        Series::new(label, mark, x, orders.iter().map(of).collect())
    };
    Figure {
        name: "spectrum".into(),
        title: "Torque ripple over periods per turn".into(),
        form: Form::Cartesian,
        x: Axis::of("periods per turn of the brake", ""),
        y: Axis::of("amplitude", "Nm"),
        series: vec![
            series("magnetised at standstill", Mark::Bars, |order| order.before.amplitude),
            series("demagnetised", Mark::Bars, |order| order.after.amplitude),
            series("significance limit of the difference", Mark::Line, |order| order.removed.reach),
        ],
    }
}

fn lower_case(sentence: &str) -> String {
    let mut letters = sentence.chars();
    letters.next().map(|first| format!("{}{}", first.to_lowercase(), letters.as_str())).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// Six turns with noise of 1 mNm in every order, and a wave of 5 mNm in each of `orders`.
    fn turns(random: &mut ChaCha8Rng, orders: &[usize]) -> Vec<Vec<Wave>> {
        let mut part = |number| {
            let wave_nm = if orders.contains(&number) { 5e-3 } else { 0.0 };
            // The sum of 12 uniform numbers is normal with variance 1.
            wave_nm + 1e-3 * (0..12).map(|_| random.random_range(-0.5..0.5)).sum::<f64>()
        };
        let mut turn = |direction| (1..=ORDERS).map(|n| Wave { direction, parts: [part(n), part(n)] }).collect();
        [1.0, -1.0, 1.0, -1.0, 1.0, -1.0].map(&mut turn).into()
    }

    #[test]
    fn only_what_demagnetising_removes_is_a_pole() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let mut found = |before: &[usize], after: &[usize]| {
            let (before, after) = (turns(&mut random, before), turns(&mut random, after));
            let orders: Vec<_> = (1..=ORDERS).filter_map(|number| Order::of(number, &before, &after)).collect();
            result(&orders)
        };
        let (sentence, quantities) = found(&[1, 21], &[1]);
        assert_eq!(quantities[0].value, 21.0, "{sentence}");
        let (sentence, quantities) = found(&[1], &[1]);
        assert!(sentence.starts_with("No poles found: amplitude less than "), "{sentence}");
        assert!((1e-3..10e-3).contains(&quantities[0].value), "{sentence}");
    }
}
