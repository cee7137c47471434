//! Kelemen & Szirmay-Kalos 2001, *A Microfacet Based Coupled Specular-Matte BRDF Model with Importance Sampling*:
//! G2 = μi μe / (ωi·ωm)², so that f = D F / |ωi + ωe|². Twin of `shaders/masking/kelemen.wgsl`.
//!
//! An approximation of Cook and Torrance's G by one division; it knows no roughness. α → 0 leaves the mirror whole.
//! Kept: finite but where both directions graze, not negative, reciprocal; energy.

use crate::base::half_angle::{Half, Pair};
use crate::model::half_vector::Kinks;
use crate::model::masking::{Masking, MaskingCounts, Toward};
use crate::model::ndf::Ndf;
use crate::model::{SlopeCounts, Term, part};

pub(crate) struct Kelemen;

impl Masking for Kelemen {
    const TERM: Term = Term {
        name: "kelemen",
        summary: "Kelemen and Szirmay-Kalos's quotient",
        source: "Kelemen & Szirmay-Kalos 2001",
        part: part!("masking/kelemen"),
    };
    const OF_NORMAL: Option<Kinks> = Some(KINKS);
    const TURNS: bool = true;
    const COUNTS: Option<MaskingCounts> =
        Some(|correlated, tolerance| correlated.map(|side| counts(side, tolerance)));

    fn visibility<N: Ndf>(_i: &Toward, _e: &Toward) -> f64 {
        0.25
    }

    fn of_normal(shared: f64, _p: &Pair, h: &Half) -> f64 {
        shared / h.h2
    }
}

/// ωi·ωm = cos θm cos θi (1 + c tan θm): its inverse turns at tan θm ~ 1/c, that is μ.
pub(crate) const KINKS: Kinks = Kinks { turn: |c| (c > 0.0).then(|| 1.0 / c), is_sharp: true, ..Kinks::NONE };

/// Nodes have the turn and the lobe to resolve: measured; 8 in place of 9 leave 2.5 times 1e-9.
pub(crate) fn counts(correlated: SlopeCounts, tolerance: f64) -> SlopeCounts {
    correlated.at_least([4, 9], tolerance)
}
