//! What light does to a surface, in f64, by other ways than tables of it: irradiance along meridians, and everything else by
//! cells of directions that are quartered until quarters agree.

mod albedo;
mod exitant;
mod harmonics;
mod irradiance;
mod source;

pub use albedo::Albedo;
pub use exitant::{Incident, exitant, radiosity};
pub use harmonics::{Harmonics, harmonics};
pub use irradiance::{Meridians, irradiance};

use std::f64::consts::{FRAC_PI_2, TAU};

/// Where A cos θ + B sin θ is largest: in (−π/2, 3π/2], so that what is above 0 in [0, π] is within a quarter turn of it.
fn peak_of(a: f64, b: f64) -> f64 {
    let peak = b.atan2(a);
    if peak < -FRAC_PI_2 { peak + TAU } else { peak }
}
