//! Half-angle terms of a pair of directions, in f64: the twin of `shaders/pair.wgsl`.
//!
//! With the azimuth kept relative to the mirror direction, δ = φe − φi − π, everything that a BRDF
//! of the half vector needs is a product or a sum of non-negative terms, so that the specular peak
//! survives f32 (half vectors of unit vectors in f32 are off by 0.3 at α = 1e-3).

/// The least cosine of an evaluation, 2⁻²⁴: every evaluation takes μ = max(cos θ, 2⁻²⁴), since f diverges where both
/// directions graze, and the half vector is 0 there.
pub const MU_MIN: f64 = 1.0 / (1 << 24) as f64;

/// The terms of the half vector that depend on θi and θe alone.
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
    /// The weight of this θe in an integral where each θi has its own nodes in θe, else 1.
    pub weight: f64,
    /// (sin θi + sin θe)/2
    pub st: f64,
    /// (sin θi − sin θe)/2
    pub dt: f64,
}

/// The terms of the half vector that depend on δφ alone; in `frame`, for anisotropic lobes, on φi too.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Azimuth {
    /// sin²(δ/2)
    pub sin2: f64,
    /// cos²(δ/2)
    pub cos2: f64,
    /// max(0, −cos δ) = max(0, cos(φi − φe)): 0 unless ωe is on the side of ωi. It is stored by itself, because a lobe
    /// may weight it by 1/μ, and sin² − cos² has lost its digits near δ = π/2.
    pub back: f64,
    /// The weight of this δφ in an integral.
    pub weight: f64,
    /// 1 / weight of this δφ cell where it holds δφ = 0, else 0.
    pub bin: f64,
    /// (cos φi ± cos φe)/2 and (sin φi ± sin φe)/2, the sums first.
    pub frame: HalfSums,
}

/// Half sums and half differences of the azimuths' cosines and sines. The tangential half vector is
/// (st cp + dt cm, st sp + dt sm); cp, sp and dt, which vanish in the mirror direction, are right to their last digits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfSums {
    /// (cos φi + cos φe)/2
    pub cp: f64,
    /// (cos φi − cos φe)/2
    pub cm: f64,
    /// (sin φi + sin φe)/2
    pub sp: f64,
    /// (sin φi − sin φe)/2
    pub sm: f64,
}

/// The half vector h = (ωi + ωe)/2: |ht|² of its tangential part, |h|², c = ωi·ωm = |h|, and 1 − c.
#[derive(Clone, Copy)]
pub(crate) struct Half {
    pub ht2: f64,
    pub h2: f64,
    pub c: f64,
    pub one_minus_c: f64,
}

impl Half {
    /// The half vector with the tangent plane stretched by √(αy/αx) and its inverse: D of (αx, αy) is then the isotropic D
    /// of √(αx αy).
    pub(crate) fn stretched(self, p: &Pair, a: &Azimuth, [alpha_x, alpha_y]: [f64; 2]) -> Self {
        let HalfSums { cp, cm, sp, sm } = a.frame;
        let (x, y) = (p.st * cp + p.dt * cm, p.st * sp + p.dt * sm);
        Self { ht2: x * x * (alpha_y / alpha_x) + y * y * (alpha_x / alpha_y), ..self }
    }
}

impl Pair {
    /// The terms of (θi, θe), rad.
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
            st: half_sum.sin() * half_difference.cos(),
            dt,
        }
    }
}

impl Pair {
    /// The terms from cos θ and sin θ of both directions, for callers that have these to their last digits, which angles
    /// near the horizon do not give. Under an integral both are right down to 0.
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
            st: 0.5 * sum,
            dt,
        }
    }

    /// The terms in the order of `Pair` in `shaders/pair.wgsl`.
    pub(crate) fn to_array(self) -> [f64; 10] {
        let Self { hz2, dt2, ss, sd, mu_i, mu_e, bin, weight, st, dt } = self;
        [hz2, dt2, ss, sd, mu_i, mu_e, bin, weight, st, dt]
    }

    /// The terms that isotropic lobes need, in the order of `shaders/kernel/product.wgsl`.
    pub(crate) fn to_plain(self) -> [f64; 8] {
        let [plain @ .., _, _] = self.to_array();
        plain
    }
}

impl Azimuth {
    /// The terms in the order of `Azimuth` in `shaders/pair.wgsl`.
    pub(crate) fn to_array(self) -> [f64; 9] {
        let Self { sin2, cos2, back, weight, bin, frame: HalfSums { cp, cm, sp, sm } } = self;
        [sin2, cos2, back, weight, bin, cp, cm, sp, sm]
    }

    /// The terms of δφ, rad, at φi = 0.
    pub fn new(delta_phi: f64) -> Self {
        Self::at(0.0, delta_phi)
    }

    /// The terms of φi and δφ, rad.
    pub fn at(phi_i: f64, delta_phi: f64) -> Self {
        let (sin, cos) = (0.5 * delta_phi).sin_cos();
        let back = (-delta_phi.cos()).max(0.0);
        // φe = φi + π + δφ; sums and differences as products.
        let (sin_mid, cos_mid) = (phi_i + 0.5 * delta_phi).sin_cos();
        Self::of_halves([sin, cos], [sin_mid, cos_mid], back)
    }

    /// The same from the sine and cosine of φi, and those of δφ, both with the same length and right to their last digits.
    pub(crate) fn of_sines_and_cosines([sin_i, cos_i]: [f64; 2], [y, x]: [f64; 2]) -> Self {
        let length = (x * x + y * y).sqrt();
        let [sin_delta, cos_delta] = if length > 0.0 { [y / length, x / length] } else { [0.0, 1.0] };
        // Of sin(δ/2) and cos(δ/2) the larger by the root, which does not cancel.
        let larger = (0.5 * (1.0 + cos_delta.abs())).sqrt();
        let smaller = 0.5 * sin_delta / larger;
        let [sin, cos] = match cos_delta < 0.0 {
            true => [larger.copysign(sin_delta), smaller.abs()],
            false => [smaller, larger],
        };
        let mid = [sin_i * cos + cos_i * sin, cos_i * cos - sin_i * sin];
        Self::of_halves([sin, cos], mid, (-cos_delta).max(0.0))
    }

    /// The terms from sine and cosine of δφ/2, and of φi + δφ/2.
    fn of_halves([sin, cos]: [f64; 2], [sin_mid, cos_mid]: [f64; 2], back: f64) -> Self {
        let frame = HalfSums { cp: sin_mid * sin, cm: cos_mid * cos, sp: -cos_mid * sin, sm: sin_mid * cos };
        Self { sin2: sin * sin, cos2: cos * cos, back, weight: 0.0, bin: 0.0, frame }
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

/// Computes sin θ = √((1 − μ)(1 + μ)) from μ = cos θ.
pub(crate) fn sine(mu: f64) -> f64 {
    ((1.0 - mu) * (1.0 + mu)).sqrt()
}

/// Clamps θ to the angle whose cosine is [`MU_MIN`].
pub(crate) fn off_horizon(theta: f64) -> f64 {
    theta.min(MU_MIN.acos())
}
