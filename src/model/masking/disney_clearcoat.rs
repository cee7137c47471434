//! Disney's masking of the clearcoat: Burley 2012, *Physically-Based Shading at Disney*, section 5.6: separable Smith with
//! GGX's Λ at α = 1/4, whatever α the normals have: G1 = 2μ / (μ + √(1/16 + 15/16 μ²)). Twin of
//! `shaders/masking/disney_clearcoat.wgsl`.
//!
//! It masks even a mirror: α → 0 leaves G1(μ)² of it, 0 at grazing. Kept: finite, also where both directions graze, not
//! negative, reciprocal; and energy, where normals lean less than α = 1/4 masks: Disney's own, γ = 1 from α = 0.001 to 0.1,
//! reflect up to 0.5 to 1.4 where ωi grazes. Broken beyond: ρ_dh of GGX reaches 1.8 at α = 1/2 and 3.4 at 1, of unequal α
//! up to 10 it reaches 22.6, and of Charlie 4.3 at α = 1 and 19.2 at 1/200.

use crate::model::masking::{Masking, MaskingCounts, Toward};
use crate::model::ndf::Ndf;
use crate::model::parameters::Setting;
use crate::model::{Term, part};

pub(crate) struct DisneyClearcoat;

impl Masking for DisneyClearcoat {
    const TERM: Term = Term {
        name: "disney-clearcoat",
        summary: "separable Smith of GGX at α = 1/4, for Disney's clearcoat",
        source: "Burley 2012, section 5.6",
        part: part!("masking/disney_clearcoat"),
    };
    /// Its branch points are at μ = ±i/√15 whatever α is.
    const SPREADS: bool = false;

    /// G1 bends at μ ~ 1/4 where the normals' own Λ, of a small α, is nearly constant: measured.
    const COUNTS: Option<MaskingCounts> =
        Some(|correlated, tolerance| correlated.map(|counts| counts.more(1.25).at_least([4, 5], tolerance)));

    fn visibility<N: Ndf>(i: &Toward, e: &Toward) -> f64 {
        1.0 / (below(i.mu) * below(e.mu))
    }

    fn masking<N: Ndf>(x: f64, y: f64, mu_e: f64, _s: &Setting) -> f64 {
        let mu = mu_e * x;
        0.5 * below(mu_e) / mu_e * (mu + (0.9375 * mu * mu + 0.0625 * y * y).sqrt())
    }

    /// ρ_dh is at most G1 times what ωe sees of the normals over μe, which is 1/G1 of Smith's own; and his, of α, is less by
    /// 4α at most, where ωe grazes.
    fn bound(smith: f64, alpha: f64) -> f64 {
        smith * (4.0 * alpha).max(1.0)
    }

    fn mirror(mu: f64) -> f64 {
        (2.0 * mu / below(mu)).powi(2)
    }
}

/// 2 μ/G1
fn below(mu: f64) -> f64 {
    mu + (0.0625 + 0.9375 * mu * mu).sqrt()
}
