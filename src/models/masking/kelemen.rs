//! Kelemen & Szirmay-Kalos 2001, *A Microfacet Based Coupled Specular-Matte BRDF Model with Importance Sampling*:
//! G2 = μi μe / (ωi·ωm)², so that f = D F / |ωi + ωe|². Twin of `shaders/masking/kelemen.wgsl`.
//!
//! An approximation of Cook and Torrance's G by one division; it knows no roughness. α → 0 leaves the mirror whole.
//! Kept: finite but where both directions graze, not negative, reciprocal; energy.

use super::{Masking, Toward};
use crate::models::ndf::Ndf;
use crate::models::{SlopeCounts, Term, part};
use crate::pair::{Half, Pair};
use crate::reference;

pub(crate) struct Kelemen;

impl Masking for Kelemen {
    const TERM: Term = Term {
        name: "kelemen",
        summary: "Kelemen and Szirmay-Kalos's quotient",
        source: "Kelemen & Szirmay-Kalos 2001",
        part: part!("masking/kelemen"),
    };
    const REFERENCE: &'static dyn reference::Masking = &reference::Kelemen;
    const OF_NORMAL: bool = true;
    /// 1/(ωi·ωm) turns at tan θm ~ μ/α.
    const GRADE: i32 = 4;

    /// Grading spreads what correlated Smith takes where it need not be: measured.
    fn counts(correlated: [SlopeCounts; 2], _tolerance: f64) -> [SlopeCounts; 2] {
        correlated.map(|counts| counts.more(3.5))
    }

    fn visibility<N: Ndf>(_i: &Toward, _e: &Toward) -> f64 {
        0.25
    }

    fn of_normal(shared: f64, _p: &Pair, h: &Half) -> f64 {
        shared / h.h2
    }
}
