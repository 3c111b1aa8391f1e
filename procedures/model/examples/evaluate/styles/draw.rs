//! Hidden effects of a run.

use crate::made::Dice;

/// Effects of the machine that its model lacks, and those outside the library.
#[derive(Default, Clone)]
pub struct Plan {
    pub hidden: Vec<&'static str>,
    pub outside: Option<&'static str>,
}

impl Plan {
    /// One in seven runs hides nothing, one in eight something outside the library, the others one or two effects.
    pub fn draw(dice: &mut Dice, effects: &[&'static str], outside: &[&'static str]) -> Self {
        let lot = dice.uniform(0.0, 1.0);
        if lot < 0.15 {
            return Self::default();
        }
        if lot < 0.27 {
            return Self { outside: Some(*dice.pick(outside)), ..Self::default() };
        }
        let count = if lot < 0.83 { 1 } else { 2 };
        let mut effects = effects.to_vec();
        dice.shuffle(&mut effects);
        effects.truncate(count);
        Self { hidden: effects, outside: None }
    }

    pub fn hides(&self, effect: &str) -> bool {
        self.hidden.iter().chain(&self.outside).any(|h| *h == effect)
    }
}
