//! Points that fill a cube evenly, and reproducible chance.

/// The additive recurrence R_d of Roberts 2018, "The Unreasonable Effectiveness of Quasirandom Sequences":
/// point n is fract(½ + n a_j) with a_j = g⁻ʲ, g the positive root of g^(d+1) = g + 1.
pub(super) struct Recurrence {
    steps: Vec<f64>,
}

impl Recurrence {
    pub fn new(dimensions: usize) -> Self {
        let mut root: f64 = 1.5;
        for _ in 0..64 {
            root = (1.0 + root).powf(1.0 / (dimensions as f64 + 1.0));
        }
        Self { steps: (1..=dimensions).map(|j| root.powi(-(j as i32))).collect() }
    }

    /// Point n, in [0, 1)^d.
    pub fn point(&self, n: u64) -> impl Iterator<Item = f64> + '_ {
        self.steps.iter().map(move |step| (0.5 + n as f64 * step).fract())
    }
}

/// SplitMix64 (Steele, Lea & Flood 2014).
pub(super) struct Chance(pub u64);

impl Chance {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    pub fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }
}
