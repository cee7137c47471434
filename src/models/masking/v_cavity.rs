//! Masking and shadowing in V-shaped grooves: Torrance & Sparrow 1967; Cook & Torrance 1982, section 4:
//! G2 = min(1, 2 cos θm μi / (ωi·ωm), 2 cos θm μe / (ωi·ωm)). Twin of `shaders/masking/v_cavity.wgsl`.
//!
//! It knows no roughness, and has kinks: where masking begins, and where the directions change roles. α → 0 leaves the
//! mirror whole. Kept: finite but where both directions graze, not negative, reciprocal; energy: it is the exact
//! masking of grooves that each have one of the slopes (Heitz 2014, section 5.2).

use super::{Masking, Toward};
use crate::models::half_vector::Kinks;
use crate::models::ndf::Ndf;
use crate::models::{SlopeCounts, Term, part};
use crate::pair::{Half, Pair};
use crate::reference;
use std::f64::consts::FRAC_PI_2;

pub(crate) struct VCavity;

impl Masking for VCavity {
    const TERM: Term = Term {
        name: "v-cavity",
        summary: "V-shaped grooves",
        source: "Torrance & Sparrow 1967; Cook & Torrance 1982, section 4",
        part: part!("masking/v_cavity"),
    };
    const REFERENCE: &'static dyn reference::Masking = &reference::VCavity;
    const OF_NORMAL: bool = true;
    const KINKS: Kinks = Kinks { breaks, most: 2, meet: Some(1.0), is_sharp: true, ..Kinks::NONE };

    /// Where correlated Smith is nearly constant, kinks are not: measured.
    fn counts(correlated: [SlopeCounts; 2], tolerance: f64) -> [SlopeCounts; 2] {
        correlated.map(|counts| counts.at_least([4, 3], tolerance))
    }

    fn visibility<N: Ndf>(i: &Toward, e: &Toward) -> f64 {
        0.25 / (i.mu * e.mu)
    }

    /// cos θm / (ωi·ωm) = hz/|h|²
    fn of_normal(shared: f64, p: &Pair, h: &Half) -> f64 {
        shared * (2.0 * p.mu_i.min(p.mu_e) * p.hz2.sqrt() / h.h2).min(1.0)
    }
}

/// With t = tan θm, ωi·ωm = cos θm cos θi (1 + c t), and cos θe = cos²θm cos θi (1 + 2 c t − t²):
///
/// - the directions change roles at t = c;
/// - ωi is masked from 1 + c t = 2 on, t = 1/c;
/// - ωe from 2 cos²θm (1 + 2 c t − t²) = 1 + c t on, that is c (3 t − t³) = 3 t² − 1, tan 3θm = −1/c: at
///   θm = (π/2 + atan c)/3, two thirds of the way to the horizon, and again only beyond that.
///
/// All three meet at c = 1. Below, masking begins with ωe; above, with ωi, until they change roles.
fn breaks(c: f64) -> Vec<f64> {
    if c > 1.0 { vec![1.0 / c, c] } else { vec![((FRAC_PI_2 + c.atan()) / 3.0).tan()] }
}
