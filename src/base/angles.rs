//! A pair of directions in angles, and the azimuth relative to the mirror direction.

use crate::base::error::{Error, Result};
use crate::base::half_angle::{Azimuth, Pair};
use serde::Serialize;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A pair of directions, both pointing away from the surface, rad.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Angles {
    /// Zenith angle of incidence, [0, π/2].
    pub theta_i: f64,
    /// Azimuth of incidence; any number of turns up to [`PHI_MAX`].
    pub phi_i: f64,
    /// Zenith angle of exitance, [0, π/2].
    pub theta_e: f64,
    /// Azimuth of exitance, as that of incidence.
    pub phi_e: f64,
}

/// The largest azimuth, rad: beyond it an f64 is no direction, as its digits end at 1e-7.
pub const PHI_MAX: f64 = 1e9;

/// π = `PI` + this, to 33 digits.
const PI_REST: f64 = 1.224_646_799_147_353_2e-16;

impl Angles {
    /// δφ = φe − φi − π in (−π, π], right to its last digits: 0 is the mirror direction.
    ///
    /// The sum φe − φi keeps the digits that its rounding drops, and the nearest odd multiple of π, in two parts,
    /// is subtracted without rounding: near the mirror direction no digit is lost.
    pub fn delta_phi(&self) -> f64 {
        delta_phi(self.phi_i, self.phi_e)
    }

    /// Checks that all four angles are finite and in range.
    ///
    /// # Errors
    /// [`Error::Input`] with the angle that is out of range.
    pub fn check(&self) -> Result<()> {
        for (name, theta) in [("theta_i", self.theta_i), ("theta_e", self.theta_e)] {
            if !(0.0..=FRAC_PI_2).contains(&theta) {
                return Err(Error::input(format!(
                    "{name} = {theta} is outside [0, π/2] = [0, {FRAC_PI_2}] rad"
                )));
            }
        }
        for (name, phi) in [("phi_i", self.phi_i), ("phi_e", self.phi_e)] {
            if !(-PHI_MAX..=PHI_MAX).contains(&phi) {
                return Err(Error::input(format!(
                    "{name} = {phi} is outside ±{PHI_MAX:e} rad; take off whole turns"
                )));
            }
        }
        Ok(())
    }

    /// The half-angle terms of the pair, from which every lobe is evaluated.
    pub(crate) fn factors(&self) -> (Pair, Azimuth) {
        (Pair::new(self.theta_i, self.theta_e), Azimuth::at(self.phi_i, self.delta_phi()))
    }
}

/// The azimuth φe − φi − π in (−π, π], computed as [`Angles::delta_phi`] says.
pub(crate) fn delta_phi(phi_i: f64, phi_e: f64) -> f64 {
    let (a, b) = (phi_e, -phi_i);
    let sum = a + b;
    let b_part = sum - a;
    let dropped = (a - (sum - b_part)) + (b - b_part); // Knuth's TwoSum
    let turns = 2.0 * ((sum - PI) / TAU).round() + 1.0;
    let delta = (-turns).mul_add(PI, sum) + (dropped - turns * PI_REST);
    // The number of turns is rounded too.
    if delta > PI {
        delta - TAU
    } else if delta < -PI {
        delta + TAU
    } else {
        delta
    }
}
