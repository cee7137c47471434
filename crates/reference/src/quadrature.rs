//! Adaptive Gauss–Kronrod quadrature of two integrands that share their evaluation.
//!
//! Kronrod 1965 adds eight nodes to the seven of Gauss; the difference of the two sums estimates the error.
//! The interval with the largest estimate is halved until the estimates add up to less than the tolerance
//! (Piessens et al. 1983, *QUADPACK*, routine QAG).

/// An integral and what is known of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The two integrals.
    pub value: [f64; 2],
    /// The estimated absolute error of both together.
    pub error: f64,
    /// Whether `error` is within the tolerance that was asked for.
    pub converged: bool,
}

impl Estimate {
    /// The integrals, or NaN where they did not converge: a failure that no comparison lets through, and that
    /// an enclosing [`integrate`] passes on.
    pub fn value_or_nan(self) -> [f64; 2] {
        if self.converged { self.value } else { [f64::NAN; 2] }
    }

    fn of(panels: &[Panel], tolerance: f64) -> Self {
        let error: f64 = panels.iter().map(|panel| panel.error).sum();
        let value = panels.iter().fold([0.0; 2], |sum, p| [sum[0] + p.value[0], sum[1] + p.value[1]]);
        Self { value, error, converged: error <= tolerance && !panels.is_empty() }
    }
}

/// Intervals are halved at most this often: a jump needs some 40 halvings to vanish in f64, a root at an end
/// some 25, so an integrand that needs more is not one of ours.
const MAX_HALVINGS: usize = 400;

/// ∫ f(x) dx from the first of `breaks` to the last, to the absolute `tolerance`.
///
/// The breaks ascend; put one wherever f has a kink or changes its scale. The result says if it did not
/// converge, be it for want of halvings or because f is not finite somewhere.
pub fn integrate(mut f: impl FnMut(f64) -> [f64; 2], breaks: &[f64], tolerance: f64) -> Estimate {
    adapt(&mut f, breaks, tolerance)
}

/// An integrand, by pointer: there are sixty of them, and the rule need not be compiled for each.
type Integrand<'a> = dyn FnMut(f64) -> [f64; 2] + 'a;

fn adapt(f: &mut Integrand, breaks: &[f64], tolerance: f64) -> Estimate {
    let ends = |w: &[f64]| [w[0], w[1]];
    let mut panels: Vec<Panel> = breaks.windows(2).map(ends).map(|[a, b]| Panel::new(f, a, b)).collect();
    for _ in 0..MAX_HALVINGS {
        let estimate = Estimate::of(&panels, tolerance);
        if estimate.converged || !estimate.error.is_finite() {
            return estimate;
        }
        halve_the_worst(&mut panels, f);
    }
    Estimate::of(&panels, tolerance)
}

/// Breaks from `start` to `end`, evenly spaced, at most `longest` apart; NaN passes through to the integral.
pub fn even_breaks(start: f64, end: f64, longest: f64) -> Vec<f64> {
    let count = ((end - start) / longest).ceil().max(1.0).min(MAX_HALVINGS as f64);
    (0..=count as usize).map(|k| start + (end - start) * (k as f64 / count)).collect()
}

fn halve_the_worst(panels: &mut Vec<Panel>, f: &mut Integrand) {
    let worst = panels.iter().enumerate().max_by(|(_, a), (_, b)| a.error.total_cmp(&b.error));
    if let Some((index, &Panel { start, end, .. })) = worst {
        let middle = 0.5 * (start + end);
        panels[index] = Panel::new(f, start, middle);
        panels.push(Panel::new(f, middle, end));
    }
}

/// One interval with its Kronrod sums.
struct Panel {
    start: f64,
    end: f64,
    value: [f64; 2],
    error: f64,
}

impl Panel {
    fn new(f: &mut Integrand, start: f64, end: f64) -> Self {
        let (centre, half) = (0.5 * (start + end), 0.5 * (end - start));
        let samples: [[f64; 2]; 15] = std::array::from_fn(|k| f(centre + half * signed_node(k)));
        let [a, b] = [0, 1].map(|channel| sums(|k| samples[k][channel], half));
        Self { start, end, value: [a.0, b.0], error: a.1 + b.1 }
    }
}

