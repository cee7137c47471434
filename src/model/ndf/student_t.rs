//! Student's t-distribution of slopes: Ribardière, Bringier, Meneveaux & Simonot 2017, *STD: Student's t-Distribution of Slopes
//! for Microfacet Based BSDFs*. Twin of `shaders/ndf/student_t.wgsl`.
//!
//! ```text
//! D = (γ − 1)^γ α^(2γ − 2) / (π cos⁴θm ((γ − 1) α² + tan²θm)^γ)
//! ```
//!
//! | parameter | range | unit | default | |
//! |---|---|---|---|---|
//! | `alpha` | (0, 1] | – | none | or `roughness`, alpha = roughness² |
//! | `gamma` | [1.6, 40] | – | 2 | how soon the tail ends |
//!
//! γ = 2 is GGX; γ → ∞ is Beckmann, from which 40 is 1 % off in Λ. γ ≤ 3/2 has no mean slope, and so no Λ: from 1.6 on it
//! is Smith's own, (1 + 2Λ) μ at grazing being α √(γ − 1) κ, 2.8 α at 1.6, 1 α at 2 and 0.57 α at 40.
//!
//! Λ has a closed form. The slopes along a direction are a Student's t themselves, P(q) = K b^n/(b + q²)^(n + 1/2) with
//! n = γ − 1, b = n α² and K = Γ(n + 1/2)/(√π Γ(n)), and the facets cover ∫ |μ − q sin θ| P dq:
//!
//! ```text
//! (1 + 2Λ) μ = √B (√x I_x(1/2, n) + κ (1 − x)^n),   B = μ² + b sin²θ,   x = μ²/B,   κ = 2K/(2n − 1)
//! ```
//!
//! with I the regularised incomplete beta function.
//!
//! Kept: finite, not negative, reciprocal; energy with its own Λ at every γ, where `gtr`, which takes GGX's, gains up to 145
//! times below γ = 2. Broken with maskings that do not know γ, at grazing and γ = 1.6: 2.8 times with Schlick's and Hammon's,
//! 11 with disney-clearcoat, each at α = 1. α → 0 is the mirror.

use crate::base::half_angle::{Half, MU_MIN};
use crate::model::ndf::{AlbedoBounds, Ndf, Rounding};
use crate::model::parameters::{Parameters, Setting};
use crate::model::{Parameter, Term, part};
use libm::tgamma;
use std::f64::consts::{FRAC_1_PI, PI};

pub(crate) struct StudentT;

/// γ; shaders find n = γ − 1 there.
const GAMMA: usize = 0;
/// Where shaders find K …
const K: usize = 1;
/// … and κ.
const KAPPA: usize = 2;

/// What f32 loses of values, in units of 2⁻²⁴: the 40 of every lobe, of the exponent y = γ ln(1 + …) ten roundings (four of
/// its quotient, four of the logarithm, two of γ's product), and those of Λ.
fn roundings(y: f64) -> f64 {
    (40.0 + 10.0 * y) / (1 << 24) as f64 + LAMBDA_F32
}

/// The relative error of (1 + 2Λ) μ: measured over γ, α and μ, 44 units where γ is 11, 6 where it is 2 or less. All of an
/// integral has that of its direction.
const LAMBDA_F32: f64 = 45.0 / (1 << 24) as f64;

impl Ndf for StudentT {
    const TERM: Term = Term {
        name: "student-t",
        summary: "Student's t-distribution of slopes, its own Λ",
        source: "Ribardière et al. 2017",
        part: part!("ndf/student_t", "elementary", "ndf/smith"),
    };
    const PARAMETERS: &'static [Parameter] = &[Parameter {
        name: "gamma",
        summary: "how soon the tail ends: 2 is GGX, infinity Beckmann",
        unit: "",
        range: [1.6, 40.0],
        default: Some(2.0),
        place: GAMMA,
    }];
    /// y ≤ 192 where f is above 1e-30 sr⁻¹: D has 1/(α² cos⁴θm) before its power.
    const F32: Rounding = Rounding {
        value: (40.0 + 10.0 * 192.0) / (1 << 24) as f64 + LAMBDA_F32,
        integral: crate::base::precision::INTEGRAL_F32 + LAMBDA_F32,
        value_at: Some(|s| {
            let gamma = s.parameters[GAMMA];
            let steepest = ((gamma - 1.0) * s.alpha * s.alpha * MU_MIN * MU_MIN).recip();
            roundings((gamma * steepest.ln_1p()).min(192.0))
        }),
        ..Rounding::USUAL
    };
    /// The quotient of both (1 + 2Λ) μ where ωi grazes, of γ = 1.6 and α = 1: no masking exceeds it.
    const ALBEDO: AlbedoBounds = AlbedoBounds {
        bounds: &[
            ("schlick-ggx", 2.80),
            ("schlick-ggx-direct", 2.80),
            ("ashikhmin-neubelt", 1.40),
            ("smith-joint-approx", 2.80),
            ("disney-clearcoat", 11.2),
        ],
        ..AlbedoBounds::CONSERVED
    };

    fn derive(parameters: &mut Parameters) {
        let n = parameters[GAMMA] - 1.0;
        let [k, kappa] = constants(n);
        [parameters[GAMMA], parameters[K], parameters[KAPPA]] = [n, k, kappa];
    }

    fn ndf(h: &Half, hz2: f64, s: &Setting) -> f64 {
        let (a2, gamma) = (s.alpha * s.alpha, s.parameters[GAMMA]);
        let power = (-0.5 * gamma * (h.ht2 / ((gamma - 1.0) * a2 * hz2)).ln_1p()).exp();
        let q = power * (h.h2 / hz2) / s.alpha;
        q * q * FRAC_1_PI
    }

    fn smith_root(mu: f64, s: &Setting) -> f64 {
        let n = s.parameters[GAMMA] - 1.0;
        let [k, kappa] = constants(n);
        let across = n * s.alpha * s.alpha * ((1.0 - mu) * (1.0 + mu));
        let along = mu * mu;
        let both = along + across;
        let (x, y) = (along / both, across / both);
        let power = (-n * (along / across).ln_1p()).exp();
        let g = if x < f64::min(0.5, 4.0 / (n + 3.0)) {
            power * (kappa + k * x / fraction(n + 0.5, 1.5, x))
        } else {
            x.sqrt() + power * (kappa - k * x / fraction(n + 0.5, n + 1.0, y))
        };
        both.sqrt() * g
    }
}

/// K and κ.
fn constants(n: f64) -> [f64; 2] {
    let k = tgamma(n + 0.5) / (PI.sqrt() * tgamma(n));
    [k, 2.0 * k / (2.0 * n - 1.0)]
}

/// (c − 1)/F(a, 1; c; z) by 24 turns of its continued fraction (DLMF 15.7.5), right to 1e-13 where it is asked for.
fn fraction(a: f64, c: f64, z: f64) -> f64 {
    (1..=12).rev().map(f64::from).fold(c + 23.0, |v, m| {
        let w = (c + 2.0 * m - 2.0) - m * (c - a + (m - 1.0)) * z / v;
        (c + 2.0 * m - 3.0) - (a + (m - 1.0)) * (c + (m - 2.0)) * z / w
    })
}
