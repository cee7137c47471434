//! Scales: from values to positions in [0, 1], and the ticks between.

use crate::table::axis::{Axis, Variable};

/// How values spread over a picture's axis or a colour bar.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlotScale {
    /// The values at 0 and 1.
    pub range: [f64; 2],
    pub kind: ScaleKind,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ScaleKind {
    Linear,
    /// Linear in radians, with ticks in degrees.
    Degrees,
    Log,
}

/// Decades that a logarithmic scale shows below the maximum.
pub(crate) const DECADES: i32 = 7;

impl PlotScale {
    /// The scale of an axis of a table: its range, or some room around a single point.
    pub fn of_axis(axis: &Axis) -> Self {
        let kind = if axis.variable().unit() == "rad" { ScaleKind::Degrees } else { ScaleKind::Linear };
        let [a, b] = axis.range();
        Self { range: if a < b { [a, b] } else { [a - 0.5, b + 0.5] }, kind }
    }

    /// A scale that holds the values: logarithmic if allowed, none is negative and they span more than a decade.
    pub fn of_values(values: impl Iterator<Item = f64> + Clone, log: bool) -> Self {
        let finite = values.filter(|v| v.is_finite());
        let max = finite.clone().fold(f64::NEG_INFINITY, f64::max);
        let min = finite.clone().fold(f64::INFINITY, f64::min);
        if min > max {
            return Self { range: [0.0, 1.0], kind: ScaleKind::Linear }; // nothing to show
        }
        let least = finite.filter(|&v| v > 0.0).fold(max, f64::min);
        if log && min >= 0.0 && max > 10.0 * least {
            let range = [least.max(max * 10f64.powi(-DECADES)), max];
            return Self { range, kind: ScaleKind::Log };
        }
        // Rounding noise on a constant is not a picture.
        let spread = max - min;
        let range = match max.abs().max(min.abs()) {
            0.0 => [0.0, 1.0],
            size if spread < 1e-5 * size => [min - 0.5 * size, max + 0.5 * size],
            _ => [min, max],
        };
        Self { range, kind: ScaleKind::Linear }
    }

    /// A scale widened by a little, so that lines do not lie on the border.
    pub fn with_margin(self) -> Self {
        let [a, b] = self.range;
        if self.kind == ScaleKind::Log {
            return Self { range: [a / 1.3, b * 1.3], ..self };
        }
        let margin = 0.05 * (b - a);
        // Reflectances do not go below 0: nor does their axis.
        let low = if a >= 0.0 { (a - margin).max(0.0) } else { a - margin };
        Self { range: [low, b + margin], ..self }
    }

    /// Where a value lies; outside [0, 1] if it is beyond the range.
    pub fn at(&self, value: f64) -> f64 {
        let [a, b] = self.range;
        match self.kind {
            ScaleKind::Log => (value.max(f64::MIN_POSITIVE).log10() - a.log10()) / (b.log10() - a.log10()),
            ScaleKind::Linear | ScaleKind::Degrees => (value - a) / (b - a),
        }
    }

    /// At most about `most` ticks: values and their labels.
    pub fn ticks(&self, most: usize) -> Vec<(f64, String)> {
        let [a, b] = self.range;
        let most = most.max(2) as f64;
        match self.kind {
            ScaleKind::Linear => {
                let step = nice_step((b - a) / most);
                multiples(a, b, step).map(|value| (value, number(value, step))).collect()
            }
            ScaleKind::Degrees => {
                let (a, b) = (a.to_degrees(), b.to_degrees());
                let steps = [1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0];
                let wide = steps.into_iter().find(|step| (b - a) / step <= most).unwrap_or(180.0);
                let step = if b - a < 2.0 { nice_step((b - a) / most) } else { wide };
                multiples(a, b, step).map(|value| (value.to_radians(), number(value, step))).collect()
            }
            ScaleKind::Log => {
                let (low, high) = ((a.log10() - 1e-6).ceil() as i32, (b.log10() + 1e-6).floor() as i32);
                if high - low < 2 {
                    let within = |value: &f64| (a..=b).contains(value);
                    let all = (low - 1..=high).flat_map(|n| [1.0, 2.0, 5.0].map(|k| k * 10f64.powi(n)));
                    return all.filter(within).map(|value| (value, short(value))).collect();
                }
                let step = ((f64::from(high - low) / most).ceil() as usize).max(1);
                (low..=high).step_by(step).map(|n| (10f64.powi(n), power_of_ten(n))).collect()
            }
        }
    }
}

/// One value of a variable, in words: "θi = 30°".
pub(crate) fn in_words(variable: Variable, value: f64) -> String {
    let symbol = variable.symbol().split(" =").next().unwrap_or_default();
    if variable.unit() == "rad" {
        format!("{symbol} = {}°", short(value.to_degrees()))
    } else {
        format!("{symbol} = {}", short(value))
    }
}

/// A variable with the unit of its ticks: "θi [°]".
pub(crate) fn label(variable: Variable) -> String {
    let symbol = variable.symbol();
    if variable.unit() == "rad" { format!("{symbol} [°]") } else { symbol.into() }
}

/// About four digits.
pub(crate) fn short(value: f64) -> String {
    let size = value.abs();
    if value != 0.0 && !(1e-3..1e5).contains(&size) {
        return format!("{value:.2e}");
    }
    let digits = if size >= 100.0 {
        1
    } else if size >= 1.0 {
        2
    } else {
        4
    };
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
}

/// 1, 2 or 5 times a power of ten, at least `step`.
fn nice_step(step: f64) -> f64 {
    let power = 10f64.powf(step.max(f64::MIN_POSITIVE).log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|k| k * power).find(|&nice| nice >= step * 0.999).unwrap_or(step)
}

/// The multiples of `step` within [a, b], by a hair more.
fn multiples(a: f64, b: f64, step: f64) -> impl Iterator<Item = f64> {
    let first = (a / step - 1e-6).ceil();
    let count = ((b / step + 1e-6).floor() - first).clamp(0.0, 100.0) as usize;
    (0..=count).map(move |k| (first + k as f64) * step)
}

/// A tick's label, with as many digits as its step needs.
fn number(value: f64, step: f64) -> String {
    let value = if value.abs() < step * 1e-6 { 0.0 } else { value };
    let digits = (-step.log10().floor()).max(0.0) as usize;
    if value != 0.0 && (value.abs() >= 1e5 || digits > 5) {
        return format!("{value:.1e}");
    }
    format!("{value:.digits$}")
}

/// "10⁻³".
pub(crate) fn power_of_ten(n: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let text = n.to_string();
    let raised = text.chars().filter_map(|c| match c.to_digit(10) {
        Some(digit) => DIGITS.get(digit as usize).copied(),
        None => Some('⁻'),
    });
    format!("10{}", raised.collect::<String>())
}
