//! The ideal mirror, what every microfacet model tends to as α → 0. Twin of `shaders/delta/mirror.wgsl`.
//!
//! f = F δ(θi − θe) δ(φi + π − φe) / (cos θi sin θi) with any Fresnel term, whose components and parameters are all
//! that it has. It has no values; ρ_dh(μ) = F(μ), and ρ_hh = 2 ∫ F(μ) μ dμ.

use crate::base::precision::VALUE_F32;
use crate::model::fresnel::schlick::Schlick;
use crate::model::fresnel::{Fresnel, MEAN_NODES_UNKNOWN};
use crate::model::{Component, Integral, Microfacet, Model, Part, Term, part};
use std::marker::PhantomData;

const TERM: Term = Term {
    name: "mirror",
    summary: "the ideal mirror, a delta: no values, integrals in closed form",
    source: "f = F δ(θi − θe) δ(φi + π − φe) / (cos θi sin θi)",
    part: part!("delta/mirror"),
};

/// The mirror with the default, all of it reflected.
pub(crate) static MODEL: Model = Model {
    summary: "the ideal mirror, a delta: no values, integrals in closed form; Schlick's Fresnel",
    source: "f = F δ(θi − θe) δ(φi + π − φe) / (cos θi sin θi); Schlick 1994, eq. 15",
    components: &Component::schlick(1.0),
    ..MirrorOf::<Schlick>::MODEL
};

/// The mirror with a Fresnel term.
pub(super) struct MirrorOf<F>(PhantomData<F>);

impl<F: Fresnel> MirrorOf<F> {
    pub const MODEL: Model = Model {
        name: TERM.name,
        summary: TERM.summary,
        source: TERM.source,
        microfacet: Some(&Self::TERMS),
        components: F::COMPONENTS,
        shape: None,
        parameters: F::PARAMETERS,
        derive: F::derive,
        rho_bound: F::BOUND,
        parts: &Self::PARTS,
        value_f32: VALUE_F32 + F::VALUE_F32,
        integral: Integral::Delta(|mu, s| F::fresnel(mu, 1.0 - mu, s)),
        lobe: |p, a, s| F::fresnel(p.mu_i, 1.0 - p.mu_i, s).map(|f| f * p.bin * a.bin),
    };

    const TERMS: Microfacet = Microfacet {
        ndf: TERM,
        masking: None,
        fresnel: F::TERM,
        metals: F::METALS,
        refused: F::refused,
        is_counted: true,
        facets: None,
        mean_nodes: match F::COUNTS {
            Some(counts) => counts.mean_nodes,
            None => |_, _| MEAN_NODES_UNKNOWN,
        },
        faint: None,
        seam: None,
        value_f32: |_| crate::base::precision::VALUE_F32,
        rho_most: |_| f64::INFINITY,
        integral_f32: crate::base::precision::INTEGRAL_F32,
    };
    const PARTS: [Part; 2] = [F::TERM.part, TERM.part];
}
