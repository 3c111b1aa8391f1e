//! A model laid out on a prepared run: settled effects on the plateaus, ramps and memory where the motion changes.

use crate::effect::Stage;
use crate::prepare::{Prepared, Problem};
use crate::report::Invisible;
use crate::select::Ground;
use crate::terms::{Term, Terms, columns, polish};
use crate::{Effect, ModelError, ModelSpec};

#[derive(Clone)]
pub struct Assembly<'p> {
    pub prepared: &'p Prepared,
    /// What the model was at first, and the effects that it may hold.
    pub spec: &'p ModelSpec,
    /// Ids in the order of the model.
    pub effects: Vec<String>,
    pub main: Terms<'p>,
    pub moving: Option<Terms<'p>>,
    /// Effects of the model that this data cannot show.
    pub hidden: Vec<Invisible>,
}

impl<'p> Assembly<'p> {
    /// Finds forms and starting shapes of every effect and refines them.
    pub fn new(prepared: &'p Prepared, spec: &'p ModelSpec) -> Result<Self, ModelError> {
        if spec.kind != prepared.kind {
            return Err(ModelError::WrongKind { run: prepared.kind, model: spec.kind });
        }
        let mut assembly = Self {
            prepared,
            spec,
            effects: spec.effects.clone(),
            main: Terms::new(&prepared.main),
            moving: prepared.moving.as_ref().map(Terms::new),
            hidden: Vec::new(),
        };
        for id in &spec.effects {
            let effect = spec.find(id)?;
            if let Some(own) = spec.own.iter().find(|own| own.id() == id) {
                own.check(&prepared.main.view)?;
            }
            if let Some(why) = effect.hidden(&prepared.main.view) {
                assembly.hidden.push(Invisible { effect: id.clone(), why });
            } else if effect.is_given() {
                let given = columns(effect, "linear", &[], assembly.main.problem);
                add(&mut assembly.main.given, &given, &[1.0]);
            } else if !assembly.is_apart(effect) {
                enter(&mut assembly.main, effect);
            }
        }
        choose_again(&mut assembly.main);
        assembly.main.refine();
        assembly.enter_moving();
        Ok(assembly)
    }

    /// Plateaus say nothing about the effect: it is judged where the motion changes.
    pub fn is_apart(&self, effect: &dyn Effect) -> bool {
        effect.stage() != Stage::Settled && self.prepared.about.residual == crate::ResidualKind::PlateauMean
    }

    /// The same model with an effect that was found where the motion changes.
    pub fn with_memory(&self, term: &Term<'p>) -> Self {
        let mut next = self.clone();
        next.effects.push(term.id().into());
        if let Some(moving) = &mut next.moving {
            moving.terms.push(Term::new(term.effect, term.form.clone(), term.shape.clone(), moving.problem));
            moving.refine();
        }
        next
    }

    /// What the model predicts at the rows of another problem of the same run.
    pub fn predict(&self, problem: &Problem) -> Vec<f64> {
        let mut sum = vec![0.0; problem.rows()];
        for id in &self.effects {
            let Ok(effect) = self.spec.find(id) else { continue };
            if effect.is_given() && !self.hidden.iter().any(|h| h.effect == *id) {
                add(&mut sum, &columns(effect, "linear", &[], problem), &[1.0]);
            }
        }
        for part in std::iter::once(&self.main).chain(&self.moving) {
            for (term, factors) in part.terms.iter().zip(part.linear().factors) {
                add(&mut sum, &columns(term.effect, term.form.name, &term.shape, problem), &factors);
            }
        }
        sum
    }

