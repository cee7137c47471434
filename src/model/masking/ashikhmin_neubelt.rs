//! The visibility that Neubelt & Pettineo 2013, *Crafting a Next-Gen Material Pipeline for The Order: 1886*, take for
//! cloth, after Ashikhmin & Premože 2007, *Distribution-based BRDFs*: f = D F / (4 (μi + μe − μi μe)), that is
//! G2 = μi μe / (μi + μe − μi μe). Twin of `shaders/masking/ashikhmin_neubelt.wgsl`.
//!
//! It knows no roughness, and is made for lobes as wide as cloth's: α → 0 leaves μ/(2 − μ) of the mirror, 0 at
//! grazing. With GGX it masks more than height-correlated Smith at any α ≤ 1: (1 + 2Λ) μ = √(α² + (1 − α²) μ²) ≤ 1,
//! so that Smith's 4 μi μe/G2 is at most 2 (μi + μe), and μi μe ≤ (μi + μe)/2 makes that at most 4 (μi + μe − μi μe).
//! Kept: finite but where both directions graze, not negative, reciprocal; energy, unless normals are stretched. As μe → 0,
//! f cos θi = D F/4, so that ρ = ∫ D (ωe·ωm)⁺ dωm, half of what the facets cover as seen from the side: αx/2 of GGX and
//! αx/(2 √π) of Beckmann, which along grooves of αx = 10 are 5 and 2.82.

use crate::model::masking::{Masking, MaskingCounts, Toward};
use crate::model::ndf::Ndf;
use crate::model::parameters::Setting;
use crate::model::{Term, part};

pub(crate) struct AshikhminNeubelt;

impl Masking for AshikhminNeubelt {
    const TERM: Term = Term {
        name: "ashikhmin-neubelt",
        summary: "cloth's visibility, 1/(4 (μi + μe − μi μe))",
        source: "Neubelt & Pettineo 2013, after Ashikhmin & Premože 2007",
        part: part!("masking/ashikhmin_neubelt"),
    };
    /// Measured: interpolation leaves 1.9e-7 of 1e-6, where 1.3e-7 is its share.
    const SPREADS: bool = false;

    /// Where correlated Smith is nearly constant, this is not: measured; none leaves 3.7 times 1e-7.
    const COUNTS: Option<MaskingCounts> = Some(|correlated, _| correlated.map(|counts| counts.more(1.25)));

    fn visibility<N: Ndf>(i: &Toward, e: &Toward) -> f64 {
        let (small, large) = (i.mu.min(e.mu), i.mu.max(e.mu));
        0.25 / (large + small * (1.0 - large))
    }

    /// G2 = μe x / (y + x (1 − μe))
    fn masking<N: Ndf>(x: f64, y: f64, mu_e: f64, _s: &Setting) -> f64 {
        2.0 * (y + x * (1.0 - mu_e))
    }

    fn mirror(mu: f64) -> f64 {
        mu / (2.0 - mu)
    }
}
