//! `--own` and `--effect-file`: effects that users write.

use super::exit::Exit;
use super::files;
use clap::Args;
use jointbench_instrument::{Kind, Motion};
use jointbench_model::{Definition, UserEffect};
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
#[command(
    next_help_heading = "User-defined effects (used like library effects, in --model or as suggestions of diagnose)"
)]
pub struct OwnEffects {
    /// An effect in one line: "ID: tau = FORMULA; PARAMETER [UNIT] MIN..MAX; …". Unit and range are optional; `start
    /// LOW..HIGH` and `whole` may follow. column(NAME) is any other column of the run, and wrap(angle) wraps an angle
    /// into one turn. An unknown name lists the available signals, and inconsistent units are reported. Repeatable.
    /// Example: "rub: tau = a * tanh(velocity / w0) * abs(load); a [1] 0..1; w0 [rad/s] 0.1..10"
    #[arg(long, value_name = "EFFECT")]
    pub own: Vec<String>,
    /// TOML file with effects: [[effect]] with id, formula, parameters = [{ name, unit, min, max, start, whole }], and
    /// optionally kind, title and sentence; repeatable
    #[arg(long, value_name = "EFFECTS.TOML")]
    pub effect_file: Vec<PathBuf>,
}

impl OwnEffects {
    /// Reads all effects; an effect without a kind gets the kind of the run. Prints doubts about the formulas.
    pub fn read(&self, kind: Kind, motion: Motion) -> Result<Vec<UserEffect>, Exit> {
        let mut all = Vec::new();
        for file in &self.effect_file {
            all.extend(read_file(file, kind)?);
        }
        for text in &self.own {
            all.push(UserEffect::inline(kind, text)?);
        }
        for fault in all.iter().flat_map(|user_effect| user_effect.unit_warnings(Some(motion))) {
            eprintln!("note: {}", Exit::from(fault).message);
        }
        Ok(all)
    }
}

fn read_file(file: &Path, kind: Kind) -> Result<Vec<UserEffect>, Exit> {
    let refuse = |fault: &dyn std::fmt::Display| Exit::bad_input(format!("{}: {fault}", file.display()));
    let text = files::read_text(file)?;
    let mut table: toml::Table = toml::from_str(&text).map_err(|fault| refuse(&fault))?;
    let effects = match table.remove("effect") {
        Some(toml::Value::Array(effects)) if table.is_empty() => effects,
        _ => return Err(refuse(&"expected only [[effect]] tables")),
    };
    let mut all = Vec::new();
    for mut effect in effects {
        if let Some(effect) = effect.as_table_mut() {
            effect.entry("kind").or_insert_with(|| kind.name().into());
        }
        let definition: Definition = effect.try_into().map_err(|fault: toml::de::Error| refuse(&fault))?;
        let effect = UserEffect::try_from(definition).map_err(|fault| {
            let exit = Exit::from(fault);
            Exit { message: format!("{}: {}", file.display(), exit.message), ..exit }
        })?;
        all.push(effect);
    }
    Ok(all)
}