    /// Lays the settled part under the moving problem.
    fn relay(&mut self) {
        let Some(moving) = &mut self.moving else { return };
        moving.given.fill(0.0);
        for id in &self.effects {
            let Ok(effect) = self.spec.find(id) else { continue };
            if effect.is_given() && !self.hidden.iter().any(|h| h.effect == *id) {
                add(&mut moving.given, &columns(effect, "linear", &[], moving.problem), &[1.0]);
            }
        }
        for (term, factors) in self.main.terms.iter().zip(self.main.linear().factors) {
            let columns = columns(term.effect, term.form.name, &term.shape, moving.problem);
            add(&mut moving.given, &columns, &factors);
        }
        moving.refine();
    }

    /// Enters the effects that are judged where the motion changes.
    fn enter_moving(&mut self) {
        let apart: Vec<&'p dyn Effect> = self
            .spec
            .effects
            .iter()
            .filter_map(|id| self.spec.find(id).ok())
            .filter(|e| self.is_apart(*e) && !self.hidden.iter().any(|h| h.effect == e.info().id))
            .collect();
        if self.moving.is_none() {
            let why = "the run has no ramps or reversals that could show it".to_owned();
            self.hidden.extend(apart.iter().map(|e| Invisible { effect: e.info().id.into(), why: why.clone() }));
            return;
        }
        self.relay();
        let Some(moving) = &mut self.moving else { return };
        apart.into_iter().for_each(|effect| enter(moving, effect));
        moving.refine();
    }

    /// The same model with another settled part.
    pub fn with_main(&self, main: Terms<'p>, effects: Vec<String>) -> Self {
        let mut next = Self { main, effects, ..self.clone() };
        next.relay();
        next
    }
}

fn add(sum: &mut [f64], columns: &[Vec<f64>], factors: &[f64]) {
    for (column, factor) in columns.iter().zip(factors) {
        sum.iter_mut().zip(column).for_each(|(s, c)| *s += factor * c);
    }
}

/// A form must take this share off the squared error for each parameter that it has more than a simpler one.
const BETTER_FORM: f64 = 0.01;

/// Enters an effect in the form that explains most of what is left, each form at its own best shape.
fn enter<'p>(terms: &mut Terms<'p>, effect: &'p dyn Effect) {
    let problem: &Problem = terms.problem;
    let forms = effect.forms(&problem.view);
    if let [form] = &forms[..]
        && form.grid.len() == 1
    {
        terms.terms.push(Term::new(effect, form.clone(), form.grid[0].clone(), problem));
        return;
    }
    let basis = terms.tangent();
    let residual = basis.rest(&terms.response());
    let ground = Ground::new(basis, residual, problem);
    let mut best: Vec<Term<'p>> = Vec::new();
    for form in forms {
        let shapes = form.grid.iter().map(|shape| Term::new(effect, form.clone(), shape.clone(), problem));
        let shares = shapes.map(|term| (ground.own(&term.columns).share, term));
        best.extend(shares.max_by(|a, b| a.0.total_cmp(&b.0)).map(|b| b.1));
    }
    best.sort_by_key(Term::size);
    let mut chosen: Option<(f64, Term<'p>)> = None;
    for term in best {
        let mut term = [term];
        let sse = polish(&mut term, &ground.basis, &ground.residual, problem);
        let [term] = term;
        let needed = |(least, simple): &(f64, Term)| {
            least * (1.0 - BETTER_FORM * term.size().saturating_sub(simple.size()) as f64)
        };
        if chosen.as_ref().is_none_or(|c| sse < needed(c)) {
            chosen = Some((sse, term));
        }
    }
    terms.terms.extend(chosen.map(|c| c.1));
}

/// Chooses the forms again, each beside all other effects of the model: the first to enter did not know of the last.
fn choose_again<'p>(terms: &mut Terms<'p>) {
    let problem: &Problem = terms.problem;
    let several = |e: &&'p dyn Effect| e.forms(&problem.view).len() > 1;
    let effects: Vec<&'p dyn Effect> = terms.terms.iter().map(|t| t.effect).filter(several).collect();
    for effect in effects {
        terms.terms.retain(|t| t.id() != effect.info().id);
        enter(terms, effect);
    }
}
