//! Attributes of a joint in MuJoCo's MJCF and in URDF, at the link.
//!
//! MuJoCo XML reference, body/joint: armature [kg·m²], damping [Nm·s/rad], frictionloss [Nm]. URDF XML specification,
//! joint/dynamics: damping [Nm·s/rad], friction [Nm]. The fit is on the motor side: torques grow by the gear ratio N,
//! damping and inertia by N².

use crate::ModelError;
use crate::effects::friction::{coulomb, inertia, load_transmission, viscous};
use crate::export::parts::Parts;
use crate::export::{about, of_model};
use crate::report::fit::{Fit, Parameter};
use jointbench_instrument::Kind;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dialect {
    Mujoco,
    Urdf,
}

/// The element, with a comment that names what it cannot contain.
pub fn joint(fit: &Fit, dialect: Dialect) -> Result<String, ModelError> {
    if fit.kind != Kind::Friction {
        return Err(ModelError::NoExport {
            kind: fit.kind,
            what: "joint attributes",
            why: match fit.kind {
                Kind::Stiffness => {
                    "the gear's compliance is a spring between motor and link, and a joint's stiffness one that pulls it to an \
                     angle of rest; in a simulator make it a second hinge about the same axis, with 1/compliance as its stiffness"
                }
                _ => "only friction models have them",
            },
        });
    }
    let scope = fit.scope.as_ref().ok_or(ModelError::NoScope)?;
    let gear = scope.load_scale;
    let of = |effect: &'static str, name: &str, scale: f64| {
        let found = fit.parameters.iter().find(|p| p.effect == effect && p.name == name);
        // A negative value is not physical, and simulators reject it.
        Attribute { effect, of: found.map(|p| (p, p.value * scale)).filter(|(_, v)| *v >= 0.0 && v.is_finite()) }
    };
    let friction = of(coulomb::ID, "tau_c", gear);
    let damping = of(viscous::ID, "c_v", gear * gear);
    let armature = of(inertia::ID, "j", gear * gear);
    let carried = match dialect {
        Dialect::Mujoco => vec![("frictionloss", friction), ("damping", damping), ("armature", armature)],
        Dialect::Urdf => vec![("damping", damping), ("friction", friction)],
    };
    let held = |id: &str| id == load_transmission::ID || carried.iter().any(|(_, a)| a.effect == id && a.of.is_some());
    let left_out: Vec<(&str, String)> =
        fit.effects.iter().filter(|id| !held(id)).map(|id| (id.as_str(), reason(id, dialect).to_owned())).collect();
    let attributes: Vec<String> =
        carried.iter().filter_map(|(name, a)| a.of.map(|(_, value)| format!("{name}=\"{value}\""))).collect();
    // The comment follows directly before the element and states the uncertainty of its values.
    let uncertainties = carried.iter().filter_map(|(name, a)| Some((name, a.of?.0)));
    let uncertainties = uncertainties
        .flat_map(|(name, parameter)| parameter.note.iter().map(move |note| format!("{name}, motor side: {note}")));
    let mut parts = Parts::of(fit)?;
    parts.parts.retain(|part| held(part.effect));
    let mut words = about(fit, &parts, &left_out, vec![of_model(fit, &left_out)]);
    words.push(format!("At the link: torque times the gear ratio {gear}, damping and inertia times its square."));
    let comment: String = words.iter().map(|words| format!("  {}\n", plain(words))).collect();
    let uncertainties: String = uncertainties.map(|words| format!("<!-- {} -->\n", plain(&words))).collect();
    let element = match dialect {
        Dialect::Mujoco => format!("<joint {}/>", attributes.join(" ")),
        Dialect::Urdf => format!("<dynamics {}/>", attributes.join(" ")),
    };
    Ok(format!("<!--\n{comment}-->\n{uncertainties}{element}\n"))
}

/// The effect of an attribute, with its parameter and the value at the link.
#[derive(Debug, Clone, Copy)]
struct Attribute<'f> {
    effect: &'static str,
    of: Option<(&'f Parameter, f64)>,
}

/// Two hyphens are not allowed in an XML comment.
fn plain(words: &str) -> String {
    words.replace("--", "- -")
}

fn reason(effect: &str, dialect: Dialect) -> &'static str {
    match (effect, dialect) {
        (inertia::ID, Dialect::Urdf) => "URDF has no armature; add it to the inertia of the link",
        (coulomb::ID | viscous::ID | inertia::ID, _) => "its value is negative or not known",
        _ => "there is no attribute for it",
    }
}
