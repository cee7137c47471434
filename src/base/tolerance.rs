//! The tolerance of a table, and how it is spent.
//!
//! A table keeps a tolerance T: the largest error that its stored values may have, absolute for integrals and relative
//! for values. This page is the only place that divides it.
//!
//! | who spends | share | why |
//! |---|---|---|
//! | the quadrature rule | T, or T/10 (`RULE_SHARE`) where storage rounds or a reader interpolates | rounding to f16 or unorm16 and bilinear look-ups take the rest |
//! | the rule below half floats | what their rounding leaves, if that is less; T/100 (`LEAST_BEFORE_STORAGE`) at least | halves round by up to 2.44e-4 below 1: of 2.5e-4 the rule may take 6e-6. Where the bound is above T, values may still be small |
//! | the rule below unorm16 | at most ¼ step (`UNORM_RULE`) | the rule may not lift an integral of 1 above what rounds to 1 |
//! | interpolation between integrals | 1/8 of the rule's share along each axis (`CHEBYSHEV_SHARE`) | the rule at the sources and f32 rounding take the other 6/8 |
//! | a lobe times factors | 1/100 of the rule's share (`FACTOR_SHARE`) | node counts are measured for the lobe alone; a factor bends ρ where the lobe does not: with counts of the full share a restored lobe is off by 9e-6 at 1e-6 |
//! | the certificate's second rule | T/10 (`CERTIFY_RATIO`) | its own error then is a tenth of what it judges |
//! | the reference of a sampled check | T/20 (`REFERENCE_SHARE`), all its digits with `Check::All` | a right table then measures at most T + T/20, and its integrals cost a tenth of those with all digits |
//! | a texel that the certificate keeps | half (`KEPT_SHARE`) of what rounding to storage leaves of T | both rules may err towards each other |
//! | energy above the declared bound | 2 T (`ENERGY_SLACK`) | two channels add up, each within T |
//! | a layout's bilinear error | 0.98 T (`LAYOUT_MARGIN`) | the search tests points; the worst lies between them |
//! | look-ups of listed directions | T/10 (`LISTED_SHARE`) for the integrals that stand in for the exact values, where no bilinear error is promised | an integral over listed directions takes as long as a hundred others |
//! | the search's reference table | T/100 (`LAYOUT_REFERENCE_SHARE`) | it stands in for the exact values |
//!
//! What follows from a table's tolerance (the rule's share, the precision, the storage) is decided once, when
//! the plan is checked, and carried by [`TablePlan`](crate::plan::TablePlan).

use super::error::{Error, Result};

/// The largest error that a table may have: finite and above 0.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Tolerance(f64);

impl Tolerance {
    /// The default tolerance, 1e-4.
    pub const DEFAULT: Self = Self(1e-4);

    /// A tolerance of `value`.
    ///
    /// # Errors
    /// When it is not finite or not above 0.
    pub fn new(value: f64) -> Result<Self> {
        if value.is_finite() && value > 0.0 {
            return Ok(Self(value));
        }
        Err(Error::input(format!("a tolerance of {value}; give a number above 0, such as 1e-4")))
    }

    #[cfg(feature = "check")]
    /// A tolerance from a constant, or from a share of one that was checked.
    pub(crate) const fn known(value: f64) -> Self {
        Self(value)
    }

    /// The number.
    pub const fn get(self) -> f64 {
        self.0
    }
}

/// The rule's share where rounding of storage or bilinear look-ups take the rest.
pub(crate) const RULE_SHARE: f64 = 0.1;

/// The least share of the tolerance that is left to the rule below half floats.
pub(crate) const LEAST_BEFORE_STORAGE: f64 = 0.01;

/// The largest error of the rule below unorm16: a quarter of its step, 1/65535.
pub(crate) const UNORM_RULE: f64 = 0.25 / 65535.0;

/// The share of the rule's tolerance that interpolation along each axis may take.
pub(crate) const CHEBYSHEV_SHARE: f64 = 1.0 / 8.0;

/// The share of the rule's tolerance to which a lobe times factors is integrated.
pub(crate) const FACTOR_SHARE: f64 = 0.01;

/// The tolerance of the certificate's rule, in tolerances of the rule that it judges.
pub(crate) const CERTIFY_RATIO: f64 = 0.1;

/// The error of the reference's integrals, in tolerances, where a sample of texels is compared.
#[cfg(feature = "check")]
pub(crate) const REFERENCE_SHARE: f64 = 0.05;

/// The largest difference between the two rules, in tolerances, at which a texel keeps its value.
pub(crate) const KEPT_SHARE: f64 = 0.5;

/// The energy, in tolerances, that a texel may reflect above the bound that its models promise.
pub(crate) const ENERGY_SLACK: f64 = 2.0;

/// The share of the tolerance that the layout search may use up at its test points.
#[cfg(feature = "check")]
pub(crate) const LAYOUT_MARGIN: f64 = 0.98;

/// The share of the tolerance to which integrals over listed directions are computed between the samples of a table that
/// promises nothing there.
#[cfg(feature = "check")]
pub(crate) const LISTED_SHARE: f64 = 0.1;

/// The share of the tolerance to which the layout search computes its reference table.
#[cfg(feature = "check")]
pub(crate) const LAYOUT_REFERENCE_SHARE: f64 = 0.01;

/// The finest tolerance that the tables of node counts cover.
pub(crate) const FINEST: f64 = 1e-10;

/// The index of a tolerance in the tables of node counts, which are for 1e-1 … 1e-10: that of the power
/// of ten at or below it.
pub(crate) fn decade(tolerance: f64) -> usize {
    // The slack forgives the rounding of 1e-3.
    (-tolerance.log10() - 1e-9).ceil().clamp(1.0, 10.0) as usize - 1
}

/// Whether a tolerance is finer than f32 meets: such tables take the maps that converge further. The tables of node counts
/// are measured with the coarse maps to 1e-6, and with the fine ones beyond.
pub(crate) fn is_fine(tolerance: f64) -> bool {
    decade(tolerance) > decade(1e-6)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tolerance that takes the node counts of 1e-7 takes the map that they were measured with: 9.5e-7 by the coarse one
    /// was off by 1.58e-6.
    #[test]
    fn counts_and_maps_change_at_the_same_tolerance() {
        for (tolerance, index) in
            [(1e-6, 5), (1e-6 * (1.0 - 1e-12), 5), (0.95e-6, 6), (1e-7, 6), (1e-6 * 1.01, 5)]
        {
            assert_eq!((decade(tolerance), is_fine(tolerance)), (index, index > 5), "{tolerance:e}");
        }
    }

    #[test]
    fn a_tolerance_is_finite_and_above_0() {
        for value in [f64::NAN, f64::INFINITY, -1e-4, 0.0, -0.0] {
            let why = Tolerance::new(value).unwrap_err().to_string();
            assert!(why.contains("give a number above 0"), "{why}");
        }
        assert_eq!(Tolerance::new(1e-6).unwrap().get(), 1e-6);
    }
}
