//! glTF 2.0's metallic-roughness, Appendix B.3.5: how it adds its two lobes up, and what that breaks.
//!
//! f = 0.96 (1 − m) c · Kd + (0.04 (1 − m) + m c) · A + B of base colour c and metalness m.

use crate::models::Violation;

/// The weights (a, b) of a lobe's components.
pub(super) fn weights(model: &str, base_color: f64, metallic: f64) -> [f64; 2] {
    match model {
        "gltf_diffuse" => [0.96 * (1.0 - metallic) * base_color, 0.0],
        _ => [0.04 * (1.0 - metallic) + metallic * base_color, 1.0],
    }
}

/// Diffuse light is weighed with 1 − Fc of the half vector, not with what the specular lobe leaves, so that a
/// pale material at grazing sends back more than it gets. The supremum is at c = 1, m = 0 and α → 0 before
/// μ → 0, where GGX reflects all: ρ_dh = 0.96 K(0) + 1 with K(0) = ∫ Kd cos θ dω = 0.971845.
pub(super) const ENERGY: Violation = Violation {
    property: "energy",
    bound: 1.932_972,
    source: "glTF 2.0 specification, Appendix B.3.5: its diffuse and specular lobes do not share energy",
};
