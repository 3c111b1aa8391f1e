//! Effects that users write: checked, stored, and available to every model of their kind. A diagnosis suggests one only on
//! runs that use it: the run in whose workbench it was written, and those that a user chose.

use super::blocking::blocking;
use super::models::{effect_view, find_kind};
use super::{Answer, Lab, LabError, exclusions, names};
use crate::job::Job;
use crate::store::{EffectUse, StoreError, UserEffectRecord};
use crate::view::{
    Effect, EffectCheck, EffectDefinition, EffectTrial, FittedParameter, FormulaLanguage, FormulaSignal, LiveMessage,
    TrialError, finite, reread,
};
use jointbench_instrument::Kind;
use jointbench_model::formula::{self, Function};
use jointbench_model::{Effect as _, ModelError, ModelSpec, Options, TradeOff, UserEffect};
use serde::{Deserialize, Serialize};

impl Lab {
    pub async fn effects(&self, kind: Option<&str>) -> Answer<Vec<Effect>> {
        let kinds = match kind {
            None => Kind::ALL.to_vec(),
            Some(name) => vec![find_kind(name)?],
        };
        let records = self.inner.store.user_effects().await?;
        let uses = self.inner.store.effect_uses().await?;
        let mut all: Vec<Effect> = Vec::new();
        for kind in kinds {
            all.extend(jointbench_model::effects(kind).iter().map(|effect| effect_view(&effect.info(), None)));
            for record in records.iter().filter(|record| record.kind == kind.name()) {
                all.push(view(record, &uses)?);
            }
        }
        Ok(all)
    }

    /// A model of these effects that may suggest the users' effects that the run uses.
    pub(super) async fn spec(&self, kind: Kind, effects: &[String], run: Option<i64>) -> Answer<ModelSpec> {
        let used = match run {
            Some(run) => self.used_effects(kind, run).await?,
            None => Vec::new(),
        };
        let mut user_effects = self.user_effects(kind).await?;
        user_effects.retain(|one| effects.iter().any(|id| id == one.id()) || used.contains(one));
        Ok(ModelSpec::with_user_effects(kind, effects, user_effects)?)
    }

    /// Users' effects that the diagnosis of a run may suggest.
    pub(super) async fn used_effects(&self, kind: Kind, run: i64) -> Answer<Vec<UserEffect>> {
        let uses = self.inner.store.effect_uses().await?;
        let is_used = |user_effect: &UserEffect| {
            uses.iter().any(|one| one.run == run && one.kind == kind.name() && one.effect == user_effect.id())
        };
        let mut user_effects = self.user_effects(kind).await?;
        user_effects.retain(is_used);
        Ok(user_effects)
    }

    pub(super) async fn user_effects(&self, kind: Kind) -> Answer<Vec<UserEffect>> {
        let records = self.inner.store.user_effects().await?;
        records.iter().filter(|record| record.kind == kind.name()).map(read).collect()
    }

    /// The interpretation of a formula, and its values on a run.
    pub async fn check_effect(&self, trial: &EffectTrial) -> Answer<EffectCheck> {
        match self.reading(trial).await {
            Err(LabError::Formula(fault)) if trial.typing => {
                Ok(EffectCheck { mistake: Some((*fault).into()), ..EffectCheck::default() })
            }
            read => read,
        }
    }

    async fn reading(&self, trial: &EffectTrial) -> Answer<EffectCheck> {
        let user_effect = parse(&trial.effect)?;
        let mut motion = None;
        if let Some(run) = trial.columns_of.or(trial.run) {
            motion = Some(self.facts(run).await?.0.motion);
            let none = self.inner.store.trace(run, None, 0..0).await?;
            let columns: Vec<&str> = none.channels().iter().map(|channel| channel.name.as_str()).collect();
            user_effect.missing(&columns).map_or(Ok(()), |fault| Err(LabError::Formula(fault.into())))?;
        }
        let warnings: Vec<String> = user_effect.unit_warnings(motion).iter().map(ToString::to_string).collect();
        let name = |p: &usize| user_effect.definition().parameters[*p].name.clone();
        let mut check = EffectCheck {
            effect: Some(effect_view(&user_effect.info(), Some(user_effect.definition().clone()))),
            mistake: None,
            doubt: (!warnings.is_empty()).then(|| warnings.join("; ")),
            linear: user_effect.formula().columns.iter().map(|(p, _)| name(p)).collect(),
            shape: user_effect.formula().shape.iter().map(name).collect(),
            signals: user_effect.formula().signals.iter().map(|s| s.name.to_owned()).collect(),
            parameters: Vec::new(),
            like: Vec::new(),
            error: None,
        };
        if trial.run.is_some() {
            let TrialFit { parameters, like, error } = self.compute(Job::TryEffect { trial: trial.clone() }).await?;
            check = EffectCheck { like, parameters, error, ..check };
        }
        Ok(check)
    }

