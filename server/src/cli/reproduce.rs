//! `jointbench reproduce`: repeats the measurements of the source documents on the mock bench and compares the tables.

mod benches;
mod coverage;
mod documents;
mod evidence;
mod figure;
mod performed;
mod row;

use super::arguments::Reproduce;
use super::exit::{Done, Exit};
use crate::report::{svg, with_interval};
use crate::view;
use jointbench_devices::sim::{Load, Truth};
use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_procedure::identification::Quantity;
use jointbench_procedure::reproduce::{
    Comparison, Extent, ProcedureResult, Requirement, Subject, reproduce as campaign, simultaneous_factor,
};
use std::fmt::Write;
use std::fs;
use std::io;
use std::path::Path;

const SUBJECTS: [(&str, Joint, Subject); 6] = [
    ("Joint A", Joint::JointA, Subject::JointA),
    ("Joint A behind the gear and brake B", Joint::JointA, Subject::GearAndBrakeB { share: 0.35 }),
    ("Joint B", Joint::JointB, Subject::JointB),
    ("Encoder bench", Joint::EncoderShaft, Subject::Encoder),
    (
        "Encoder bench, filter on",
        Joint::EncoderShaft,
        Subject::FilteredEncoder { delay_without_s: 0.0, half_difference_s: 0.0 },
    ),
    ("Puma", Joint::Puma, Subject::Puma { axis: 2 }),
];
const COLUMNS: &str =
    "| table | quantity | document | measured | 95 % interval | true value | inside | required | met |";

pub fn reproduce(arguments: &Reproduce) -> Done {
    if arguments.documents {
        return documents::reproduce(arguments);
    }
    // Check the path now: the measurements take minutes.
    if let Some(page) = &arguments.out {
        create_folder(page)?;
    }
    let mut page = preamble(arguments.seed);
    let mut chapters: Vec<(&str, ProcedureResult)> = Vec::new();
    for (title, joint, mut subject) in SUBJECTS {
        println!("{title}");
        page += &format!("\n## {title}\n");
        subject.follow(chapters.iter().map(|(_, chapter)| chapter));
        for chapter in measure(&drawn(joint, subject, arguments.seed), subject, Extent::Complete)? {
            page += &chapter_text(&chapter, title, arguments.out.as_deref())?;
            chapters.push((title, chapter));
        }
    }
    let outcome = Outcome::of(&chapters);
    let summary = outcome.summary();
    println!("{summary}");
    page += &format!("\n## Summary\n\n{summary}\n");
    if let Some(path) = &arguments.out {
        fs::write(path, page).map_err(|fault| unwritable(path, &fault))?;
        println!("{}", path.display());
    }
    outcome.exit()
}

/// The folder for the figures of a page.
fn create_folder(page: &Path) -> Done {
    let folder = page.with_extension("");
    if folder == *page {
        return Err(Exit::bad_input(format!(
            "{}: the page must end in .md; its figures are written to a folder with the same name",
            page.display()
        )));
    }
    fs::create_dir_all(&folder).map_err(|fault| unwritable(&folder, &fault))
}

/// Intervals compared with the true values, and the names of those that do not agree.
struct Outcome {
    compared: u64,
    /// True value outside the 95 % interval.
    missed: Vec<String>,
    /// True value outside the interval for simultaneous coverage.
    beyond: Vec<String>,
    /// Requirement not met.
    broken: Vec<String>,
}

impl Outcome {
    fn of(chapters: &[(&str, ProcedureResult)]) -> Self {
        let comparisons: Vec<(&str, &Comparison)> = chapters
            .iter()
            .flat_map(|(title, chapter)| chapter.comparisons.iter().map(move |one| (*title, one)))
            .collect();
        let where_not = |holds: &dyn Fn(&Comparison) -> Option<bool>| -> Vec<String> {
            let failed = comparisons.iter().filter(|(_, one)| holds(one) == Some(false));
            failed.map(|(title, one)| format!("{title}: {}", one.found.name)).collect()
        };
        let compared = comparisons.iter().filter(|(_, one)| one.is_inside().is_some()).count() as u64;
        Self {
            compared,
            missed: where_not(&Comparison::is_inside),
            beyond: where_not(&|one| one.is_inside_with(compared)),
            broken: where_not(&Comparison::meets_requirement),
        }
    }

