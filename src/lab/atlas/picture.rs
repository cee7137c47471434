//! The pictures of the error atlas: error against α and over the hemispheres; and the study's forms.

use crate::base::angles::Angles;
use crate::base::error::Result;
use crate::io::draw::canvas::{Align, BLACK, Canvas, Color, GREY, Pixels, Rect};
use crate::io::draw::colormap::viridis;
use crate::io::draw::panel::{BELOW, LABEL_SIZE, LEFT, axis_labels, color_bar, ticks_below, ticks_left};
use crate::io::draw::scale::{PlotScale, ScaleKind, short};
use crate::lab::atlas::{Band, DECADES, ErrorMap, Page};
use std::f64::consts::FRAC_PI_2;

/// Of different lightness too, so that they differ in print: Okabe & Ito 2008.
const MAX: Color = [213, 94, 0];
const MEDIAN: Color = [0, 114, 178];
const PROMISE: Color = [16; 3];
/// Of the study's forms, in their order: colours, and widths that let those below be seen where lines coincide.
const FORMS: [(Color, f32); 9] = [
    ([204, 121, 167], 2.5),
    ([86, 180, 233], 13.0),
    ([230, 159, 0], 9.5),
    ([0, 0, 0], 2.0),
    ([0, 158, 115], 5.5),
    ([0, 72, 140], 6.0),
    ([240, 228, 66], 2.5),
    ([190; 3], 10.0),
    ([213, 94, 0], 3.0),
];
/// Half the spacing of f32 at 1: what the rounding of the result alone may cost.
const HALF_ULP: f64 = 1.0 / (1 << 24) as f64;
const TOP: f32 = 92.0;

/// A model's page, as a PNG file: error by α, where there is one and by θi where not; and over (θi, θe).
pub(crate) fn draw_page(page: &Page) -> Result<Vec<u8>> {
    let mut canvas = Canvas::new(1180, 590)?;
    let (w, h) = (430.0, 590.0 - TOP - BELOW - 10.0);
    let left = Rect { x: LEFT + 10.0, y: TOP, w, h };
    let right = Rect { x: left.x + w + 112.0, y: TOP, w: h, h };
    let title = format!("{}: f32 on the device against f64", page.subject);
    canvas.text(&title, (30.0, 26.0), 22.0, Align::Left, BLACK);
    let worst = canvas.fit(&in_words(page), LABEL_SIZE, 1120.0);
    canvas.text(&worst, (30.0, 54.0), LABEL_SIZE, Align::Left, GREY);

    if page.alphas.is_empty() {
        if let Some(map) = &page.map {
            by_theta(&mut canvas, left, map, page.decades.first().and_then(|band| band.promise));
        }
    } else {
        by_alpha(&mut canvas, left, &page.alphas);
    }
    if let Some(map) = &page.map {
        hemispheres(&mut canvas, right, map);
    }
    canvas.to_png(1)
}

/// The largest error and where it is.
fn in_words(page: &Page) -> String {
    let Some((band, worst)) = page.worst().and_then(|band| Some((band, band.worst.as_ref()?))) else {
        return "no values".into();
    };
    let values: u64 = page.decades.iter().map(|band| band.values).sum();
    let Angles { theta_i, theta_e, .. } = worst.angles;
    // Less than an azimuth's last digit.
    let delta = Some(worst.angles.delta_phi()).filter(|d| d.abs() > 1e-15).unwrap_or(0.0);
    let alpha = band.alpha.map_or(String::new(), |_| format!("α = {}, ", short(worst.alpha)));
    format!(
        "largest of {values} errors: {:.2e} = {:.1} ULP, at {alpha}θi = {}°, θe = {}°, δφ = {}°",
        band.max,
        band.max_ulp,
        short(theta_i.to_degrees()),
        short(theta_e.to_degrees()),
        short(delta.to_degrees())
    )
}

