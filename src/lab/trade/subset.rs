//! The texels that every method is judged by.

use crate::base::error::Result;
use crate::plan::TablePlan;
use crate::table::axis::Axis;
use crate::table::indices;
use std::fmt;

/// A product of samples of each axis: so it is a table of its own, which a method can be run on.
pub(super) struct Subset {
    /// Texels of the whole table, in the order of the subset's.
    pub texels: Vec<usize>,
    /// The table of these texels alone.
    pub plan: TablePlan,
}

/// No fewer texels, where the table has so many.
const TEXELS: f64 = 1024.0;
/// Samples that are taken at both ends of an axis: grazing directions and narrow lobes are worst.
const ENDS: usize = 4;
const SEED: u32 = 0x9e37_79b9;

impl Subset {
    pub fn new(table: &TablePlan) -> Result<Self> {
        let dimensions = table.axes().len().max(1) as f64;
        let strata = TEXELS.powf(1.0 / dimensions).ceil() as usize;
        let mut random = SEED;
        let picks: Vec<Vec<usize>> =
            table.axes().iter().map(|axis| pick(axis.len(), strata, &mut random)).collect();
        let listed = |(axis, picks): (&Axis, &Vec<usize>)| {
            Axis::listed(axis.variable(), picks.iter().map(|&k| axis.values()[k]).collect())
        };
        let axes = table.axes().iter().zip(&picks).map(listed).collect::<Result<Vec<_>>>()?;
        let plan = table.at_samples(axes);
        let whole = |texel| {
            let at = indices(&plan.shape(), texel);
            let index = at.iter().zip(&picks).map(|(&k, picks)| picks[k]);
            index.zip(table.shape()).fold(0, |flat, (k, n)| flat * n + k)
        };
        Ok(Self { texels: (0..plan.texels()).map(whole).collect(), plan })
    }
}

/// The ends of an axis, and one sample of each of so many strata between.
fn pick(n: usize, strata: usize, random: &mut u32) -> Vec<usize> {
    if n <= strata + ENDS {
        return (0..n).collect();
    }
    let inside = strata - ENDS;
    let between = n - 2 * ENDS;
    let edge = |k: usize| ENDS + k * between / inside;
    let mut picks: Vec<_> = (0..ENDS).chain(n - ENDS..n).collect();
    for k in 0..inside {
        // Numerical Recipes' generator: any will do.
        *random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let width = edge(k + 1) - edge(k);
        picks.push(edge(k) + (*random >> 8) as usize % width.max(1));
    }
    picks.sort_unstable();
    picks.dedup();
    picks
}

impl fmt::Display for Subset {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shape: Vec<_> = self.plan.shape().iter().map(usize::to_string).collect();
        write!(
            f,
            "{} texels ({}): the {ENDS} samples at both ends of each axis, and one in each stratum between, \
             seed {SEED:#x}",
            self.texels.len(),
            if shape.is_empty() { "1".into() } else { shape.join(" × ") },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model;
    use crate::table::axis::Variable;
    use crate::table::quantity;

    #[test]
    fn a_subset_has_the_corners_and_its_values_are_the_tables() {
        let axis = |variable| Axis::natural(variable, 128).unwrap();
        let axes = vec![axis(Variable::Roughness), axis(Variable::Mu)];
        let ggx = model::find("ggx").unwrap();
        let table = TablePlan::basis("t", &quantity::SPLIT_SUM, ggx, None, axes).unwrap();
        let subset = Subset::new(&table).unwrap();
        assert!(subset.texels.len() >= 1024 && subset.texels.is_sorted());
        assert!([0, 127, 127 * 128, 128 * 128 - 1].iter().all(|corner| subset.texels.contains(corner)));
        for (k, &texel) in subset.texels.iter().enumerate() {
            let (small, large) = (indices(&subset.plan.shape(), k), indices(&table.shape(), texel));
            for axis in 0..2 {
                assert_eq!(
                    subset.plan.axes()[axis].values()[small[axis]],
                    table.axes()[axis].values()[large[axis]]
                );
            }
        }
        assert_eq!(pick(5, 32, &mut 1), [0, 1, 2, 3, 4]);
    }
}