    fn summary(&self) -> String {
        let Self { compared, missed, beyond, .. } = self;
        let except =
            |names: &[String]| if names.is_empty() { String::new() } else { format!(", not {}", names.join(", ")) };
        format!(
            "{} of {compared} intervals contain the true value{}; one in twenty may miss by chance. For simultaneous 95 % \
             coverage the intervals must be {:.2} times as wide; then {} contain it{}.",
            compared - missed.len() as u64,
            except(missed),
            simultaneous_factor(*compared),
            if beyond.is_empty() { "all".to_owned() } else { (compared - beyond.len() as u64).to_string() },
            except(beyond),
        )
    }

    fn exit(&self) -> Done {
        if !self.broken.is_empty() {
            return Err(Exit::failed(format!("requirement not met: {}", self.broken.join(", "))));
        }
        if self.beyond.is_empty() {
            return Ok(());
        }
        Err(Exit::failed(format!("deviation from the true value beyond chance: {}", self.beyond.join(", "))))
    }
}

/// Introduction of the page.
fn preamble(seed: u64) -> String {
    format!(
        "# Tables of the source documents, reproduced\n\nWritten by `jointbench reproduce --seed {seed} --out …`, version {}. The bench is simulated. *True value* is the constant of the simulation, used only for this comparison; *inside* states whether the 95 % interval contains it. *Required* is the maximum width of the interval or the limit of the figure, and *met* states whether it is met. A joint of the mock bench is similar to the joint of the document, not identical: depending on the seed, its Coulomb and viscous friction are within 8 % of the document and its breakaway torque within 18 %, and its velocity loop follows a trajectory more closely.\n",
        env!("CARGO_PKG_VERSION")
    )
}

/// A bench similar to that of the document.
fn drawn(joint: Joint, subject: Subject, seed: u64) -> MockSettings {
    // The joints of the documents have no hidden effects except a Stribeck effect.
    let hidden: &[&str] = if joint == Joint::EncoderShaft { &[] } else { &["stribeck"] };
    bench_of(joint, subject, seed).hiding(hidden)
}

/// The simulated bench of a subject.
fn bench_of(joint: Joint, subject: Subject, seed: u64) -> MockSettings {
    let mut settings = MockSettings::new(joint, seed);
    match subject {
        Subject::GearAndBrakeB { .. } => settings.load = Load::GearAndBrakeB,
        Subject::FilteredEncoder { .. } => settings.filter = true,
        Subject::Puma { axis } => settings.axis = axis as u8,
        _ => {}
    }
    settings
}

fn measure(settings: &MockSettings, subject: Subject, extent: Extent) -> Result<Vec<ProcedureResult>, Exit> {
    let mock = MockBench::start(settings.clone()).map_err(|fault| Exit::failed(fault.to_string()))?;
    let mut bench = mock.open_bench("mock").map_err(|fault| Exit::failed(fault.to_string()))?;
    let truth = mock.truth();
    campaign(&mut bench, subject, extent, &|name| given(truth, name), &mut |chapter| {
        println!("  {} ({:.0} s of bench time): {}", chapter.title, chapter.duration_s, chapter.identification.summary);
        for one in &chapter.comparisons {
            let (value, interval) = with_interval(one.found.value, one.found.ci95, &one.found.unit);
            let interval = interval.map(|ends| format!(" [{ends}]")).unwrap_or_default();
            println!("    {:24} {value}{interval}{}", one.found.name, mark(one));
        }
    })
    .map_err(|fault| Exit::failed(fault.to_string()))
}

