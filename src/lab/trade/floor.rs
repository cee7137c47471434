//! What a table would take if the device did nothing but write it, or nothing but its arithmetic.

use crate::backend::gpu::Rates;
use crate::model::GGX;
use crate::plan::TablePlan;
use crate::table::rule::Rule;
use serde::Serialize;

/// What the device can do at most, measured by kernels that do nothing else.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Floor {
    /// Bytes written in a second, 32 MiB at once.
    pub bytes_per_second: f64,
    /// Multiplications and additions in a second.
    pub operations_per_second: f64,
}

impl Floor {
    pub(super) fn new(rates: Rates) -> Self {
        Self { bytes_per_second: rates.bytes, operations_per_second: rates.operations }
    }

    /// The longer of both, as a device may do both at once.
    pub fn seconds(&self, bytes: f64, operations: f64) -> f64 {
        (bytes / self.bytes_per_second).max(operations / self.operations_per_second)
    }
}

/// Operations of one evaluation of GGX's integrand; unknown for other models.
///
/// Counted in the sources: each product, sum, minimum, conversion, shift, division and root is one, though
/// a division and a root take several; what a compiler lifts out of the loop is none, nor what interpolates a table
/// between its integrals. So it is a floor.
pub(super) fn operations(plan: &TablePlan) -> Option<f64> {
    let [lobe] = plan.lobes() else { return None };
    (lobe.model() == &GGX).then_some(match plan.rule() {
        // ndf_map 12, slope_term 36 with masking 8 and Fresnel 4, the loop of `integral` 4
        Rule::Warped => 52.0,
        // half_vector 10, ndf 5, fresnel 8, their product, weight and sum 7; visibility is lifted
        Rule::Grid { .. } | Rule::Gauss { .. } => 30.0,
        // ndf_facet 3, its weight 2, facet_estimate 27 with masking 8 and Fresnel 4, sums 2
        Rule::Hammersley { .. } => 34.0,
        // vndf_facet 16, facet_estimate 27, sums 2
        Rule::Vndf { .. } => 45.0,
        // as vndf; two numbers of PCG 26, the cosine 19
        Rule::Random { .. } => 90.0,
    })
}
