//! A pair of directions and its half vector, from angles, without cancellation.

use glam::DVec3;

/// The smallest cosine of either direction: f diverges when both graze, and h = 0 there has no direction.
///
/// 2⁻²⁴ is the convention of the whole project: half an ulp of 1 in f32.
pub const MIN_MU: f64 = 1.0 / 16_777_216.0;

/// Two directions, both unit and pointing away from the surface, by angles in radians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Angles {
    /// Zenith angle of incidence, [0, π/2].
    pub theta_i: f64,
    /// Zenith angle of exitance, [0, π/2].
    pub theta_e: f64,
    /// φe − φi − π ∈ (−π, π]; 0 is the mirror direction.
    pub delta_phi: f64,
    /// Azimuth of incidence, which matters to anisotropic models alone.
    pub phi_i: f64,
}

/// What the models need of a pair of directions.
///
/// In the frame where ωi has azimuth π and its mirror direction azimuth 0, with s = sin θ, δ = delta_phi:
/// ωi = (−si, 0, μi), ωe = (se cos δ, se sin δ, μe).
#[derive(Debug, Clone, Copy)]
pub(super) struct Pair {
    /// μi = cos θi ≥ [`MIN_MU`].
    pub mu_i: f64,
    /// μe = cos θe ≥ [`MIN_MU`].
    pub mu_e: f64,
    /// tan² θi.
    pub tan2_i: f64,
    /// tan² θe.
    pub tan2_e: f64,
    /// cos² θm.
    pub cos2_m: f64,
    /// tan² θm.
    pub tan2_m: f64,
    /// ωi·ωm = ωe·ωm.
    pub cos_d: f64,
    /// 1 − ωi·ωm.
    pub one_minus_cos_d: f64,
    /// sin θi sin θe cos δ: the part of ωe·R that lies in the surface, R the mirror direction of ωi.
    pub tangential_cos: f64,
    /// ωi + ωe
    pub h: DVec3,
    /// ωe − ωi
    pub d: DVec3,
}

impl Pair {
    pub fn new(angles: &Angles) -> Self {
        let Angles { theta_i, theta_e, delta_phi, .. } = *angles;
        let (mu_i, s_i) = cos_sin(theta_i);
        let (mu_e, s_e) = cos_sin(theta_e);

        // μi − μe = 2 sin((θi+θe)/2) sin((θe−θi)/2); the plain difference is right only where 2⁻²⁴ took over.
        let clamped = mu_i == MIN_MU || mu_e == MIN_MU;
        let mu_diff = if clamped {
            mu_i - mu_e
        } else {
            2.0 * (0.5 * (theta_i + theta_e)).sin() * (0.5 * (theta_e - theta_i)).sin()
        };
        // se − si = (se² − si²) / (se + si), and s² = 1 − μ². (The form 2 cos((θi+θe)/2) sin((θe−θi)/2) loses
        // its digits where both directions graze, as the rounded sum of the angles nears π.)
        let s_sum = s_i + s_e;
        let s_diff = if s_sum > 0.0 { mu_diff * (mu_i + mu_e) / s_sum } else { 0.0 };

        // The unnormalised half vector h = ωi + ωe and its counterpart d = ωe − ωi, with
        // cos δ = 1 − 2 sin²(δ/2) in the one and 2 cos²(δ/2) − 1 in the other: exact at h → n and at d → 0.
        let (sin_half, cos_half) = (0.5 * delta_phi).sin_cos();
        let y = 2.0 * s_e * sin_half * cos_half;
        let h = DVec3::new(s_diff - 2.0 * s_e * sin_half * sin_half, y, mu_i + mu_e);
        let d = DVec3::new(2.0 * s_e * cos_half * cos_half - s_diff, y, -mu_diff);

        let ht2 = h.x * h.x + h.y * h.y;
        let hz2 = h.z * h.z;
        // |h|² = 2 + 2 ωi·ωe = 4 (ωi·ωm)², |d|² = 4 − |h|²; 1 − c = (1 − c²) / (1 + c).
        let cos_d = 0.5 * h.length();
        let one_minus_cos_d = 0.25 * d.length_squared() / (1.0 + cos_d);

        Self {
            mu_i,
            mu_e,
            tan2_i: (s_i / mu_i).powi(2),
            tan2_e: (s_e / mu_e).powi(2),
            cos2_m: hz2 / (ht2 + hz2),
            tan2_m: ht2 / hz2,
            cos_d,
            one_minus_cos_d,
            tangential_cos: s_i * s_e * delta_phi.cos(),
            h,
            d,
        }
    }
}

/// (μ, sin θ), μ kept at [`MIN_MU`] or above.
fn cos_sin(theta: f64) -> (f64, f64) {
    let (sin, cos) = theta.sin_cos();
    if cos > MIN_MU { (cos, sin) } else { (MIN_MU, sin_of(MIN_MU)) }
}

/// sin θ = √((1 − μ)(1 + μ)).
pub(super) fn sin_of(mu: f64) -> f64 {
    ((1.0 - mu) * (1.0 + mu)).sqrt()
}
