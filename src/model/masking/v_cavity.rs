//! Masking and shadowing in V-shaped grooves: Torrance & Sparrow 1967; Cook & Torrance 1982, section 4:
//! G2 = min(1, 2 cos θm μi / (ωi·ωm), 2 cos θm μe / (ωi·ωm)). Twin of `shaders/masking/v_cavity.wgsl`.
//!
//! It knows no roughness, and has kinks: where masking begins, and where the directions change roles. α → 0 leaves the
//! mirror whole. Kept: finite but where both directions graze, not negative, reciprocal; energy: it is the exact
//! masking of grooves that each have one of the slopes (Heitz 2014, section 5.2).

use crate::base::half_angle::{Half, Pair};
use crate::model::half_vector::{DirectionKinks, Kinks};
use crate::model::masking::{Masking, MaskingCounts, Toward};
use crate::model::ndf::Ndf;
use crate::model::{Term, part};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, PI};

pub(crate) struct VCavity;

impl Masking for VCavity {
    const TERM: Term = Term {
        name: "v-cavity",
        summary: "V-shaped grooves",
        source: "Torrance & Sparrow 1967; Cook & Torrance 1982, section 4",
        part: part!("masking/v_cavity"),
    };
    const OF_NORMAL: Option<Kinks> = Some(Kinks {
        breaks,
        most: 2,
        meet: Some(1.0),
        is_sharp: true,
        of_directions: Some(DirectionKinks { sin2, elevations }),
        ..Kinks::NONE
    });

    /// Where correlated Smith is nearly constant, kinks are not: measured.
    const COUNTS: Option<MaskingCounts> =
        Some(|correlated, tolerance| correlated.map(|counts| counts.at_least([4, 3], tolerance)));

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

/// Masking begins where 2 μ hz = |h|² = hz² + dt² + sin θi sin θe sin²(δ/2), of the smaller μ.
fn sin2(p: &Pair) -> f64 {
    let hz = p.hz2.sqrt();
    (hz * (2.0 * p.mu_i.min(p.mu_e) - hz) - p.dt2) / p.ss
}

/// Where that has a solution at δφ = 0 and at π. There everything is in one plane, θm and the angle of incidence are
/// b = |θi − θe|/2 and a = (θi + θe)/2 or the other way around, and the larger θ is a + b: masking begins at
/// 2 cos(a + b) cos b = cos a, that is cos(a + 2b) = 0. With the elevations ψ = π/2 − θ that is, at δφ = 0, 3ψe = ψi or
/// 3ψi = ψe, and at π 3ψe = π − ψi or ψe = π − 3ψi.
fn elevations(psi: f64) -> [f64; 4] {
    [psi / 3.0, 3.0 * psi, FRAC_PI_3 - psi / 3.0, PI - 3.0 * psi]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At these elevations the kink is in the plane of incidence, unless the other direction has the smaller cosine.
    #[test]
    fn kinks_begin_and_end_in_the_plane_of_incidence() {
        let mut found = [0; 2];
        for psi in (1..100).map(|k| f64::from(k) * 0.01 * FRAC_PI_2) {
            for (k, other) in
                elevations(psi).into_iter().enumerate().filter(|(_, e)| 0.0 < *e && *e < FRAC_PI_2)
            {
                let sin2 = sin2(&Pair::new(FRAC_PI_2 - psi, FRAC_PI_2 - other));
                let side = k / 2;
                if (sin2 - side as f64).abs() < 1e-9 / (psi * other).cos() {
                    found[side] += 1;
                }
            }
        }
        // Of two roots each, one is the kink's.
        assert!(found[0] > 99 && found[1] > 50, "{found:?}");
    }
}
