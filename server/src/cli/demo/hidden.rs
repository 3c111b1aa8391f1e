//! The effect that the demo hides, and its simulated bench.

use crate::cli::arguments::Demo;
use crate::cli::exit::Exit;
use jointbench_devices::Joint;
use jointbench_devices::sim::HIDDEN_EFFECTS;
use jointbench_instrument::Kind;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};

/// The bench that shows a kind of effect.
pub struct Setup {
    pub bench: &'static str,
    pub joint: Joint,
    pub procedure: &'static str,
    pub title: &'static str,
    /// Effects of every bench of this kind.
    pub ordinary: &'static str,
    /// Its effects that the baseline of the procedure lacks. The initial model contains them.
    pub known: &'static [&'static str],
    /// The effect that is hidden where none is asked for.
    usual: &'static str,
}

impl Setup {
    const fn of(kind: Kind) -> Self {
        match kind {
            Kind::Friction => Self {
                bench: "joint-a-mock",
                joint: Joint::JointA,
                procedure: "friction",
                title: "joint (strain-wave gear 177.8:1)",
                ordinary: "Coulomb and viscous friction",
                known: &[],
                usual: "load_linear",
            },
            Kind::Encoder => Self {
                bench: "encoder-bench-mock",
                joint: Joint::EncoderShaft,
                procedure: "encoder_linearity",
                title: "encoder bench (optical reference, magnetic ring under test)",
                ordinary: "the eccentricity, tilt, pole period error and hysteresis of the data sheet",
                known: &["harmonic_1", "harmonic_2", "pole_period", "direction_hysteresis"],
                usual: "harmonic_n",
            },
            Kind::Stiffness => Self {
                bench: "joint-a-mock",
                joint: Joint::JointA,
                procedure: "stiffness",
                title: "joint (strain-wave gear 177.8:1)",
                ordinary: "the stiffness and directional offset of the data sheet",
                known: &[],
                usual: "hardening",
            },
            Kind::Brake => Self {
                bench: "joint-a-mock",
                joint: Joint::JointA,
                procedure: "brake_hysteresis",
                title: "hysteresis brake behind a joint (strain-wave gear 177.8:1)",
                ordinary: "the saturation and hysteresis of the data sheet",
                known: &["saturation", "hysteresis"],
                usual: "velocity_dependence",
            },
        }
    }
}

/// The hidden effect. Measurement and model do not know it.
pub struct Hidden {
    pub setup: Setup,
    pub effect: &'static str,
    pub seed: u64,
    pub is_secret: bool,
}

impl Hidden {
    pub fn choose(arguments: &Demo) -> Result<Self, Exit> {
        if let Some(seed) = arguments.seed {
            let mut draw = StdRng::seed_from_u64(seed);
            let of_kind = arguments.kind.and_then(|kind| HIDDEN_EFFECTS.iter().find(|(of, _)| *of == kind));
            let (kind, effects) =
                *of_kind.unwrap_or_else(|| &HIDDEN_EFFECTS[draw.random_range(0..HIDDEN_EFFECTS.len())]);
            let effect = effects[draw.random_range(0..effects.len())];
            return Ok(Self { setup: Setup::of(kind), effect, seed, is_secret: true });
        }
        let (kind, effect) = match &arguments.effect {
            None => {
                let kind = arguments.kind.unwrap_or(Kind::Friction);
                (kind, Setup::of(kind).usual)
            }
            Some(asked) => named(asked, arguments.kind)?,
        };
        Ok(Self { setup: Setup::of(kind), effect, seed: 1, is_secret: false })
    }
}

/// The effect of that name, of this kind or of any.
fn named(asked: &str, kind: Option<Kind>) -> Result<(Kind, &'static str), Exit> {
    let kinds = || HIDDEN_EFFECTS.iter().filter(|(of, _)| kind.is_none_or(|kind| kind == *of));
    let mut all = kinds().flat_map(|(kind, effects)| effects.iter().map(|effect| (*kind, *effect)));
    all.find(|(_, effect)| *effect == asked).ok_or_else(|| {
        let lines: Vec<String> = kinds().map(|(kind, effects)| format!("{kind}: {}", effects.join(", "))).collect();
        Exit::bad_input(format!("--effect {asked}: the mock bench can hide\n  {}", lines.join("\n  ")))
    })
}