    /// The effect fitted together with the other effects, on the samples that the version of the page uses.
    pub(super) async fn try_effect_here(&self, trial: &EffectTrial) -> Answer<TrialFit> {
        let user_effect = parse(&trial.effect)?;
        let runs: Vec<i64> = trial.run.iter().chain(&trial.more_runs).copied().collect();
        let table = exclusions::without(self.tables(&runs).await?, &trial.exclude)?;
        let model = trial.effects.as_ref().unwrap_or(&table.meta().baseline).iter();
        let others: Vec<String> = model.filter(|id| *id != user_effect.id()).cloned().collect();
        let mut available = self.user_effects(table.kind()).await?;
        available.retain(|one| one.id() != user_effect.id());
        available.push(user_effect.clone());
        let spec = |effects: Vec<&str>| ModelSpec::with_user_effects(table.kind(), effects, available.clone());
        let names = || others.iter().map(String::as_str);
        let (without, with) = (spec(names().collect()), spec(names().chain([user_effect.id()]).collect())?);
        let id = user_effect.id().to_owned();
        let alone = id.clone();
        let (fit, before_rms, like) = blocking(move || {
            let options = Options::default();
            let with = match jointbench_model::fit(&table, &with, &options) {
                Err(ModelError::Collinear { first, second }) if first == alone => {
                    return Ok((None, None, vec![second]));
                }
                Err(ModelError::Collinear { first, second }) if second == alone => {
                    return Ok((None, None, vec![first]));
                }
                fit => fit?,
            };
            // A formula may be tried without other effects: then there is no error before.
            let without = without.and_then(|spec| jointbench_model::fit(&table, &spec, &options)).ok();
            let like = trading(&alone, &with.trade_offs);
            Ok((Some(with), without.and_then(|fit| finite(fit.validation_rms)), like))
        })
        .await?;
        let Some(fit) = fit else { return Ok(TrialFit { like, ..TrialFit::default() }) };
        let error = finite(fit.validation_rms).map(|after_rms| TrialError { before_rms, after_rms, unit: fit.unit });
        let of_effect: Vec<_> = fit.parameters.into_iter().filter(|p| p.effect == id).collect();
        Ok(TrialFit { parameters: of_effect, like, error })
    }

    /// Stores an effect; an existing id gets the next version. The diagnosis of `run`, in whose workbench it was written,
    /// may suggest it.
    pub async fn define_effect(&self, definition: &EffectDefinition, run: Option<i64>, by: &str) -> Answer<Effect> {
        let user_effect = parse(definition)?;
        if let Some(run) = run {
            self.check_kind(run, user_effect.kind()).await?;
        }
        let record = self.keep_effect(&user_effect).await?;
        if let Some(run) = run {
            self.use_effect(run, user_effect.id(), true, by).await?;
        }
        view(&record, &self.inner.store.effect_uses().await?)
    }

    /// Whether the diagnosis of a run may suggest a user's effect.
    pub async fn use_effect(&self, run: i64, effect: &str, used: bool, by: &str) -> Answer<()> {
        let kind = find_kind(&self.inner.store.run(run).await?.kind)?;
        let known = self.user_effects(kind).await?;
        if !known.iter().any(|user_effect| user_effect.id() == effect) {
            return Err(StoreError::NoEffect(effect.to_owned()).into());
        }
        if self.used_effects(kind, run).await?.iter().any(|user_effect| user_effect.id() == effect) == used {
            return Ok(());
        }
        self.inner.store.use_effect(run, kind.name(), effect, used, by).await?;
        tracing::info!(run.id = run, effect, used, by, "use of an effect changed");
        self.publish_effect(kind, effect);
        Ok(())
    }

    async fn check_kind(&self, run: i64, kind: Kind) -> Answer<()> {
        match self.inner.store.run(run).await?.kind {
            of_run if of_run == kind.name() => Ok(()),
            of_run => Err(LabError::Invalid(format!(
                "run {run} is of kind {of_run}, the effect of kind {kind}: name a run of the same kind"
            ))),
        }
    }

    async fn keep_effect(&self, user_effect: &UserEffect) -> Answer<UserEffectRecord> {
        let kept = reread(user_effect.definition())?;
        let record = self.inner.store.save_user_effect(user_effect.kind().name(), user_effect.id(), &kept).await?;
        tracing::info!(effect = user_effect.id(), version = record.version, "effect defined");
        self.publish_effect(user_effect.kind(), user_effect.id());
        Ok(record)
    }

