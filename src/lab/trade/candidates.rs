//! Every method at every cost, and what of it a budget allows.

use crate::base::error::Result;
use crate::base::precision::Precision;
use crate::integrate::rule_set::RuleSet;
use crate::plan::TablePlan;
use crate::table::ErrorKind;
use crate::table::rule::Rule;
use crate::table::storage::Storage;
use std::iter;

/// A method at a cost, and the texels that it is run on.
pub(super) struct Candidate {
    pub method: &'static str,
    pub setting: String,
    pub plan: TablePlan,
    /// What the tolerance of the warped rule asks for; peers bake in f32.
    pub precision: Precision,
    /// All of the table's texels, or the subset's.
    pub whole: bool,
    /// Of the integrand, in one run.
    pub evaluations: u64,
}

/// Evaluations that a run may have for each second of the budget. The costs double, so that the longest run
/// of a method takes half of its time: 2 to 4 runs of it for each of six methods fill the budget on two
/// cores, which do some 5 · 10⁸ a second.
const EVALUATIONS_PER_SECOND: f64 = 1e7;

/// What to measure, and what not and why. By counting alone: the same on every machine.
pub(super) fn candidates(
    table: &TablePlan,
    subset: &TablePlan,
    budget: f64,
) -> (Vec<Candidate>, Vec<String>) {
    let most = budget * EVALUATIONS_PER_SECOND;
    let (mut found, mut left_out) = (Vec::new(), Vec::new());
    for method in methods() {
        let stored = |row: CandidateSetting| storages(row.2).map(move |storage| (row.clone(), storage));
        for ((setting, rule, tolerance), storage) in method.into_iter().flat_map(stored) {
            let of = |plan: &TablePlan| -> Result<(TablePlan, u64)> {
                let plan = plan.clone().with_rule(rule)?.with_storage(storage)?;
                let plan =
                    if let Some(tolerance) = tolerance { plan.with_tolerance(tolerance)? } else { plan };
                let evaluations: u64 =
                    plan.lobes().iter().map(|lobe| RuleSet::new(&plan, lobe).evaluations()).sum();
                Ok((plan, evaluations))
            };
            let method = rule.name();
            let take = |(plan, evaluations): (TablePlan, u64), whole| Candidate {
                method,
                setting: setting.clone(),
                precision: if tolerance.is_some() { plan.precision() } else { Precision::F32 },
                plan,
                whole,
                evaluations,
            };
            // f over (θ, φ) takes several times as long as a sample.
            let most = if matches!(rule, Rule::Grid { .. } | Rule::Gauss { .. }) { most / 4.0 } else { most };
            match (of(table), of(subset)) {
                (Ok(all), _) if all.1 as f64 <= most => found.push(take(all, true)),
                (_, Ok(part)) if part.1 as f64 <= most => found.push(take(part, false)),
                (_, Ok(part)) => left_out.push(format!(
                    "{method} {setting}: {:.1e} evaluations on the subset alone, and the budget allows {most:.0e}",
                    part.1 as f64
                )),
                (_, Err(why)) => {
                    // What does not fit the lobe does not fit at any cost: once is enough.
                    left_out.push(format!("{method} {setting}: {why}"));
                    break;
                }
            }
        }
    }
    (found, left_out)
}

/// The formats that a table of a tolerance is stored in: as computed, and those which round by less than it. Rules
/// without a tolerance leave no room for rounding, and take the first alone. Not only
/// for rows on the front: which these are depends on the clock.
pub(super) fn storages(tolerance: Option<f64>) -> impl Iterator<Item = Storage> {
    let narrow = [Storage::F16, Storage::Unorm16].into_iter();
    let fits = move |storage: &Storage| tolerance.is_some_and(|t| storage.rounding(ErrorKind::Absolute) <= t);
    iter::once(Storage::F32).chain(narrow.filter(fits))
}

/// The rule of a method at a setting, and its tolerance where it takes one.
pub(super) fn setting(method: &str, setting: &str) -> Option<(Rule, Option<f64>)> {
    let found =
        methods().into_iter().flatten().find(|(name, rule, _)| rule.name() == method && name == setting);
    found.map(|(_, rule, tolerance)| (rule, tolerance))
}

type CandidateSetting = (String, Rule, Option<f64>);

/// The methods, each from cheap to dear.
pub(super) fn methods() -> [Vec<CandidateSetting>; 6] {
    let sampled = |rule: fn(usize) -> Rule| {
        (4..=18).map(|k| 1 << k).map(|samples| (samples.to_string(), rule(samples), None)).collect()
    };
    let product = |rule: fn(usize) -> Rule| {
        (3..=10)
            .map(|k| 1 << k)
            .map(|theta| (format!("{theta} × {}", 2 * theta), rule(theta), None))
            .collect()
    };
    [
        (1..=9).map(|k| (format!("1e-{k}"), Rule::Warped, Some(10f64.powi(-k)))).collect(),
        product(|theta| Rule::Gauss { theta, phi: 2 * theta }),
        product(|theta| Rule::Grid { theta, phi: 2 * theta }),
        sampled(|samples| Rule::Hammersley { samples }),
        sampled(|samples| Rule::Vndf { samples }),
        sampled(|samples| Rule::Random { samples }),
    ]
}
