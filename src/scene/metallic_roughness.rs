//! glTF 2.0's metallic-roughness, Appendix B.3.5, and its extensions: what the way they add lobes up breaks.

use crate::model;
use crate::model::Violation;
use crate::model::compensation::Factor;
use crate::scene::{Formula, Material, MaterialLobe, Weights};

/// K(0) = ∫ Kd cos θ dω, the most of ∫ (1 − Fc)/π cos θ dω, rounded up.
const DIFFUSE: f64 = 0.971_846;

/// What ρ_dh of oren-nayar is above 1 at most.
const OREN_NAYAR: f64 = 0.0152;

/// What F of a thin film is above 1 at most.
const FILM: f64 = 0.29;

/// Diffuse light is weighed with 1 − F of the half vector, not with what the specular lobe leaves, so that a
/// pale material at grazing sends back more than it gets. The supremum is at base colour 1, metalness 0 and α → 0
/// before μ → 0, where GGX reflects all: ρ_dh = 0.96 K(0) + 1 without extensions. A film adds what its F is above 1, a sheen
/// what its lobe gains, a coat what it reflects itself.
pub(super) fn energy(material: &Material) -> Violation {
    let coat = |lobe: &MaterialLobe| {
        lobe.factors.iter().find_map(|factor| match factor {
            Factor::Coat { weight } => Some(*weight),
            _ => None,
        })
    };
    let base = material.lobes.iter().map(|lobe| match lobe.model.as_str() {
        _ if stands_twice(material, lobe) || coat(lobe).is_some() => 0.0,
        "gltf_diffuse" => DIFFUSE * largest_weight(lobe),
        "gltf_oren_nayar" => largest_weight(lobe),
        // Lambert's is of what is not specular: with it these are 1. Oren and Nayar's is a little more.
        "oren-nayar" => OREN_NAYAR * largest_weight(lobe),
        model if model.ends_with("thin-film") => FILM * largest_weight(lobe),
        _ => 0.0,
    });
    let coats = material.lobes.iter().filter_map(|lobe| Some(coat(lobe)? * largest_weight(lobe)));
    Violation {
        property: "energy",
        bound: under_sheen(material, 1.0 + base.sum::<f64>()) + coats.sum::<f64>(),
        source: "glTF 2.0 specification, Appendix B.3.5: its diffuse and specular lobes do not share energy",
    }
}

/// What a material that no format describes gains by models that are known to, or by its sheen: the sum of what each may
/// reach.
pub(super) fn of_models(material: &Material) -> Option<Violation> {
    let violation = |lobe: &MaterialLobe| {
        let violation = model::find(&lobe.model).ok()?.violation()?;
        (violation.bound.is_finite() && largest_weight(lobe) > 0.0).then_some(violation)
    };
    let source = material.lobes.iter().find_map(violation)?.source;
    let base = material.lobes.iter().filter(|lobe| !is_sheen(material, lobe));
    let bound = |lobe: &MaterialLobe| model::find(&lobe.model).map_or(1.0, |model| model.rho_bound);
    // Of a lobe that Fresnel splits, F90 is the most that it shows.
    let shown = |lobe: &MaterialLobe| match &lobe.weights {
        Weights::Constant(weights) => weights.as_flattened().iter().copied().fold(0.0, f64::max),
        Weights::Textured(formulas) => {
            formulas.each_ref().map(Formula::maximum).into_iter().fold(0.0, f64::max)
        }
    };
    let base = base.map(|lobe| if shown(lobe) > 0.0 { shown(lobe) * bound(lobe) } else { 0.0 });
    Some(Violation { property: "energy", bound: under_sheen(material, base.sum::<f64>().max(1.0)), source })
}

/// The bound B of what lies below a sheen of the colour m and the bound S, and of the sheen with it:
/// m E + (1 − m min(E, 1)) B ≤ max(B, m S + (1 − m) B).
fn under_sheen(material: &Material, base: f64) -> f64 {
    let sheens = material.lobes.iter().filter(|lobe| is_sheen(material, lobe));
    sheens.fold(base, |base, lobe| {
        let bound = model::find(&lobe.model).map_or(1.0, |model| model.rho_bound);
        base.max(largest_weight(lobe) * bound + (1.0 - largest_weight(lobe)) * base)
    })
}

/// Whether others lie below it.
fn is_sheen(material: &Material, lobe: &MaterialLobe) -> bool {
    let factors = material.lobes.iter().flat_map(|lobe| &lobe.factors);
    factors
        .into_iter()
        .any(|factor| matches!(factor, Factor::BelowSheen { of, .. } if of.model.name == lobe.model))
}

/// Whether it is there without one of its factors too: what lies below a layer whose strength varies is there with it and
/// without.
fn stands_twice(material: &Material, lobe: &MaterialLobe) -> bool {
    let is_alike = |other: &MaterialLobe| other.model == lobe.model && other.parameters == lobe.parameters;
    (0..lobe.factors.len()).any(|k| {
        let mut fewer = lobe.factors.clone();
        fewer.remove(k);
        material.lobes.iter().any(|other| is_alike(other) && other.factors == fewer)
    })
}

/// Returns the largest weight of component A.
fn largest_weight(lobe: &MaterialLobe) -> f64 {
    match &lobe.weights {
        Weights::Constant(weights) => weights[0].into_iter().fold(0.0, f64::max),
        Weights::Textured(formulas) => formulas[0].maximum(),
    }
}