    /// Stores the effects of a model that is imported for a run, which uses them. Refuses an id that has another formula
    /// here.
    pub(super) async fn import_effects(&self, brought: &[UserEffect], run: i64, by: &str) -> Answer<()> {
        let mut new = Vec::new();
        for user_effect in brought {
            let content = |user_effect: &UserEffect| {
                (user_effect.definition().formula.trim().to_owned(), user_effect.definition().parameters.clone())
            };
            match self.user_effects(user_effect.kind()).await?.iter().find(|here| here.id() == user_effect.id()) {
                None => new.push(user_effect),
                Some(here) if content(here) == content(user_effect) => {}
                Some(here) => {
                    let (id, there, here) =
                        (user_effect.id(), &user_effect.definition().formula, &here.definition().formula);
                    let why = if there.trim() == here.trim() { ", with other parameters" } else { "" };
                    return Err(LabError::Invalid(format!(
                        "effect {id} of the model ({there}) differs from effect {id} of this daemon ({here}{why}): \
                         rename one of them, or first define the effect of the model as the next version of {id} \
                         (POST /effects)"
                    )));
                }
            }
        }
        for user_effect in new {
            self.keep_effect(user_effect).await?;
        }
        for user_effect in brought {
            self.use_effect(run, user_effect.id(), true, by).await?;
        }
        Ok(())
    }

    pub async fn delete_effect(&self, kind: &str, id: &str) -> Answer<()> {
        let kind = find_kind(kind)?;
        self.inner.store.delete_user_effect(kind.name(), id).await?;
        self.publish_effect(kind, id);
        Ok(())
    }

    fn publish_effect(&self, kind: Kind, effect: &str) {
        self.hub().publish(LiveMessage::Effects { kind: kind.to_string(), effect: effect.to_owned() });
    }

    pub fn formula_language(&self, kind: &str) -> Answer<FormulaLanguage> {
        let kind = find_kind(kind)?;
        let signal = |s: &formula::NamedSignal| FormulaSignal {
            name: s.name.to_owned(),
            unit: s.unit.to_owned(),
            meaning: s.meaning.to_owned(),
        };
        let other = FormulaSignal {
            name: "column(…)".into(),
            unit: "1".into(),
            meaning: "any other column of the run, in its own unit, such as column(oil_pressure_pa)".into(),
        };
        Ok(FormulaLanguage {
            kind: kind.to_string(),
            left_hand_side: formula::left_hand_side(kind).to_owned(),
            signals: formula::signals(kind).iter().map(signal).chain([other]).collect(),
            functions: Function::ALL.iter().map(|f| f.name().to_owned()).collect(),
            operators: ["+", "-", "*", "/", "^"].map(str::to_owned).into(),
        })
    }
}

/// The other effects that have a parameter trade-off with this one, without repetition.
fn trading(user_effect: &str, pairs: &[TradeOff]) -> Vec<String> {
    let effects =
        |pair: &TradeOff| [&pair.first, &pair.second].map(|name| name.split('.').next().unwrap_or_default().to_owned());
    let other = |[first, second]: [String; 2]| match (first == user_effect, second == user_effect) {
        (true, false) => Some(second),
        (false, true) => Some(first),
        _ => None,
    };
    let mut others: Vec<String> = pairs.iter().map(effects).filter_map(other).collect();
    others.sort();
    others.dedup();
    others
}

fn parse(definition: &EffectDefinition) -> Answer<UserEffect> {
    names::check_effect(definition)?;
    UserEffect::try_from(definition.clone()).map_err(|fault| LabError::Formula(fault.into()))
}

fn read(record: &UserEffectRecord) -> Answer<UserEffect> {
    let unread = |fault| LabError::Internal(format!("effect {} cannot be read: {fault}", record.effect));
    serde_json::from_value(record.definition.clone()).map_err(unread)
}

fn view(record: &UserEffectRecord, uses: &[EffectUse]) -> Answer<Effect> {
    let of_effect = uses.iter().filter(|one| one.kind == record.kind && one.effect == record.effect);
    Ok(Effect {
        version: Some(record.version),
        runs: of_effect.map(|one| one.run).collect(),
        ..effect_view(&read(record)?.info(), Some(reread(&record.definition)?))
    })
}

/// A trial of an effect on the samples of a run.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct TrialFit {
    parameters: Vec<FittedParameter>,
    /// Effects that are confounded with it.
    like: Vec<String>,
    error: Option<TrialError>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trade_offs_name_the_other_effect() {
        let pair =
            |first: &str, second: &str| TradeOff { first: first.into(), second: second.into(), correlation: 0.99 };
        let pairs = [pair("rub.a", "coulomb.tau_c"), pair("viscous.c_v", "rub.a"), pair("rub.a", "rub.w0")];
        let others =
            [pair("coulomb.tau_c", "rub.b"), pair("stribeck.tau_s", "viscous.c_v"), pair("rubber.a", "drift.d")];
        assert_eq!(trading("rub", &[&pairs[..], &others[..]].concat()), ["coulomb", "viscous"]);
    }
}
