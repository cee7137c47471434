//! Metals by name: what `metal = "gold"` stands for under the exact Fresnel term of a conductor.
//!
//! η and k of each channel are those at one wavelength, 611.4 nm for R, 549.1 nm for G and 464.2 nm for B (the
//! dominant wavelengths of Rec. 709's primaries), interpolated linearly in the wavelength between the published
//! samples, which are some 30 nm apart, and rounded to their digits. A spectrum seen through the eye's three broad
//! responses is not that: for Au, whose absorption edge lies between G and B, F0 is off by some hundredths. Thin
//! evaporated films at room temperature, over vacuum; polished bulk metal in air, with its oxide, reflects less.
//!
//! The samples are those of the refractiveindex.info database (Polyanskiy 2024, *Sci. Data* 11, 94; CC0), files
//! `main/Ag/nk/Johnson.yml` and so on.

/// A metal: its index for R, G and B.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Metal {
    /// The name in recipes.
    pub name: &'static str,
    /// η.
    pub eta: [f64; 3],
    /// k.
    pub k: [f64; 3],
    /// Who measured it.
    pub source: &'static str,
}

const NOBLE: &str = "Johnson & Christy 1972, Phys. Rev. B 6, 4370";
const TRANSITION: &str = "Johnson & Christy 1974, Phys. Rev. B 9, 5056";
const RAKIC: &str = "Rakić 1995, Appl. Opt. 34, 4755";

/// The metals there are.
pub static METALS: [Metal; 8] = [
    metal("aluminium", [1.322, 1.011, 0.683], [7.311, 6.617, 5.625], RAKIC),
    metal("chromium", [3.18, 3.18, 2.45], [3.30, 3.33, 3.21], TRANSITION),
    metal("copper", [0.36, 1.02, 1.25], [3.127, 2.579, 2.453], NOBLE),
    metal("gold", [0.22, 0.43, 1.33], [3.208, 2.461, 1.872], NOBLE),
    metal("iron", [2.89, 2.95, 2.64], [3.04, 2.93, 2.80], TRANSITION),
    metal("nickel", [1.99, 1.92, 1.76], [3.98, 3.61, 3.04], TRANSITION),
    metal("silver", [0.06, 0.06, 0.05], [4.106, 3.590, 2.795], NOBLE),
    metal("titanium", [2.66, 2.54, 2.30], [3.70, 3.43, 3.08], TRANSITION),
];

const fn metal(name: &'static str, eta: [f64; 3], k: [f64; 3], source: &'static str) -> Metal {
    Metal { name, eta, k, source }
}

impl Metal {
    /// A parameter of its index, by the name in recipes.
    #[cfg(feature = "scene")]
    pub(crate) fn get(&self, name: &str) -> Option<[f64; 3]> {
        match name {
            "eta" => Some(self.eta),
            "k" => Some(self.k),
            _ => None,
        }
    }
}
