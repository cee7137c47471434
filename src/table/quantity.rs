//! The quantities that can be tabulated. A new one is an entry here, if one of the evaluations fits.

use crate::base::error::{Error, Result};
use crate::table::ErrorKind;
use crate::table::axis::Variable;

/// What a table holds.
#[derive(Debug, PartialEq)]
pub struct Quantity {
    /// The name in recipes, files and manifests.
    pub name: &'static str,
    /// The symbol in print.
    pub symbol: &'static str,
    /// The unit of its values.
    pub unit: &'static str,
    /// One line for people.
    pub summary: &'static str,
    /// The directions it runs over, slowest first; a subject's roughness comes before them.
    pub variables: &'static [Variable],
    /// The same where a lobe tells azimuths from each other.
    pub about: &'static [Variable],
    /// How errors are counted.
    pub error: ErrorKind,
    /// How it follows from f.
    pub evaluation: Evaluation,
}

impl Quantity {
    /// The directions it runs over, of subjects that tell azimuths from each other or not.
    pub fn variables(&self, anisotropic: bool) -> &'static [Variable] {
        if anisotropic { self.about } else { self.variables }
    }
}

/// How a quantity follows from a BRDF.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Evaluation {
    /// f itself.
    Value,
    /// ∫ f cos θ dω over one direction, the other fixed.
    Directional,
    /// The cosine-weighted mean of that over the fixed direction.
    Hemispherical,
}

/// f(θi, θe, δφ).
pub static BRDF: Quantity = Quantity {
    name: "brdf",
    symbol: "f",
    unit: "sr⁻¹",
    summary: "the BRDF, without the cosine",
    variables: &[Variable::ThetaI, Variable::ThetaE, Variable::DeltaPhi],
    about: &[Variable::ThetaI, Variable::PhiI, Variable::ThetaE, Variable::PhiE],
    error: ErrorKind::Relative,
    evaluation: Evaluation::Value,
};

/// ρ_dh(θi) = ∫ f cos θe dωe.
pub static RHO_DH: Quantity = Quantity {
    name: "rho_dh",
    symbol: "ρ_dh",
    unit: "1",
    summary: "directional-hemispherical reflectance",
    variables: &[Variable::ThetaI],
    about: &[Variable::ThetaI, Variable::PhiI],
    error: ErrorKind::Absolute,
    evaluation: Evaluation::Directional,
};

/// ρ_hh = 2 ∫ ρ_dh(μ) μ dμ.
pub static RHO_HH: Quantity = Quantity {
    name: "rho_hh",
    symbol: "ρ_hh",
    unit: "1",
    summary: "hemispherical-hemispherical reflectance, the cosine-weighted mean of rho_dh",
    variables: &[],
    about: &[],
    error: ErrorKind::Absolute,
    evaluation: Evaluation::Hemispherical,
};

/// A and B of ∫ f cos θi dωi = F0·A + F90·B, over μ = cos θe.
pub static SPLIT_SUM: Quantity = Quantity {
    name: "split_sum",
    symbol: "A, B",
    unit: "1",
    summary: "the split sum (DFG) terms: F0·A + F90·B reflects",
    variables: &[Variable::Mu],
    about: &[Variable::Mu, Variable::PhiI],
    error: ErrorKind::Absolute,
    evaluation: Evaluation::Directional,
};

/// The registry.
pub static QUANTITIES: [&Quantity; 4] = [&BRDF, &RHO_DH, &RHO_HH, &SPLIT_SUM];

/// The quantity of this name.
pub fn find(name: &str) -> Result<&'static Quantity> {
    QUANTITIES.into_iter().find(|q| q.name == name).ok_or_else(|| {
        let names: Vec<_> = QUANTITIES.iter().map(|q| q.name).collect();
        Error::input(format!("no quantity \"{name}\"; there are {}", names.join(", ")))
    })
}
