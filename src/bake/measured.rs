//! Measures the error of a table: against the reference, and of bilinear look-ups.

use crate::base::error::Result;
use crate::check::{bilinear, cross_check};
use crate::plan::TablePlan;
use crate::table::{Check, TableError, Values};

/// Measures the error of `values`, the stored table of `plan`.
pub(super) fn table_error(
    plan: &TablePlan,
    values: &Values,
    check: Check,
    estimate: Option<f64>,
    tick: &(impl Fn(f64) -> Result<()> + Sync),
) -> Result<TableError> {
    let error = cross_check(plan, values, check, estimate, tick)?;
    Ok(TableError { interpolation: bilinear::measure(plan, values, check)?, ..error })
}