/// The Kronrod sum over 15 samples and its error estimate.
///
/// |K − G| is the error of the coarse sum; QUADPACK's (200 |K − G| / V)^1.5 V, with V the integral of the
/// deviation from the mean, models that of the fine one.
fn sums(sample: impl Fn(usize) -> f64, half: f64) -> (f64, f64) {
    let kronrod: f64 = (0..15).map(|k| kronrod_weight(k) * sample(k)).sum();
    let gauss: f64 = (0..7).map(|k| gauss_weight(k) * sample(2 * k + 1)).sum();
    let mean = 0.5 * kronrod;
    let deviation: f64 = (0..15).map(|k| kronrod_weight(k) * (sample(k) - mean).abs()).sum();
    let coarse = (kronrod - gauss).abs();
    let ratio = if coarse == 0.0 { 0.0 } else { 200.0 * coarse / deviation };
    let error = deviation * f64::min(1.0, ratio * ratio.sqrt());
    (kronrod * half, error * half.abs())
}

fn kronrod_weight(k: usize) -> f64 {
    KRONROD[k.abs_diff(7)]
}

fn gauss_weight(k: usize) -> f64 {
    GAUSS[k.abs_diff(3)]
}

fn signed_node(k: usize) -> f64 {
    if k < 7 { -NODES[7 - k] } else { NODES[k - 7] }
}

/// Non-negative nodes of the Kronrod rule, ascending; those with an even index are Gauss's.
#[rustfmt::skip]
const NODES: [f64; 8] = [
    0.0,                    0.207_784_955_007_898_46, 0.405_845_151_377_397_2, 0.586_087_235_467_691_1,
    0.741_531_185_599_394_4, 0.864_864_423_359_769_1, 0.949_107_912_342_758_5, 0.991_455_371_120_812_6,
];

/// Kronrod's weights of [`NODES`].
#[rustfmt::skip]
const KRONROD: [f64; 8] = [
    0.209_482_141_084_727_82, 0.204_432_940_075_298_9, 0.190_350_578_064_785_4, 0.169_004_726_639_267_9,
    0.140_653_259_715_525_92, 0.104_790_010_322_250_19, 0.063_092_092_629_978_56, 0.022_935_322_010_529_224,
];

/// Gauss's weights of every other node.
#[rustfmt::skip]
const GAUSS: [f64; 4] = [
    0.417_959_183_673_469_4, 0.381_830_050_505_118_9, 0.279_705_391_489_276_64, 0.129_484_966_168_869_7,
];

#[cfg(test)]
mod tests {
    use super::*;

    /// A Kronrod rule of 15 nodes is exact to degree 22 and its Gauss rule of 7 to degree 13: any wrong digit
    /// in a node or a weight shows.
    #[test]
    fn the_rules_are_exact_for_polynomials() {
        for degree in 0..=22 {
            let exact = if degree % 2 == 0 { 2.0 / f64::from(degree + 1) } else { 0.0 };
            let kronrod: f64 = (0..15).map(|k| kronrod_weight(k) * signed_node(k).powi(degree)).sum();
            assert!((kronrod - exact).abs() < 4e-16, "Kronrod, degree {degree}: {kronrod} is not {exact}");
            let gauss: f64 = (0..7).map(|k| gauss_weight(k) * signed_node(2 * k + 1).powi(degree)).sum();
            assert_eq!(
                (gauss - exact).abs() < 4e-16,
                degree <= 13 || degree % 2 == 1,
                "Gauss, degree {degree}"
            );
        }
    }

    #[test]
    fn kinks_poles_and_peaks_converge_within_the_estimate() {
        let kink = integrate(|x| [x.sqrt(), (x - 0.3).abs()], &[0.0, 1.0], 1e-12);
        assert!(kink.converged, "{kink:?}");
        assert!((kink.value[0] - 2.0 / 3.0).abs() < 1e-12, "{kink:?}");
        assert!((kink.value[1] - 0.29).abs() < 1e-12, "{kink:?}");

        let peak = integrate(|x| [1e-4 / (x * x + 1e-8), 0.0], &[-1.0, 2.0], 1e-11);
        let exact = 1e4_f64.atan() + 2e4_f64.atan();
        assert!(peak.converged && (peak.value[0] - exact).abs() < 1e-11, "{peak:?}, exact {exact}");
    }

    #[test]
    fn a_failure_is_reported() {
        let nothing = integrate(|_| [0.0; 2], &[], 1e-9);
        assert!(!nothing.converged, "{nothing:?}");
        let not_a_range = integrate(|_| [0.0; 2], &even_breaks(0.0, f64::NAN, 1.0), 1e-9);
        assert!(!not_a_range.converged, "{not_a_range:?}");
        let divergent = integrate(|x| [1.0, 1.0 / x], &[0.0, 1.0], 1e-9);
        assert!(!divergent.converged, "{divergent:?}");
        let not_finite = integrate(|_| [0.0, f64::NAN], &[0.0, 1.0], 1e-9);
        assert!(!not_finite.converged, "{not_finite:?}");
        assert!(not_finite.value_or_nan()[0].is_nan());
    }
}
