//! Factors of a pair of directions, in f64: the twin of `shaders/pair.wgsl`.
//!
//! With the azimuth kept relative to the mirror direction, δ = φe − φi − π, everything that a BRDF
//! of the half vector needs is a product or a sum of non-negative terms, so that the specular peak
//! survives f32 (half vectors of unit vectors in f32 are off by 0.3 at α = 1e-3).

/// The cosine at grazing: f diverges where both directions graze, and the half vector is 0 there.
/// Every evaluation takes μ = max(cos θ, 2⁻²⁴).
pub const MU_MIN: f64 = 1.0 / (1 << 24) as f64;

/// What depends on θi and θe alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// ((cos θi + cos θe)/2)²
    pub hz2: f64,
    /// ((sin θi − sin θe)/2)²
    pub dt2: f64,
    /// sin θi sin θe
    pub ss: f64,
    /// sin²((θi − θe)/2)
    pub sd: f64,
    /// cos θi
    pub mu_i: f64,
    /// cos θe
    pub mu_e: f64,
    /// 1 / weight of this θe cell where it holds the mirror direction, else 0.
    pub bin: f64,
    /// The weight of this θe in an integral whose directions have nodes of their own, else 1.
    pub weight: f64,
}

/// What depends on δφ alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Azimuth {
    /// sin²(δ/2)
    pub sin2: f64,
    /// cos²(δ/2)
    pub cos2: f64,
    /// max(0, −cos δ) = max(0, cos(φi − φe)): 0 unless ωe is on the side of ωi. A factor of its own, as what
    /// a lobe weighs it with may be 1/μ, and sin² − cos² has lost its digits near δ = π/2.
    pub back: f64,
    /// The weight of this δφ in an integral.
    pub weight: f64,
    /// 1 / weight of this δφ cell where it holds δφ = 0, else 0.
    pub bin: f64,
}

/// What depends on all three: of h = (ωi + ωe)/2, |h|² and its tangential part; ωi·ωm = |h|, and 1 − ωi·ωm.
pub(crate) struct Half {
    pub ht2: f64,
    pub h2: f64,
    pub c: f64,
    pub one_minus_c: f64,
}

impl Pair {
    /// The factors of (θi, θe), rad.
    pub fn new(theta_i: f64, theta_e: f64) -> Self {
        let (theta_i, theta_e) = (off_horizon(theta_i), off_horizon(theta_e));
        let (half_sum, half_difference) = (0.5 * (theta_i + theta_e), 0.5 * (theta_i - theta_e));
        let hz = 0.5 * (theta_i.cos() + theta_e.cos());
        let dt = half_sum.cos() * half_difference.sin();
        Self {
            hz2: hz * hz,
            dt2: dt * dt,
            ss: theta_i.sin() * theta_e.sin(),
            sd: half_difference.sin().powi(2),
            mu_i: theta_i.cos(),
            mu_e: theta_e.cos(),
            bin: 0.0,
            weight: 1.0,
        }
    }
}

impl Pair {
    /// The same of cos θ and sin θ of both, for whoever has these to their last digits: angles near the horizon do not.
    /// Under an integral both are right down to 0.
    pub(crate) fn of_cosines_and_sines([mu_i, mu_e]: [f64; 2], [s_i, s_e]: [f64; 2]) -> Self {
        let (sum, hz) = (s_i + s_e, 0.5 * (mu_i + mu_e));
        let dz = 0.5 * (mu_i - mu_e);
        // (si − se)/2, near the horizon as (μe² − μi²)/(si + se)/2
        let dt = if sum > 1.0 { -2.0 * dz * hz / sum } else { 0.5 * (s_i - s_e) };
        Self {
            hz2: hz * hz,
            dt2: dt * dt,
            ss: s_i * s_e,
            sd: dt * dt + dz * dz,
            mu_i,
            mu_e,
            bin: 0.0,
            weight: 1.0,
        }
    }

    /// As the shader lays it out.
    pub(crate) fn to_array(self) -> [f64; 8] {
        [self.hz2, self.dt2, self.ss, self.sd, self.mu_i, self.mu_e, self.bin, self.weight]
    }
}

impl Azimuth {
    /// As the shader lays it out.
    pub(crate) fn to_array(self) -> [f64; 5] {
        [self.sin2, self.cos2, self.back, self.weight, self.bin]
    }

    /// The factors of δφ, rad.
    pub fn new(delta_phi: f64) -> Self {
        let (sin, cos) = (0.5 * delta_phi).sin_cos();
        let back = (-delta_phi.cos()).max(0.0);
        Self { sin2: sin * sin, cos2: cos * cos, back, weight: 0.0, bin: 0.0 }
    }
}

impl Half {
    pub(crate) fn new(p: &Pair, a: &Azimuth) -> Self {
        let ht2 = p.dt2 + p.ss * a.sin2;
        let h2 = ht2 + p.hz2;
        let c = h2.sqrt();
        Self { ht2, h2, c, one_minus_c: (p.sd + p.ss * a.cos2) / (1.0 + c) }
    }
}

/// θ, or the angle whose cosine is [`MU_MIN`] if it is nearer to the horizon.
pub(crate) fn off_horizon(theta: f64) -> f64 {
    theta.min(MU_MIN.acos())
}
