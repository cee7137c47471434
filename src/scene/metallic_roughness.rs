//! glTF 2.0's metallic-roughness, Appendix B.3.5, and its extensions: what the way they add lobes up breaks.

use super::{Material, Weights};
use crate::factor::Factor;
use crate::models::Violation;

/// K(0) = ∫ Kd cos θ dω, the most of ∫ (1 − Fc)/π cos θ dω, rounded up.
const DIFFUSE: f64 = 0.971_846;

/// What F of a thin film is above 1 at most.
const FILM: f64 = 0.29;

/// Diffuse light is weighed with 1 − F of the half vector, not with what the specular lobe leaves, so that a
/// pale material at grazing sends back more than it gets. The supremum is at base colour 1, metalness 0 and α → 0
/// before μ → 0, where GGX reflects all: ρ_dh = 0.96 K(0) + 1 without extensions. A coat adds what it reflects itself,
/// a film what its F is above 1.
pub(super) fn energy(material: &Material) -> Violation {
    let gains = material.lobes.iter().map(|lobe| {
        let most = match &lobe.weights {
            Weights::Constant(weights) => weights[0].into_iter().fold(0.0, f64::max),
            Weights::Textured(formulas) => formulas[0].most(),
        };
        let coat = lobe.factors.iter().find_map(|factor| match factor {
            Factor::Coat { weight } => Some(*weight),
            _ => None,
        });
        // Where a coat's strength varies, what is below it stands twice: with and without it.
        let is_dimmed = matches!(lobe.weights, Weights::Textured(_))
            && lobe.factors.iter().any(|factor| matches!(factor, Factor::BelowCoat { .. }));
        match (lobe.model.as_str(), coat) {
            _ if is_dimmed => 0.0,
            ("gltf_diffuse", _) => DIFFUSE * most,
            // Of what is not specular: with it these are 1.
            ("lambert", _) => 0.0,
            (_, Some(weight)) => weight * most,
            (model, None) if model.ends_with("thin-film") => FILM * most,
            _ => 0.0,
        }
    });
    Violation {
        property: "energy",
        bound: 1.0 + gains.sum::<f64>(),
        source: "glTF 2.0 specification, Appendix B.3.5: its diffuse and specular lobes do not share energy",
    }
}
