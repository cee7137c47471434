//! Lobes times a factor of the two cosines: f = s(μi, μe) · lobe(ωi, ωe). Energy compensation, a coat and what lies
//! below a coat or a sheen have that in common. Azimuths have no part in s, so the host knows it in f64 for each row
//! of values and each direction of an integral, and a device multiplies by one number.
//!
//! E(μ) = ∫ f cos θ dω is the directional albedo of the lobe that a factor is about, from our own integrals: to
//! 1e-10, at Chebyshev points of a coordinate in which it is analytic, once for each model and setting.

mod scheme;
#[cfg(feature = "verify")]
mod violations;

pub use scheme::Compensation;

use crate::model::parameters::{Parameters, Setting};
use crate::model::{Integral, Model};

/// A factor s(μi, μe); several multiply.
#[derive(Debug, Clone, PartialEq)]
pub enum Factor {
    /// What a rough surface of mirrors misses by single scattering, as a Lambert lobe times
    ///
    /// ```text
    /// (1 − E(μi)) (1 − E(μe)) / (1 − E_avg) · F_ms,  F_ms = F_avg² E_avg / (1 − F_avg (1 − E_avg))
    /// ```
    ///
    /// (Kulla & Conty 2017, "Revisiting Physically Based Shading at Imageworks", after Kelemen & Szirmay-Kalos 2001;
    /// F_ms with F_avg squared, since what is missing met at least two facets). E is of the lobe with F = 1. With
    /// F_avg = 1 both add up to 1 at every μ; the factor is symmetric, so that f stays reciprocal.
    Missing {
        /// The lobe with F = 1.
        of: Albedo,
        /// 2 ∫ F(μ) μ dμ.
        f_avg: f64,
    },
    /// The same light put back into the lobe's own shape, 1 + F0 (1/E(μe) − 1) (Turquin 2019, "Practical multiple
    /// scattering compensation for microfacet models"; Filament has the same form). It is made for a given view:
    /// with F = 1 all light that could reach ωe does, ∫ f cos θi dωi = 1, but f is not reciprocal, and a direction
    /// of incidence may send back more than it gets.
    Restored {
        /// The lobe with F = 1.
        of: Albedo,
        /// F at normal incidence.
        f0: f64,
    },
    /// A clear coat's own lobe, whose F is of the view direction: w (0.04 + 0.96 (1 − μe)⁵)
    /// (KHR_materials_clearcoat: `clearcoat · fresnel(0.04, NdotV)`).
    Coat {
        /// How much of the coat there is, [0, 1].
        weight: f64,
    },
    /// What lies below that coat: 1 − w (0.04 + 0.96 (1 − μe)⁵).
    BelowCoat {
        /// How much of the coat there is, [0, 1].
        weight: f64,
    },
    /// What lies below a sheen: min(1 − m E(μi), 1 − m E(μe)) with E of the sheen's lobe (KHR_materials_sheen,
    /// albedo scaling, after Conty Estevez & Kulla 2017), where E counts as 1 if it is more, which Charlie's is near
    /// grazing: nothing is negative then, and s is linear in m. Tables in unorm formats, which engines read E from, do
    /// the same.
    BelowSheen {
        /// The sheen's lobe.
        of: Albedo,
        /// The largest channel of its colour.
        most: f64,
    },
}

/// The directional albedo E(μ) of a model, all its components together.
#[derive(Debug, Clone, PartialEq)]
pub struct Albedo {
    /// The model.
    pub model: &'static Model,
    /// Its perceptual roughness; `None`: that of the table's row, or of the lobe that has the factor.
    pub roughness: Option<f64>,
    /// The rest of its parameters.
    pub parameters: Parameters,
}

impl Albedo {
    /// The setting, in a row of this roughness.
    pub fn setting(&self, row: Option<f64>) -> Setting {
        let alpha = self.model.measure(self.roughness.or(row).unwrap_or(0.0));
        Setting { alpha, parameters: self.parameters }
    }

    /// Why there is no such albedo, if there is none.
    pub(crate) fn refused(&self) -> Option<&'static str> {
        match self.model.integral {
            Integral::Unbounded(why) => Some(why),
            _ => self.model.refused(&self.parameters),
        }
    }
}

impl Factor {
    /// The albedo that it is made of, if it is.
    pub fn albedo(&self) -> Option<&Albedo> {
        match self {
            Self::Missing { of, .. } | Self::Restored { of, .. } | Self::BelowSheen { of, .. } => Some(of),
            Self::Coat { .. } | Self::BelowCoat { .. } => None,
        }
    }

    /// What it multiplies a bound on ρ with.
    pub(crate) fn rho_bound(&self) -> f64 {
        match self {
            Self::Restored { f0, .. } => 1.0 + f0 * (RESTORED_BOUND - 1.0),
            _ => 1.0,
        }
    }

    /// Whether its lobe is what another one misses: both together are at most 1.
    pub(crate) fn is_missing(&self) -> bool {
        matches!(self, Self::Missing { .. })
    }

    /// In a word.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Missing { .. } => "missing",
            Self::Restored { .. } => "restored",
            Self::Coat { .. } => "coat",
            Self::BelowCoat { .. } => "below a coat",
            Self::BelowSheen { .. } => "below a sheen",
        }
    }

    /// In words, for plans and manifests.
    pub fn describe(&self) -> String {
        let name = |of: &Albedo| match of.roughness {
            Some(roughness) => format!("E of {} at roughness {roughness}", of.model.name),
            None => format!("E of {} at its roughness", of.model.name),
        };
        match self {
            Self::Missing { of, f_avg } => format!(
                "(1 − E(μi)) (1 − E(μe)) / (1 − E_avg) · F_ms, F_avg = {f_avg:.6}, {}; Kulla & Conty 2017",
                name(of)
            ),
            Self::Restored { of, f0 } => {
                format!("1 + {f0:.6} (1/E(μe) − 1), {}; Turquin 2019", name(of))
            }
            Self::Coat { weight } => {
                format!("{weight} (0.04 + 0.96 (1 − μe)^5); KHR_materials_clearcoat")
            }
            Self::BelowCoat { weight } => {
                format!("1 − {weight} (0.04 + 0.96 (1 − μe)^5); KHR_materials_clearcoat")
            }
            Self::BelowSheen { of, most: 1.0 } => {
                format!("1 − min(1, max(E(μi), E(μe))), {}; KHR_materials_sheen", name(of))
            }
            Self::BelowSheen { of, most } => {
                format!("1 − {most:.6} min(1, max(E(μi), E(μe))), {}; KHR_materials_sheen", name(of))
            }
        }
    }
}

/// ρ_dh of a restored lobe with F = 1, at most: ∫ S/E(μe) cos θe dωe ≤ 1/min E = 1/(1 − ln 2). Of GGX it is 2.20 at
/// α = 1 and grazing, by quadrature apart from this code.
pub(crate) const RESTORED_BOUND: f64 = 3.26;

/// The error of E as both paths have it, absolute; a test holds it.
pub(crate) const ALBEDO_ERROR: f64 = 1e-10;