/// The true value of the simulation for a quantity.
fn given(truth: &Truth, name: &str) -> Option<f64> {
    let stribeck = |figure: &str| truth.hidden.iter().find(|h| h.effect == "stribeck")?.parameters.get(figure).copied();
    let encoders = &truth.encoders;
    match name {
        "tau_c" => Some(truth.coulomb_nm),
        "c_v" => Some(truth.viscous_nm_s),
        "tau_h" => Some(truth.coulomb_nm + stribeck("rise_nm")?),
        "omega_s" => Some(stribeck("velocity_rad_s")? / truth.gear_ratio),
        "delta_s" => stribeck("exponent"),
        "k" => Some(truth.stiffness_nm_rad),
        "beta_0" => Some(truth.directional_offset_rad),
        "offset" => Some(encoders.offset_rad),
        "startup_spread" => Some(encoders.startup_spread_rad),
        "delay" => Some(encoders.delay_s),
        "filter_delay" => Some(encoders.filter_delay_s),
        "radial_negative" => Some(encoders.radial_m[0]),
        "radial_positive" => Some(encoders.radial_m[1]),
        "axial_positive" => Some(encoders.axial_m),
        "rotation_negative" => Some(-encoders.rotation_rad),
        "rotation_positive" => Some(encoders.rotation_rad),
        "tilt_negative" => Some(-encoders.lost_tilt_rad),
        "tilt_positive" => Some(encoders.lost_tilt_rad),
        _ => of_arm(truth, name),
    }
}

/// True lines of an arm, in volts of its shunt and link degrees per second.
fn of_arm(truth: &Truth, name: &str) -> Option<f64> {
    let hidden =
        |effect: &str, figure: &str| truth.hidden.iter().find(|h| h.effect == effect)?.parameters.get(figure).copied();
    let nm_per_v = truth.torque_constant_nm_per_a * MockSettings::new(truth.joint, truth.seed).amperes_per_volt()?;
    let (offset_nm, share) = (hidden("direction_offset", "offset_nm")?, hidden("viscous_asymmetry", "relative")?);
    let per_deg_s = truth.viscous_nm_s / nm_per_v / truth.gear_ratio.recip().to_degrees();
    match name {
        "f_positive" => Some((truth.coulomb_nm + offset_nm) / nm_per_v),
        "f_negative" => Some((offset_nm - truth.coulomb_nm) / nm_per_v),
        "b_positive" => Some((1.0 + share) * per_deg_s),
        "b_negative" => Some((1.0 - share) * per_deg_s),
        _ => None,
    }
}

fn unwritable(path: &Path, fault: &io::Error) -> Exit {
    Exit::bad_input(format!("{}: {fault}; give another --out", path.display()))
}

fn mark(one: &Comparison) -> &'static str {
    match (one.is_inside(), one.meets_requirement()) {
        (Some(false), _) => "  MISSED",
        (_, Some(false)) => "  REQUIREMENT NOT MET",
        _ => "",
    }
}

fn titled(found: &Quantity) -> String {
    match found.symbol.as_str() {
        "" => found.title.clone(),
        symbol => format!("{} ({symbol})", found.title),
    }
}

fn asked(demand: Requirement, unit: &str) -> String {
    let figure = |value: f64| with_interval(value, None, unit).0;
    match demand {
        Requirement::Within(widest) => format!("±{}", figure(widest)),
        Requirement::WithinShare(share) => format!("±{:.0} %", 100.0 * share),
        Requirement::AtLeast(least) => format!("≥ {}", figure(least)),
        Requirement::AtMost(most) => format!("≤ {}", figure(most)),
    }
}

