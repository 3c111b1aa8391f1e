//! Effects that users write: checked, stored, and available to every model of their kind.

use super::models::{blocking, effect_view, find_kind};
use super::{Answer, Lab, LabError, names};
use crate::job::Job;
use crate::store::UserEffectRecord;
use crate::view::{
    Effect, EffectCheck, EffectDefinition, EffectTrial, FittedParameter, FormulaLanguage, FormulaSignal, LiveMessage,
    reread,
};
use jointbench_instrument::Kind;
use jointbench_model::formula::{self, Function};
use jointbench_model::{Definition, Effect as _, ModelError, ModelSpec, Options, OwnEffect, TradeOff};

impl Lab {
    pub async fn effects(&self, kind: Option<&str>) -> Answer<Vec<Effect>> {
        let kinds = match kind {
            None => Kind::ALL.to_vec(),
            Some(name) => vec![find_kind(name)?],
        };
        let records = self.inner.store.user_effects().await?;
        let mut all: Vec<Effect> = Vec::new();
        for kind in kinds {
            all.extend(jointbench_model::effects(kind).iter().map(|effect| effect_view(&effect.info())));
            for record in records.iter().filter(|record| record.kind == kind.name()) {
                all.push(view(record)?);
            }
        }
        Ok(all)
    }

    /// A model of these effects that may contain and suggest all users' effects.
    pub(super) async fn spec(&self, kind: Kind, effects: &[String]) -> Answer<ModelSpec> {
        Ok(ModelSpec::with_own(kind, effects, self.user_effects(kind).await?)?)
    }

    pub(super) async fn user_effects(&self, kind: Kind) -> Answer<Vec<OwnEffect>> {
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
        let own = parse(&trial.effect)?;
        let mut motion = None;
        if let Some(run) = trial.columns_of.or(trial.run) {
            motion = Some(self.facts(run).await?.0.motion);
            let none = self.inner.store.trace(run, None, 0..0).await?;
            let columns: Vec<&str> = none.channels().iter().map(|channel| channel.name.as_str()).collect();
            own.missing(&columns).map_or(Ok(()), |fault| Err(LabError::Formula(fault.into())))?;
        }
        let warnings: Vec<String> = own.unit_warnings(motion).iter().map(ToString::to_string).collect();
        let name = |p: &usize| own.definition().parameters[*p].name.clone();
        let mut check = EffectCheck {
            effect: Some(Effect { definition: Some(reread(own.definition())?), ..effect_view(&own.info()) }),
            mistake: None,
            doubt: (!warnings.is_empty()).then(|| warnings.join("; ")),
            linear: own.formula().columns.iter().map(|(p, _)| name(p)).collect(),
            shape: own.formula().shape.iter().map(name).collect(),
            signals: own.formula().signals.iter().map(|s| s.name.to_owned()).collect(),
            parameters: Vec::new(),
            like: Vec::new(),
        };
        if trial.run.is_some() {
            let (parameters, like) = self.compute(Job::TryEffect { trial: trial.clone() }).await?;
            check = EffectCheck { like, parameters, ..check };
        }
        Ok(check)
    }

    /// Fitted parameters of the effect together with the other effects, and the effects that are confounded with it.
    pub(super) async fn try_effect_here(&self, trial: &EffectTrial) -> Answer<(Vec<FittedParameter>, Vec<String>)> {
        let own = parse(&trial.effect)?;
        let runs: Vec<i64> = trial.run.iter().chain(&trial.more_runs).copied().collect();
        let table = self.tables(&runs).await?;
        let model = trial.effects.as_ref().unwrap_or(&table.meta().baseline).iter();
        let effects = model.map(String::as_str).filter(|id| *id != own.id()).chain([own.id()]);
        let others = self.user_effects(table.kind()).await?.into_iter().filter(|other| other.id() != own.id());
        let spec = ModelSpec::with_own(table.kind(), effects, others.chain([own.clone()]).collect())?;
        let id = own.id().to_owned();
        let (found, like) = blocking(move || match jointbench_model::fit(&table, &spec, &Options::default()) {
            Err(ModelError::Collinear { first, second }) if first == id => Ok((Vec::new(), vec![second])),
            Err(ModelError::Collinear { first, second }) if second == id => Ok((Vec::new(), vec![first])),
            fit => fit.map(|fit| {
                let found: Vec<_> = fit.parameters.into_iter().filter(|p| p.effect == id).collect();
                (found, trading(&id, &fit.trade_offs))
            }),
        })
        .await?;
        Ok((reread(&found)?, like))
    }

    /// Stores an effect; an existing id gets the next version.
    pub async fn define_effect(&self, definition: &EffectDefinition) -> Answer<Effect> {
        view(&self.keep_effect(&parse(definition)?).await?)
    }

    async fn keep_effect(&self, own: &OwnEffect) -> Answer<UserEffectRecord> {
        let kept = reread(own.definition())?;
        let record = self.inner.store.save_user_effect(own.kind().name(), own.id(), &kept).await?;
        tracing::info!(effect = own.id(), version = record.version, "effect defined");
        self.publish_effect(own.kind(), own.id());
        Ok(record)
    }

    /// Stores the effects of an imported model, so that models can use them here. Refuses an id that has another
    /// formula here.
    pub(super) async fn import_effects(&self, brought: &[OwnEffect]) -> Answer<()> {
        let mut new = Vec::new();
        for own in brought {
            let content =
                |own: &OwnEffect| (own.definition().formula.trim().to_owned(), own.definition().parameters.clone());
            match self.user_effects(own.kind()).await?.iter().find(|here| here.id() == own.id()) {
                None => new.push(own),
                Some(here) if content(here) == content(own) => {}
                Some(here) => {
                    let (id, there, here) = (own.id(), &own.definition().formula, &here.definition().formula);
                    let why = if there.trim() == here.trim() { ", with other parameters" } else { "" };
                    return Err(LabError::Invalid(format!(
                        "effect {id} of the model ({there}) differs from effect {id} of this daemon ({here}{why}): \
                         rename one of them, or first define the effect of the model as the next version of {id} \
                         (POST /effects)"
                    )));
                }
            }
        }
        for own in new {
            self.keep_effect(own).await?;
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
fn trading(own: &str, pairs: &[TradeOff]) -> Vec<String> {
    let effects =
        |pair: &TradeOff| [&pair.first, &pair.second].map(|name| name.split('.').next().unwrap_or_default().to_owned());
    let other = |[first, second]: [String; 2]| match (first == own, second == own) {
        (true, false) => Some(second),
        (false, true) => Some(first),
        _ => None,
    };
    let mut others: Vec<String> = pairs.iter().map(effects).filter_map(other).collect();
    others.sort();
    others.dedup();
    others
}

fn parse(definition: &EffectDefinition) -> Answer<OwnEffect> {
    find_kind(&definition.kind)?;
    names::check_effect(definition)?;
    let definition: Definition = reread(definition)?;
    OwnEffect::try_from(definition).map_err(|fault| LabError::Formula(fault.into()))
}

fn read(record: &UserEffectRecord) -> Answer<OwnEffect> {
    let unread = |fault| LabError::Internal(format!("effect {} cannot be read: {fault}", record.effect));
    serde_json::from_value(record.definition.clone()).map_err(unread)
}

fn view(record: &UserEffectRecord) -> Answer<Effect> {
    Ok(Effect {
        definition: Some(reread(&record.definition)?),
        version: Some(record.version),
        ..effect_view(&read(record)?.info())
    })
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
