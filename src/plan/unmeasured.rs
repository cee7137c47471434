//! The error of a table before anything is compared with it.

use super::TablePlan;
use crate::base::precision::VALUE_FLOOR;
use crate::model::lobe::Lobe;
use crate::table::{ErrorKind, TableError};

impl TablePlan {
    /// The error of the plan's table before any texel is compared: its kind, and the estimate if there is one.
    pub(crate) fn unmeasured(&self, estimate: Option<f64>) -> TableError {
        let kind = self.quantity.error;
        let floor = (kind == ErrorKind::Relative).then(|| value_floor(&self.lobes));
        TableError::unmeasured(kind, floor, estimate)
    }
}

/// The floor of relative errors for a sum of lobes, some of which may lose their digits before [`VALUE_FLOOR`].
fn value_floor(lobes: &[Lobe]) -> f64 {
    lobes.iter().filter_map(|lobe| lobe.model().faint()).fold(VALUE_FLOOR, f64::max)
}
