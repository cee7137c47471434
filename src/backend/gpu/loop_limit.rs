//! Counts the turns that the loops of one invocation take. Some drivers silently stop an invocation's loops after 65,535
//! turns of all of them together, and the rest of a sum is then missing from a table.

use crate::base::error::{Error, Result};
use crate::integrate::rule_set::{InnerRule, RuleKind, RuleSet};
use crate::integrate::slope_rule::SlopeRule;
use crate::plan::TablePlan;
use crate::shader::VALUE_WINDOW;

/// The number of turns that every driver runs, half of the strictest one's. Tables with fewer need no driver probe.
pub(crate) const SAFE_TURNS: u32 = 32_000;

/// Refuses a table whose loops the driver may stop. `known` returns the turns that are known to run; it is called only if
/// a table takes more than [`SAFE_TURNS`].
pub(crate) fn check(table: &TablePlan, rules: &RuleSet, known: impl FnOnce() -> Result<u32>) -> Result<()> {
    let turns = turns(rules);
    if turns <= SAFE_TURNS as usize {
        return Ok(());
    }
    let known = known()?;
    if turns <= known as usize {
        return Ok(());
    }
    Err(Error::Device(format!(
        "table \"{}\": {} takes {turns} turns of loops in one invocation, and only {known} are known to run here (see \
         `gonio devices`); take a coarser rule or tolerance, or the CPU path",
        table.name(),
        table.rule()
    )))
}

/// The largest number of turns of all loops of one invocation, over the kernels of a rule set. The turn that finds a loop
/// at its end is counted too.
fn turns(rules: &RuleSet) -> usize {
    match &rules.kind {
        // Eight invocations share a window.
        RuleKind::Values(_) => VALUE_WINDOW / 8 + 1,
        RuleKind::Integrals { inner, outer } => {
            let inner = match inner {
                InnerRule::Slopes(rule) => slopes(rule),
                InnerRule::Product { azimuths, .. } => in_blocks(azimuths.len()),
                // And a loop over four α.
                InnerRule::Samples(rule) => in_blocks(rule.chunk) + 5,
                InnerRule::Listed(rule) => in_blocks(rule.max_cost()) + rule.max_cost().div_ceil(32),
                InnerRule::ClosedForm { .. } => 0,
            };
            outer.iter().map(|matrix| in_blocks(matrix.columns)).fold(inner, usize::max)
        }
    }
}

/// The turns of a sum in blocks of 32, as `product.wgsl`, `listed.wgsl`, `sampling.wgsl` and `sum.wgsl` have it.
fn in_blocks(terms: usize) -> usize {
    terms + 2 * terms.div_ceil(32) + 1
}

/// The turns of `slopes.wgsl`: for both sides, azimuths and the nodes of each, and the results of four α. Invocations
/// that run in step wait for the one with the largest counts.
fn slopes(rule: &SlopeRule) -> usize {
    let (sides, results) = (3, 5);
    let terms: usize = [0, 1]
        .map(|side| {
            let counts = || rule.tiles.iter().map(|tile| tile[side].counts);
            let azimuths = counts().map(|counts| counts.azimuths).max().unwrap_or(0);
            let nodes = counts().map(|counts| counts.nodes).max().unwrap_or(0);
            azimuths * (nodes + 2) + 1
        })
        .iter()
        .sum();
    terms + sides + results
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::tolerance::is_fine;
    use crate::model;
    use crate::model::Integral;
    use crate::table::axis::{Axis, Variable};
    use crate::table::quantity::{RHO_DH, RHO_HH};

    /// The warped rule takes no more turns than every driver runs, over all α and μ: with room down to 1e-8, beyond which
    /// exact Fresnel terms take more. Rules by directions of the host stay within it down to 1e-6, or 1e-5 of anisotropic
    /// models.
    #[test]
    fn the_warped_rule_is_safe_on_every_driver() {
        const STRICTEST: u32 = 65_535;
        let mut failed = Vec::new();
        for model in model::all().filter(|model| !matches!(model.integral, Integral::Unbounded(_))) {
            let (decades, count) = if crate::base::is_thorough() { (1..=10, 96) } else { (6..=10, 24) };
            for tolerance in decades.map(|decade| 10f64.powi(-decade)) {
                for quantity in [&RHO_DH, &RHO_HH] {
                    let rough = model.shape.map(|_| Axis::natural(Variable::Roughness, count).unwrap());
                    let about = quantity.variables(model.is_anisotropic());
                    let axis = |&variable: &Variable| {
                        let count = if variable == Variable::PhiI { 3 } else { count };
                        Axis::natural(variable, count).unwrap()
                    };
                    let axes = rough.into_iter().chain(about.iter().map(axis)).collect();
                    let plan = TablePlan::basis("t", quantity, model, None, axes).unwrap();
                    let plan = plan.with_tolerance(tolerance).unwrap();
                    let turns = turns(&RuleSet::new(&plan, &plan.lobes()[0]));
                    let limit = match model.integral {
                        // A table that takes more is refused where that is not known to run.
                        Integral::Listed(_) if is_fine(tolerance) => u32::MAX,
                        Integral::Listed(_) if model.is_anisotropic() && tolerance < 0.9e-5 => u32::MAX,
                        Integral::Listed(_) => STRICTEST,
                        _ if tolerance > 0.9e-8 => SAFE_TURNS,
                        _ => STRICTEST,
                    };
                    if turns > limit as usize {
                        failed.push(format!("{plan}: {turns} turns"));
                    }
                }
            }
        }
        assert!(failed.is_empty(), "{failed:#?}");
    }
}
