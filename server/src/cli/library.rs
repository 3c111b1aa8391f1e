//! `jointbench procedures` and `jointbench effects`: lists the procedures and the effects of the library.

use super::exit::{Done, Exit};
use jointbench_devices::sim::HIDDEN_EFFECTS;
use jointbench_instrument::Kind;
use jointbench_instrument::spelling::instead;
use jointbench_model::effects::{ONLY_WEIGHT, WITH_WEIGHT};
use jointbench_model::{EffectInfo, effects as effects_of};
use jointbench_procedure::catalogue;
use jointbench_procedure::parameter::ParameterKind;

pub fn procedures(asked: Option<&str>) -> Done {
    let Some(asked) = asked else {
        catalogue().iter().for_each(|one| println!("{:<24} {}", one.id(), one.title()));
        println!("\nDescription and parameters: jointbench procedures ID. Start: jointbench run ID");
        return Ok(());
    };
    let known: Vec<&str> = catalogue().iter().map(|one| one.id()).collect();
    let procedure =
        catalogue().iter().find(|one| one.id() == asked).ok_or_else(|| unknown("procedure", asked, &known))?;
    println!("{}: {}\n{}\n", procedure.id(), procedure.title(), procedure.summary());
    for one in procedure.schema() {
        let unit = if one.unit.is_empty() { String::new() } else { format!(" {}", one.unit) };
        let value = match one.kind {
            ParameterKind::Curve => "@FILE (CSV: time in s, value)".to_owned(),
            _ => one.default.to_string(),
        };
        println!("  --set {}={value}{unit}, {} to {}: {}", one.name, one.min, one.max, one.title);
    }
    Ok(())
}

pub fn effects(asked: Option<&str>) -> Done {
    let library = || Kind::ALL.into_iter().flat_map(effects_of);
    let all: Vec<EffectInfo> = library().map(|effect| effect.info()).collect();
    let Some(asked) = asked else {
        for kind in Kind::ALL {
            println!("{kind}");
            all.iter().filter(|one| one.kind == kind).for_each(|one| println!("  {:<24} {}", one.id, one.title));
        }
        println!("\nDescription: jointbench effects ID. A mock bench can hide these effects:");
        HIDDEN_EFFECTS.iter().for_each(|(kind, effects)| println!("  {:<10} {}", kind.name(), effects.join(", ")));
        println!("The encoder bench hides effects of encoders. Joints a and b hide effects of stiffness and brake.");
        println!("Write `effects = [\"gravity\"]` in [bench.mock], or for a demo: jointbench demo --effect gravity");
        return Ok(());
    };
    let named: Vec<_> = library().filter(|effect| effect.info().id == asked).collect();
    if named.is_empty() {
        let known: Vec<&str> = all.iter().map(|one| one.id).collect();
        return Err(unknown("effect", asked, &known));
    }
    for effect in named {
        let one = effect.info();
        println!("{} ({}): {}\n{}\n  {}", one.id, one.kind, one.title, one.sentence, one.formula);
        let cases = [
            (WITH_WEIGHT, "with a gravity load that the torque sensor does not measure"),
            (ONLY_WEIGHT, "with a gravity load and without a torque sensor"),
        ];
        for (form, case) in cases.into_iter().filter(|(form, _)| effect.formula_of(form) != one.formula) {
            println!("  {case}:\n  {}", effect.formula_of(form));
        }
        for parameter in one.parameters {
            println!("  {} [{}], {} to {}", parameter.name, parameter.unit, parameter.min, parameter.max);
        }
        let every = one.kind.required_columns().join(", ");
        let needs = match one.needs {
            [] => String::new(),
            needs => format!("{} in addition to ", needs.join(", ")),
        };
        println!("  requires {needs}the columns of every {} run ({every})", one.kind);
        println!("  residual if missing: {}\n  source: {}", one.looks, one.source);
    }
    Ok(())
}

fn unknown(what: &str, asked: &str, known: &[&str]) -> Exit {
    Exit::bad_input(format!("unknown {what} {asked}: {}", instead(asked, known)))
}
