//! The inputs of the atlas: every extreme with every other, then low-discrepancy pairs that crowd where
//! f32 may lose digits; and pairs within a lobe, for the study.

use crate::base::angles::Angles;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// θ: the normal, a hair from it, between, and up to the horizon. Of a pair equal ones are the mirror direction
/// and the way back.
const THETAS: [f64; 10] =
    [0.0, 1e-7, 1e-4, 1e-3, 0.3, 0.8, 1.5, FRAC_PI_2 - 1e-3, FRAC_PI_2 - 1e-6, FRAC_PI_2];
/// δφ: the specular peak, a hair from it, perpendicular, back to the source.
const DELTAS: [f64; 9] = [0.0, 1e-7, 1e-5, 1e-4, 1e-2, 1.0, FRAC_PI_2, PI - 1e-6, PI];

/// The extremes, and further pairs up to `count`.
pub(super) fn everywhere(count: usize) -> Vec<Angles> {
    let mut angles = Vec::new();
    for theta_i in THETAS {
        for theta_e in THETAS {
            angles.extend(DELTAS.map(|delta| pair(theta_i, theta_e, delta)));
        }
    }
    angles.extend((angles.len()..count).map(|n| scattered(n, point(n))));
    angles
}

/// In turns anywhere; one near the horizon; both near it; near the mirror direction; near the normal. Nearness
/// is spread over all magnitudes down to 1e-8, so that every α has its share of pairs in its lobe.
fn scattered(n: usize, [a, b, c]: [f64; 3]) -> Angles {
    let near = |u: f64| FRAC_PI_2 * 10f64.powf(-8.0 * u);
    let signed = |u: f64| if u < 0.5 { -near(2.0 * u) } else { near(2.0 * u - 1.0) };
    match n % 5 {
        0 => pair(FRAC_PI_2 * a, FRAC_PI_2 * b, PI * c),
        1 => pair(FRAC_PI_2 - near(a), FRAC_PI_2 * b, PI * c),
        2 => pair(FRAC_PI_2 - near(a), FRAC_PI_2 - near(b), 2.0 * near(c)),
        3 => pair(FRAC_PI_2 * a, (FRAC_PI_2 * a + signed(b)).clamp(0.0, FRAC_PI_2), 2.0 * near(c)),
        _ => pair(near(a), FRAC_PI_2 * b, PI * c),
    }
}

fn pair(theta_i: f64, theta_e: f64, delta_phi: f64) -> Angles {
    Angles { theta_i, phi_i: 0.0, theta_e, phi_e: PI + delta_phi }
}

/// The largest zenith angle of the study: beyond it engines clamp, each in its own way.
const STEEPEST: f64 = 89.9 * PI / 180.0;
/// The share of the normals, by D cos θm, that the study's pairs are of.
const SHARE: f64 = 0.99;

/// Up to `count` pairs that a GGX lobe of this α reflects into each other: tan θm = α √(u/(1−u)) as its normals
/// are distributed (Walter et al. 2007, eq. 35), u up to 0.99. These are what a highlight is made of.
pub(super) fn in_the_lobe(alpha: f64, count: usize) -> Vec<Angles> {
    let reflect = |n| {
        let [a, b, c] = point(n);
        let theta_i = STEEPEST * a;
        let tan_m = alpha * (SHARE * b / (1.0 - SHARE * b)).sqrt();
        let (sin_psi, cos_psi) = (TAU * c).sin_cos();
        let cos_m = 1.0 / (1.0 + tan_m * tan_m).sqrt();
        let wi = glam::DVec3::new(theta_i.sin(), 0.0, theta_i.cos());
        let wm = glam::DVec3::new(tan_m * cos_psi, tan_m * sin_psi, 1.0) * cos_m;
        let we = 2.0 * wi.dot(wm) * wm - wi;
        let theta_e = we.x.hypot(we.y).atan2(we.z);
        (theta_e <= STEEPEST).then(|| Angles { theta_i, phi_i: 0.0, theta_e, phi_e: we.y.atan2(we.x) })
    };
    (0..count).filter_map(reflect).collect()
}

/// Point n of the additive recurrence R_3 of Roberts 2018: steps g⁻¹, g⁻², g⁻³ with g⁴ = g + 1.
fn point(n: usize) -> [f64; 3] {
    const G: f64 = 1.220_744_084_605_759_5;
    [1.0 / G, 1.0 / (G * G), 1.0 / (G * G * G)].map(|step| (0.5 + n as f64 * step).fract())
}
