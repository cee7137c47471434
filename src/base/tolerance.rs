//! Classes of tolerances, by which node counts are tabulated.

/// The finest tolerance that the tables of node counts know.
pub(crate) const FINEST: f64 = 1e-10;

/// The index of a tolerance in the tables of node counts, which are for 1e-1 … 1e-10: that of the power
/// of ten at or below it.
pub(crate) fn decade(tolerance: f64) -> usize {
    // The slack forgives the rounding of 1e-3.
    (-tolerance.log10() - 1e-9).ceil().clamp(1.0, 10.0) as usize - 1
}

/// Whether a tolerance is beyond f32: from there on maps matter that converge longer.
pub(crate) fn is_fine(tolerance: f64) -> bool {
    tolerance < 0.9e-6
}