/// A chapter of the page. Its figures are written to a folder with the name of the page.
fn chapter_text(chapter: &ProcedureResult, title: &str, page: Option<&Path>) -> Result<String, Exit> {
    let mut text = format!("\n### {}\n\n{}\n", chapter.title, chapter.identification.summary);
    if !chapter.comparisons.is_empty() {
        let _ = writeln!(text, "\n{COLUMNS}\n|---|---|---|---|---|---|---|---|---|");
    }
    for one in &chapter.comparisons {
        let (value, interval) = with_interval(one.found.value, one.found.ci95, &one.found.unit);
        let number = |value: f64| with_interval(value, one.found.ci95, &one.found.unit).0;
        let yes = |answer: Option<bool>| answer.map_or("", |yes| if yes { "yes" } else { "**no**" });
        let _ = writeln!(
            text,
            "| {} | {} | {} | {value} | {} | {} | {} | {} | {} |",
            one.table,
            titled(&one.found),
            one.document.map(|value| with_interval(value, None, &one.found.unit).0).unwrap_or_default(),
            interval.unwrap_or_default(),
            one.given.map(number).unwrap_or_default(),
            yes(one.is_inside()),
            one.demand.map(|demand| asked(demand, &one.found.unit)).unwrap_or_default(),
            yes(one.meets_requirement()),
        );
    }
    let Some(page) = page else { return Ok(text) };
    let folder = page.with_extension("");
    let found = view::Shown::new(chapter.identification.clone(), Vec::new());
    for figure in &found.figures {
        let Some(drawn) = svg(figure) else { continue };
        let name = format!(
            "{}-{}-{}.svg",
            title.to_lowercase().replace(',', "").replace(' ', "-"),
            chapter.procedure,
            figure.name
        );
        let path = folder.join(&name);
        fs::write(&path, drawn).map_err(|fault| unwritable(&path, &fault))?;
        let folder = folder.file_name().unwrap_or_default().to_string_lossy();
        let _ = writeln!(text, "\n![{}]({folder}/{name})", figure.title);
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Update with `jointbench reproduce --seed 1 --out docs/reproduction.md`.
    const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/reproduction.md");

    /// Compares only the beginning and the headings of the page: the figures take minutes.
    #[test]
    fn the_kept_page_is_one_of_this_program() {
        let page = fs::read_to_string(PAGE).unwrap();
        let renew = "renew it with `jointbench reproduce --seed 1 --out docs/reproduction.md`";
        assert!(page.starts_with(&preamble(1)), "the page begins otherwise: {renew}");
        assert!(page.contains(COLUMNS), "the columns of its tables differ: {renew}");
        let of_subject = |(title, _, subject): (&str, Joint, Subject)| {
            let procedures = subject.procedures().into_iter().map(|one| format!("### {}", one.title()));
            std::iter::once(format!("## {title}")).chain(procedures).collect::<Vec<_>>()
        };
        let expected: Vec<String> =
            SUBJECTS.into_iter().flat_map(of_subject).chain(["## Summary".to_owned()]).collect();
        let kept: Vec<&str> = page.lines().filter(|line| line.starts_with("##")).collect();
        assert_eq!(kept, expected, "{renew}");
    }

    /// Tests only one subject: the others take minutes.
    #[test]
    fn the_kept_figures_are_those_of_this_program() {
        let page = fs::read_to_string(PAGE).unwrap();
        for (title, joint, subject) in
            SUBJECTS.into_iter().filter(|(.., subject)| matches!(subject, Subject::Puma { .. }))
        {
            for chapter in measure(&drawn(joint, subject, 1), subject, Extent::Complete).unwrap() {
                let text = chapter_text(&chapter, title, None).unwrap();
                assert!(page.contains(&text), "docs/reproduction.md has other figures than this program:\n{text}");
            }
        }
    }

    #[test]
    fn the_kept_page_shows_every_kept_figure() {
        let page = fs::read_to_string(PAGE).unwrap();
        let shown = page.split("](reproduction/").skip(1).filter_map(|rest| rest.split(')').next());
        let shown: BTreeSet<String> = shown.map(str::to_owned).collect();
        let folder = Path::new(PAGE).with_extension("");
        let names = fs::read_dir(folder).unwrap().map(|file| file.unwrap().file_name().to_string_lossy().into_owned());
        assert_eq!(shown, names.collect());
    }
}
