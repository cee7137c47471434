//! Lobes in the plane of incidence: f cos θe as a radius over θe.

use crate::io::draw::canvas::{Align, BLACK, Canvas, Color, GREY, PALE, Rect};
use crate::io::draw::labels;
use crate::io::draw::labels::Named;
use crate::io::draw::panel::{LABEL_SIZE, TICK_SIZE};
use crate::io::draw::scale::{PlotScale, ScaleKind, power_of_ten};
use std::f32::consts::PI;

/// A half disc: its middle and its radius.
#[derive(Clone, Copy)]
pub(crate) struct Dial {
    pub x: f32,
    pub base: f32,
    pub radius: f32,
}

/// A lobe: its name, its colour, and (θe, f cos θe).
pub(crate) type PolarLobe<'a> = (&'a str, Color, Vec<(f64, f64)>);

/// The radius of values: from 0, or logarithmic.
pub(crate) fn radial(peaks: &[f64], log: bool) -> PlotScale {
    let max = peaks.iter().copied().fold(0.0, f64::max);
    if max <= 0.0 {
        return PlotScale { range: [0.0, 1.0], kind: ScaleKind::Linear };
    }
    if !log {
        return PlotScale { range: [0.0, 1.06 * max], kind: ScaleKind::Linear };
    }
    // The lowest peak has a decade or two below it to show its shape.
    let least = peaks.iter().copied().filter(|&peak| peak > 0.0).fold(max, f64::min);
    let low = least.max(1e-14 * max).log10() - 1.0;
    PlotScale { range: [10f64.powf(low.floor()), 1.5 * max], kind: ScaleKind::Log }
}

impl Dial {
    /// Where θe and a radius in [0, 1] are; θe < 0 to the left.
    fn at(&self, theta: f64, r: f32) -> (f32, f32) {
        let (sin, cos) = (theta as f32).sin_cos();
        (self.x + self.radius * r * sin, self.base - self.radius * r * cos)
    }

    /// Rings, angles, ωi and the mirror direction of θi.
    pub fn draw(&self, canvas: &mut Canvas, scale: &PlotScale, theta_i: f64, label: &str) {
        let Self { x, base, radius } = *self;
        for degrees in (-90i32..=90).step_by(30) {
            let theta = f64::from(degrees).to_radians();
            canvas.line(&[(x, base), self.at(theta, 1.0)], 1.0, PALE);
            // ωi and its mirror direction have their own names there.
            if (theta.abs() - theta_i).abs() > 0.16 {
                self.outside(canvas, theta, &format!("{}°", degrees.abs()), TICK_SIZE, GREY);
            }
        }
        let mut last = f32::NEG_INFINITY;
        // Without a lobe there is nothing to measure.
        let ticks = if label.is_empty() { Vec::new() } else { scale.ticks((radius / 46.0) as usize) };
        for (value, text) in ticks {
            let r = scale.at(value) as f32;
            if r > 1.0 {
                continue;
            }
            if r > 0.01 {
                canvas.arc((x, base), radius * r, [0.0, PI], 1.0, PALE);
            }
            // Where tick labels would touch, one is left away.
            if radius * r - last > canvas.text_width(&text, TICK_SIZE) + 8.0 {
                canvas.fill(Rect { x: x + radius * r, y: base, w: 1.0, h: 5.0 }, GREY);
                canvas.text(&text, (x + radius * r, base + 15.0), TICK_SIZE, Align::Center, BLACK);
                last = radius * r;
            }
        }
        canvas.arc((x, base), radius, [0.0, PI], 1.0, GREY);
        canvas.line(&[(x - radius, base), (x + radius, base)], 1.0, GREY);
        canvas.text(label, (x, base + 38.0), LABEL_SIZE, Align::Center, BLACK);

        let (wi, mirror) = (self.at(-theta_i, 1.0), self.at(theta_i, 1.0));
        canvas.dashes((x, base), mirror, 1.2, GREY);
        canvas.line(&[wi, (x, base)], 1.6, BLACK);
        // Light comes in; beyond most lobes, so that none hides the head.
        let head = self.at(-theta_i, 0.6);
        for side in [-0.35, 0.35] {
            let (sin, cos) = (-theta_i as f32 + side).sin_cos();
            canvas.line(&[head, (head.0 + 13.0 * sin, head.1 - 13.0 * cos)], 1.6, BLACK);
        }
        if theta_i < 0.16 {
            self.outside(canvas, 0.0, "ωi, mirror", LABEL_SIZE, BLACK);
        } else {
            self.outside(canvas, -theta_i, "ωi", LABEL_SIZE, BLACK);
            self.outside(canvas, theta_i, "mirror", LABEL_SIZE, BLACK);
        }
    }