type Line = (&'static str, Color, Vec<(f64, f64)>);

fn by_alpha(canvas: &mut Canvas, frame: Rect, bands: &[Band]) {
    let alpha_of = |band: &Band| band.alpha.map_or(1.0, |[low, _]| low);
    let points = |value: fn(&Band) -> Option<f64>| -> Vec<_> {
        bands.iter().filter_map(|band| Some((alpha_of(band), value(band)?))).collect()
    };
    // A step has two points where it is.
    let mut promised: Vec<(f64, f64)> = Vec::new();
    for (alpha, promise) in points(|band| band.promise) {
        promised.extend(promised.last().map(|&(_, before)| (alpha, before)));
        promised.push((alpha, promise));
    }
    let lines = [
        ("promise", PROMISE, promised),
        ("largest", MAX, points(|band| Some(band.max))),
        ("median", MEDIAN, points(|band| Some(band.median))),
    ];
    let x = PlotScale { range: [DECADES[0], 1.0], kind: ScaleKind::Log };
    plot(canvas, frame, &x, &lines, "α");
}

fn by_theta(canvas: &mut Canvas, frame: Rect, map: &ErrorMap, promise: Option<f64>) {
    let rows = |rows: &[Vec<f64>], of: fn(&[f64]) -> f64| -> Vec<_> {
        map.thetas.iter().zip(rows).map(|(&theta, row)| (theta, of(row))).collect()
    };
    let promised = promise.map_or(Vec::new(), |p| vec![(0.0, p), (FRAC_PI_2, p)]);
    let middle = |row: &[f64]| {
        let mut row = row.to_vec();
        row.sort_by(f64::total_cmp);
        row[row.len() / 2]
    };
    let lines = [
        ("promise", PROMISE, promised),
        ("largest", MAX, rows(&map.errors, |row| row.iter().copied().fold(0.0, f64::max))),
        ("median", MEDIAN, rows(&map.medians, middle)),
    ];
    plot(canvas, frame, &PlotScale { range: [0.0, FRAC_PI_2], kind: ScaleKind::Degrees }, &lines, "θi [°]");
}

/// Lines of relative errors, with their names at their right ends, and half a unit in the last place.
fn plot(canvas: &mut Canvas, frame: Rect, x: &PlotScale, lines: &[Line], below: &str) {
    let largest = lines.iter().flat_map(|(.., points)| points).map(|&(_, error)| error).fold(1e-5, f64::max);
    let y = PlotScale { range: [5e-9, 2.0 * largest], kind: ScaleKind::Log };
    let at = |(u, v): (f64, f64)| {
        let up = y.at(v).clamp(0.0, 1.0) as f32;
        (frame.x + frame.w * x.at(u) as f32, frame.y + frame.h * (1.0 - up))
    };
    canvas.border(frame, GREY);
    ticks_below(canvas, frame, x, true);
    ticks_left(canvas, frame, &y, true);
    axis_labels(canvas, frame, below, "relative error");
    let half = at((x.range[0], HALF_ULP)).1;
    for k in (0..frame.w as usize).step_by(8) {
        canvas.fill(Rect { x: frame.x + k as f32, y: half, w: 4.0, h: 1.0 }, GREY);
    }
    canvas.text("2⁻²⁴", (frame.x + 8.0, half - 11.0), LABEL_SIZE, Align::Left, GREY);
    let mut names = Vec::new();
    for (name, color, points) in lines {
        let points: Vec<_> = points.iter().map(|&point| at(point)).collect();
        canvas.line(&points, 2.5, *color);
        // Below what is near its end; the promise stands above.
        let near = points.iter().filter(|point| point.0 > frame.x + 0.8 * frame.w);
        let Some(lowest) = near.map(|point| point.1).reduce(f32::max) else { continue };
        let mut y = if *name == "promise" { lowest - 14.0 } else { lowest + 16.0 };
        if names.iter().any(|other: &f32| (other - y).abs() < 18.0) {
            y += 18.0;
        }
        names.push(y);
        canvas.text(name, (frame.x + frame.w - 10.0, y), LABEL_SIZE, Align::Right, *color);
    }
}

fn hemispheres(canvas: &mut Canvas, frame: Rect, map: &ErrorMap) {
    let max = map.errors.iter().flatten().copied().filter(|e| e.is_finite()).fold(0.0, f64::max);
    let scale = PlotScale { range: [0.0, if max > 0.0 { 1e6 * max } else { 1.0 }], kind: ScaleKind::Linear };
    let count = map.thetas.len();
    let cell = |u: f32| ((u * (count - 1) as f32).round() as usize).min(count - 1);
    let (width, height) = (frame.w as usize, frame.h as usize);
    let color = |k: usize| {
        let (px, py) = ((k % width) as f32, (k / width) as f32);
        let error = map.errors[cell(px / frame.w)][cell(1.0 - py / frame.h)];
        if error.is_finite() { viridis(scale.at(1e6 * error)) } else { [255, 0, 0] }
    };
    let pixels = Pixels { width, colors: (0..width * height).map(color).collect() };
    canvas.image(frame, pixels, "largest error over θi and θe");
    canvas.border(frame, GREY);
    let degrees = PlotScale { range: [0.0, FRAC_PI_2], kind: ScaleKind::Degrees };
    ticks_below(canvas, frame, &degrees, false);
    ticks_left(canvas, frame, &degrees, false);
    axis_labels(canvas, frame, "θi [°]", "θe [°]");
    let heading = map.alpha.map_or("largest error over δφ".into(), |alpha| {
        format!("largest error over δφ, at the worst α = {}", short(alpha))
    });
    canvas.text(&heading, (frame.x + frame.w / 2.0, frame.y - 16.0), LABEL_SIZE, Align::Center, BLACK);
    let bar = Rect { x: frame.x + frame.w + 18.0, w: 16.0, ..frame };
    color_bar(canvas, bar, &scale, "relative error × 10⁶");
}

/// A name, and what it is of a band.
type PictureColumn = (&'static str, fn(&Band) -> f64);

/// The study, as a PNG file: median and largest error of each form by decade of α.
pub(crate) fn draw_study(forms: &[Page]) -> Result<Vec<u8>> {
    let mut canvas = Canvas::new(1180, 640)?;
    canvas.text(
        "What a GGX highlight loses in f32, by the form of D",
        (30.0, 26.0),
        22.0,
        Align::Left,
        BLACK,
    );
    let said = "D·V against f64, over pairs within the lobe (99 % of its normals), θ ≤ 89.9°. Upper border: 10 and more, or not finite. Thick lines lie below thin ones";
    canvas.text(said, (30.0, 54.0), LABEL_SIZE, Align::Left, GREY);
    let (w, h) = (365.0, 640.0 - TOP - BELOW - 10.0);
    let values: [PictureColumn; 2] = [("median", |band| band.median), ("largest", |band| band.max)];
    let (x, y) = (
        PlotScale { range: [DECADES[0], 1.0], kind: ScaleKind::Log },
        PlotScale { range: [1e-8, 10.0], kind: ScaleKind::Log },
    );
    for (k, (name, value)) in values.into_iter().enumerate() {
        let frame = Rect { x: LEFT + 10.0 + k as f32 * (w + 92.0), y: TOP, w, h };
        canvas.border(frame, GREY);
        ticks_below(&mut canvas, frame, &x, true);
        ticks_left(&mut canvas, frame, &y, true);
        axis_labels(&mut canvas, frame, "α", &format!("{name} relative error"));
        let mut lines: Vec<_> = forms.iter().zip(FORMS).collect();
        lines.sort_by(|a, b| b.1.1.total_cmp(&a.1.1));
        for (form, (color, width)) in lines {
            let at = |band: &Band| {
                let u = x.at(band.alpha.map_or(1.0, |[low, _]| low)) as f32;
                let v = y.at(value(band)).clamp(0.0, 1.0) as f32;
                (frame.x + w * u, frame.y + h * (1.0 - v))
            };
            canvas.line(&form.alphas.iter().map(at).collect::<Vec<_>>(), width, color);
        }
    }
    let (x, mut y) = (LEFT + 10.0 + 2.0 * (w + 92.0) - 66.0, TOP + 14.0);
    for (form, (color, width)) in forms.iter().zip(FORMS) {
        canvas.line(&[(x, y), (x + 22.0, y)], width, color);
        canvas.text(&form.subject, (x + 30.0, y), LABEL_SIZE, Align::Left, BLACK);
        y += 28.0;
    }
    canvas.to_png(1)
}
