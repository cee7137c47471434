//! The values that a parameter really takes, with their frequencies.

/// A weighted set of values: what a texture's texels, times a factor, amount to.
#[derive(Debug, Clone, PartialEq)]
pub struct Distribution {
    /// (value, weight), values strictly increasing, weights positive with sum 1.
    bins: Vec<(f64, f64)>,
}

impl Distribution {
    /// Always the same value.
    pub fn constant(value: f64) -> Self {
        Self { bins: vec![(value, 1.0)] }
    }

    /// Every value of [min, max] alike: what is assumed where a texture could not be read.
    pub fn uniform(min: f64, max: f64) -> Self {
        const STEPS: usize = 256;
        Self::weighted((0..=STEPS).map(|k| (min + (max - min) * k as f64 / STEPS as f64, 1.0)))
            .unwrap_or_else(|| Self::constant(min))
    }

    /// Values with weights, in any order; weights of 0 are dropped. `None` when nothing is left.
    pub fn weighted(samples: impl IntoIterator<Item = (f64, f64)>) -> Option<Self> {
        let mut samples: Vec<_> = samples.into_iter().filter(|&(_, weight)| weight > 0.0).collect();
        samples.sort_by(|x, y| x.0.total_cmp(&y.0));
        let total: f64 = samples.iter().map(|s| s.1).sum();
        let mut bins: Vec<(f64, f64)> = Vec::new();
        for (value, weight) in samples {
            match bins.last_mut() {
                Some(last) if last.0 == value => last.1 += weight / total,
                _ => bins.push((value, weight / total)),
            }
        }
        (!bins.is_empty()).then_some(Self { bins })
    }

    /// The union of several, each counted alike.
    pub fn union<'a>(all: impl IntoIterator<Item = &'a Self>) -> Option<Self> {
        Self::weighted(all.into_iter().flat_map(|d| d.bins.iter().copied()))
    }

    /// The smallest value.
    pub fn min(&self) -> f64 {
        self.bins[0].0
    }

    /// The largest value.
    pub fn max(&self) -> f64 {
        self.bins[self.bins.len() - 1].0
    }

    /// Whether it takes one value only.
    pub fn is_constant(&self) -> bool {
        self.bins.len() == 1
    }

    /// The value below which a fraction `q` ∈ [0, 1] of the weight lies.
    pub fn quantile(&self, q: f64) -> f64 {
        let mut sum = 0.0;
        for &(value, weight) in &self.bins {
            sum += weight;
            // The slack forgives the rounding of the weights' sum.
            if sum >= q - 1e-12 {
                return value;
            }
        }
        self.max()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_a_skewed_set() {
        let d = Distribution::weighted([(0.5, 1.0), (0.1, 8.0), (0.9, 1.0), (0.1, 0.0)]).unwrap();
        assert_eq!((d.min(), d.quantile(0.5), d.quantile(0.85), d.max()), (0.1, 0.1, 0.5, 0.9));
    }
}
