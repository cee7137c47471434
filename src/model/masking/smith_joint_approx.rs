//! Hammon 2017, *PBR Diffuse Lighting for GGX+Smith Microsurfaces*: an approximation of height-correlated Smith for GGX,
//! which Godot, Unreal Engine and Filament's mobile path evaluate. Twin of `shaders/masking/smith_joint_approx.wgsl`.
//!
//! ```text
//! V = G2/(4 μi μe) = ½ / mix(2 μi μe, μi + μe, α)
//! ```
//!
//! That is correlated Smith with (1 − α) μ + α in place of GGX's (1 + 2Λ) μ = √(α² + (1 − α²) μ²). It masks more, as the
//! difference of the squares is 2α(1 − α) μ(1 − μ) ≥ 0, and the same at α = 1: as α → 0, ρ_dh of GGX is 0.663 near μ = α,
//! where Smith's is 0.89. α is the NDF's own, of stretched normals the one that each direction sees.
//!
//! α → 0 leaves the mirror whole. Kept: finite but where both directions graze, not negative, reciprocal; energy with GGX and
//! Beckmann, whose Λ is no larger.

use crate::model::masking::{Masking, Toward};
use crate::model::ndf::Ndf;
use crate::model::{Term, part};

pub(crate) struct SmithJointApprox;

impl Masking for SmithJointApprox {
    const TERM: Term = Term {
        name: "smith-joint-approx",
        summary: "Hammon's approximation of height-correlated Smith, as engines have it",
        source: "Hammon 2017, PBR Diffuse Lighting for GGX+Smith Microsurfaces",
        part: part!("masking/smith_joint_approx"),
    };
    const UNBOUNDED_OFF_PEAK: Option<&'static str> = Some(
        "without a peak ρ grows as α → 0 where masking vanishes, beyond any bound, and no tolerance holds there",
    );

    fn visibility<N: Ndf>(i: &Toward, e: &Toward) -> f64 {
        0.5 / (i.mu * root(e) + e.mu * root(i))
    }
}

/// (1 − α) μ + α
fn root(w: &Toward) -> f64 {
    w.mu + w.setting.alpha * (1.0 - w.mu)
}
