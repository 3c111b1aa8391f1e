//! Simulated measurements: machines that share no formula and no code with the library.

mod brake;
mod dice;
mod encoder;
mod friction;
mod joint;
mod stiffness;

pub use dice::{Coloured, Dice};
pub use friction::make as friction_run;
use jointbench_instrument::{Channel, Kind, Meta, RunTable, Trace};

/// The correct answer of a case.
#[derive(Clone, Default)]
pub struct Answer {
    /// One group for each hidden effect: ids of which one has to be found.
    pub accept: Vec<Vec<String>>,
    /// Ids that are accepted, but not required.
    pub optional: Vec<String>,
    /// Something is hidden that the library does not contain.
    pub unknown: bool,
}

pub struct Case {
    pub family: &'static str,
    pub name: String,
    pub run: RunTable,
    pub answer: Answer,
}

type Maker = fn(&mut Dice, &[&str]) -> RunTable;

struct Family {
    name: &'static str,
    make: Maker,
    singles: &'static [&'static str],
    pairs: &'static [[&'static str; 2]],
    unknown: &'static [&'static str],
    nulls: usize,
}

const FAMILIES: [Family; 4] = [
    Family {
        name: "friction",
        make: friction::make,
        singles: friction::SINGLES,
        pairs: friction::PAIRS,
        unknown: friction::UNKNOWN,
        nulls: 3,
    },
    Family {
        name: "encoder",
        make: encoder::make,
        singles: encoder::SINGLES,
        pairs: encoder::PAIRS,
        unknown: &[],
        nulls: 2,
    },
    Family {
        name: "stiffness",
        make: stiffness::make,
        singles: stiffness::SINGLES,
        pairs: stiffness::PAIRS,
        unknown: &[],
        nulls: 2,
    },
    Family { name: "brake", make: brake::make, singles: brake::SINGLES, pairs: brake::PAIRS, unknown: &[], nulls: 2 },
];

/// Effects that one motion shows alike, because load and motion change their signs together.
const ALIKE: [[&str; 2]; 1] = [["directional_offset", "backlash"]];

/// All cases of one round in order: every round has other machines, noises and sizes.
pub fn round(number: u64) -> impl Iterator<Item = Case> {
    FAMILIES.iter().enumerate().flat_map(move |(f, family)| {
        let singles = family.singles.iter().map(|h| (vec![*h], false));
        let pairs = family.pairs.iter().map(|p| (p.to_vec(), false));
        let unknown = family.unknown.iter().map(|h| (vec![*h], true));
        let nulls = (0..family.nulls).map(|_| (Vec::new(), false));
        singles.chain(pairs).chain(unknown).chain(nulls).enumerate().map(move |(i, (hidden, unknown))| {
            let seed = number * 10_000 + f as u64 * 1_000 + i as u64;
            let run = (family.make)(&mut Dice::new(seed), &hidden);
            let group = |h: &&str| {
                let alike = ALIKE.iter().find(|a| a.contains(h));
                alike.map_or_else(|| vec![(*h).to_owned()], |a| a.iter().map(|id| (*id).to_owned()).collect())
            };
            let accept = if unknown { Vec::new() } else { hidden.iter().map(group).collect() };
            let label = if hidden.is_empty() { "none".into() } else { hidden.join("+") };
            let name = format!("{}-{label}-{seed}", family.name);
            Case { family: family.name, name, run, answer: Answer { accept, optional: Vec::new(), unknown } }
        })
    })
}

/// A run without hidden effects, with families in turn; every third one lacks an optional column.
pub fn null(number: u64) -> Case {
    let family = &FAMILIES[number as usize % FAMILIES.len()];
    let mut dice = Dice::new(900_000 + number);
    let mut run = (family.make)(&mut dice, &[]);
    let mut name = format!("{}-null-{number}", family.name);
    if number.is_multiple_of(3) {
        let spare =
            ["temperature_c", "link_position_rad", "velocity_rad_s", "motor_velocity_rad_s", "segment", "repeat"];
        // The stiffness of a joint cannot be measured without its link.
        let needed = |c: &str| run.kind() == Kind::Stiffness && c == "link_position_rad";
        let there: Vec<&str> = spare.into_iter().filter(|c| run.column(c).is_some() && !needed(c)).collect();
        let column = *dice.pick(&there);
        run = without(&run, column);
        name = format!("{name} without {column}");
    }
    Case { family: family.name, name, run, answer: Answer::default() }
}

fn without(run: &RunTable, column: &str) -> RunTable {
    let kept = run.trace().channels().iter().filter(|c| c.name != column);
    let columns = kept.clone().map(|c| run.column(&c.name).unwrap_or_default().to_vec()).collect();
    table(run.meta().clone(), kept.map(|c| c.name.clone()).collect(), columns)
}

/// A table from its columns. The simulations produce valid tables.
pub fn table(meta: Meta, names: Vec<String>, columns: Vec<Vec<f64>>) -> RunTable {
    let channels = names.into_iter().map(Channel::new).collect();
    RunTable::new(meta, Trace::from_columns(channels, columns)).expect("a simulated run is a valid table")
}

pub fn rounded(value: f64, step: f64) -> f64 {
    (value / step).round() * step
}