    /// A text beyond the rim.
    fn outside(&self, canvas: &mut Canvas, theta: f64, text: &str, size: f32, color: Color) {
        let (x, y) = self.at(theta, 1.0 + 12.0 / self.radius);
        let align = match theta {
            t if t < -0.1 => Align::Right,
            t if t > 0.1 => Align::Left,
            _ => Align::Center,
        };
        canvas.text(text, (x, y - if theta.abs() < 0.1 { 4.0 } else { 0.0 }), size, align, color);
    }

    /// The lobes, with their names if there are several.
    pub fn lobes(&self, canvas: &mut Canvas, scale: &PlotScale, theta_i: f64, lobes: &[PolarLobe]) {
        let mut lines = Vec::new();
        for (name, color, lobe) in lobes {
            let points = lobe.iter().filter(|(_, value)| value.is_finite());
            let points: Vec<_> = points
                .map(|&(theta, value)| self.at(theta, scale.at(value).clamp(0.0, 1.0) as f32))
                .collect();
            let points = thinned(&points);
            canvas.line(&points, 2.2, *color);
            // A name stands at what is seen of its lobe.
            let far = |&(x, y): &(f32, f32)| (x - self.x).hypot(y - self.base) > 0.12 * self.radius;
            lines.push(Named { name, color: *color, points: points.into_iter().filter(far).collect() });
        }
        if lines.len() > 1 {
            let Self { x, base, radius } = *self;
            let frame = Rect { x: x - radius, y: base - radius, w: 2.0 * radius, h: radius - 4.0 };
            let [wi, mirror] = [-theta_i, theta_i].map(|theta| self.at(theta, 1.0));
            // The rays, and the name of the mirror direction beyond the rim.
            let name = [(mirror.0, mirror.1 - 8.0), (mirror.0 + 50.0, mirror.1 - 8.0)];
            labels::write(canvas, frame, &lines, &[[(x, base), wi], [(x, base), mirror], name], 0.5);
        }
    }

    /// Lines of text where the lobes would be.
    pub fn say(&self, canvas: &mut Canvas, said: &[(String, Color)]) {
        for (k, (text, color)) in said.iter().enumerate() {
            let y = self.base - 0.72 * self.radius + 20.0 * (k as f32 - 0.5 * said.len() as f32);
            let width = canvas.text_width(text, TICK_SIZE);
            // Rings and rays stay behind it.
            let paper = Rect { x: self.x - 0.5 * width - 4.0, y: y - 10.0, w: width + 8.0, h: 20.0 };
            canvas.fill(paper, [255; 3]);
            canvas.text(text, (self.x, y), TICK_SIZE, Align::Center, *color);
        }
    }
}

/// Without points that are no more than a fifth of a unit from the last.
pub(crate) fn thinned(points: &[(f32, f32)]) -> Vec<(f32, f32)> {
    let mut kept: Vec<(f32, f32)> = Vec::new();
    for (k, &(x, y)) in points.iter().enumerate() {
        let near = kept.last().is_some_and(|&(px, py)| (x - px).hypot(y - py) < 0.2);
        if !near || k + 1 == points.len() {
            kept.push((x, y));
        }
    }
    kept
}

/// "f cos θe [sr⁻¹], logarithmic from 10⁻³".
pub(crate) fn axis_label(scale: &PlotScale) -> String {
    match scale.kind {
        ScaleKind::Log => {
            let from = power_of_ten(scale.range[0].log10().round() as i32);
            format!("f cos θe [sr⁻¹], logarithmic from {from}")
        }
        _ => "f cos θe [sr⁻¹], linear".into(),
    }
}
