//! The picture of a BRDF at several settings.

use crate::base::error::Result;
use crate::figure::{Figure, Reflectance, SIDE, pixel};
use crate::io::draw::canvas::{Align, BLACK, Canvas, Color, GREY, PALE, Pixels, Rect, WHITE};
use crate::io::draw::colormap::viridis;
use crate::io::draw::labels;
use crate::io::draw::labels::Named;
use crate::io::draw::panel::{LABEL_SIZE, LEFT, TICK_SIZE, axis_labels, color_bar, ticks_below, ticks_left};
use crate::io::draw::polar;
use crate::io::draw::polar::{Dial, thinned};
use crate::io::draw::scale::{PlotScale, ScaleKind, short};
use std::f32::consts::PI;
use std::f64::consts::FRAC_PI_2;

/// Of different lightness too, so that they differ in print: Okabe & Ito 2008.
const CURVES: [Color; 5] = [[0, 72, 140], [213, 94, 0], [0, 158, 115], [190, 90, 150], [205, 135, 0]];
/// R, G and B of one coloured setting.
const RGB: [Color; 3] = [[204, 32, 32], [24, 140, 40], [32, 64, 208]];
/// More light than comes in.
const GAIN: Color = [214, 0, 90];

/// The most settings that a picture shows, and the most θi.
pub(crate) const MOST_SETTINGS: usize = CURVES.len();
pub(crate) const MOST_THETAS: usize = 3;

/// The pixels of a PNG to a unit: 2400 fill a page's width at 300 dpi.
const PNG_SCALE: usize = 2;
/// Images have as many pixels as a PNG shows of them.
const DISC: f32 = (SIDE / PNG_SCALE) as f32;
const TOP: f32 = 84.0;
const LABELS: f32 = 150.0;
const HEADING: f32 = 62.0;
const ROW: f32 = DISC + 16.0;

/// How the radius of the polar plot grows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Radius {
    /// Logarithmic where the lobes' peaks differ by more than a factor of eight.
    #[default]
    Auto,
    Linear,
    Log,
}

/// A picture's content.
pub(crate) struct Plate<'a> {
    pub title: &'a str,
    pub subtitle: &'a str,
    pub footer: &'a str,
    /// θi, rad.
    pub thetas: &'a [f64],
    pub figures: &'a [Figure],
    pub radius: Radius,
}

/// A finished picture.
pub(crate) struct Picture(Canvas);

impl Picture {
    /// The bytes of a PNG file.
    pub fn to_png(&self) -> Result<Vec<u8>> {
        self.0.to_png(PNG_SCALE)
    }

    /// The text of an SVG file.
    pub fn to_svg(&self) -> Result<String> {
        self.0.to_svg()
    }
}

/// Draws it.
pub(crate) fn draw(plate: &Plate) -> Result<Picture> {
    let columns = plate.thetas.len() + 1;
    let width = if columns > 3 { 1480.0 } else { 1200.0 };
    let panel = (width - 20.0) / columns as f32;
    let radius = ((panel - 84.0) / 2.0).min(235.0);
    let base = TOP + 64.0 + radius;
    let rows = base + 62.0;
    let notes = notes(plate);
    let height = rows + HEADING + ROW * plate.figures.len() as f32 + 34.0 + 20.0 * notes.len() as f32 + 30.0;

    let mut canvas = Canvas::new(width as usize, height as usize)?;
    let title = canvas.fit(plate.title, 24.0, width - 50.0);
    canvas.text(&title, (24.0, 28.0), 24.0, Align::Left, BLACK);
    let subtitle = canvas.fit(plate.subtitle, LABEL_SIZE, width - 50.0);
    canvas.text(&subtitle, (24.0, 58.0), LABEL_SIZE, Align::Left, GREY);

    lobes(&mut canvas, plate, panel, base, radius);
    let x = 10.0 + panel * plate.thetas.len() as f32;
    let right = if plate.figures.len() > 1 { 24.0 } else { 30.0 };
    let frame = Rect { x: x + LEFT, y: TOP + 36.0, w: panel - LEFT - right, h: base - TOP - 36.0 };
    furnace(&mut canvas, frame, plate);
    discs(&mut canvas, rows, width, plate);

    let mut y = height - 22.0 - 20.0 * notes.len() as f32;
    for note in &notes {
        canvas.text(note, (24.0, y), TICK_SIZE, Align::Left, BLACK);
        y += 20.0;
    }
    let footer = canvas.fit(plate.footer, TICK_SIZE, width - 50.0);
    canvas.text(&footer, (24.0, y), TICK_SIZE, Align::Left, GREY);
    Ok(Picture(canvas))
}

/// What the picture cannot show, in words, and of which settings.
fn notes(plate: &Plate) -> Vec<String> {
    let mut notes: Vec<(String, Vec<&str>)> = Vec::new();
    for Figure { label, values, has_delta, rho } in plate.figures {
        let mut note = |said: String| match notes.iter_mut().find(|(other, _)| *other == said) {
            Some((_, labels)) => labels.push(label),
            None => notes.push((said, vec![label])),
        };
        match values {
            None => note("a delta, which has no values: ρ_dh is all there is of it".into()),
            Some(_) if *has_delta => {
                note("it has a delta too, which is in ρ_dh and not among the values".into());
            }
            Some(_) => {}
        }
        if let Err(why) = rho {
            note(format!("ρ_dh has no bound ({why})"));
        }
    }
    let mut notes: Vec<_> =
        notes.into_iter().map(|(said, labels)| format!("{}: {said}", labels.join(", "))).collect();
    if plate.figures.len() > 1 && !plate.figures.iter().all(is_grey) {
        notes.push("Lines and maps are of the luminance of R, G and B (Rec. 709)".into());
    }
    notes
}

/// A line of the plots: its name, its colour, and what it is of R, G and B.
struct FigureCurve<'a> {
    name: &'a str,
    color: Color,
    figure: &'a Figure,
    of: fn([f64; 3]) -> f64,
}

/// Rec. ITU-R BT.709-6, item 3.2
fn luminance([r, g, b]: [f64; 3]) -> f64 {
    if r == g && g == b { r } else { 0.2126 * r + 0.7152 * g + 0.0722 * b }
}

fn is_grey(figure: &Figure) -> bool {
    let grey = |[r, g, b]: [f64; 3]| r == g && g == b;
    let lobes = figure.values.iter().flat_map(|values| &values.lobes);
    lobes.flat_map(|lobes| &lobes.plane).all(|&(_, f)| grey(f))
        && figure.rho.iter().flat_map(Reflectance::samples).all(|(_, rho)| grey(rho))
}

/// A curve a setting; of a single coloured one, each channel.
fn curves<'a>(plate: &Plate<'a>) -> Vec<FigureCurve<'a>> {
    let of: [fn([f64; 3]) -> f64; 3] = [|c| c[0], |c| c[1], |c| c[2]];
    match plate.figures {
        [figure] if !is_grey(figure) => {
            let channels = ["R", "G", "B"].into_iter().zip(RGB).zip(of);
            channels.map(|((name, color), of)| FigureCurve { name, color, figure, of }).collect()
        }
        all => {
            let curve = |(figure, color): (&'a Figure, Color)| {
                let name = figure.label.split_once(" = ").map_or(figure.label.as_str(), |(_, value)| value);
                FigureCurve { name, color, figure, of: luminance }
            };
            all.iter().zip(CURVES).map(curve).collect()
        }
    }
}

/// A polar plot for each θi, all with the same radius.
fn lobes(canvas: &mut Canvas, plate: &Plate, panel: f32, base: f32, radius: f32) {
    let curves = curves(plate);
    let plane = |curve: &FigureCurve, k: usize| -> Vec<(f64, f64)> {
        let lobes = curve.figure.values.as_ref().map(|values| &values.lobes[k].plane);
        lobes.into_iter().flatten().map(|&(theta, f)| (theta, (curve.of)(f))).collect()
    };
    let largest = |lobe: Vec<(f64, f64)>| {
        lobe.into_iter().map(|(_, value)| value).filter(|value| value.is_finite()).fold(0.0, f64::max)
    };
    let plane = &plane;
    let each = curves.iter().flat_map(|curve| (0..plate.thetas.len()).map(move |k| plane(curve, k)));
    let peaks: Vec<_> = each.map(largest).filter(|&peak| peak > 0.0).collect();
    let low = peaks.iter().copied().fold(f64::INFINITY, f64::min);
    let high = peaks.iter().copied().fold(0.0, f64::max);
    let log = plate.radius == Radius::Log || plate.radius == Radius::Auto && high > 8.0 * low;
    let scale = polar::radial(&peaks, log);
    for (k, &theta_i) in plate.thetas.iter().enumerate() {
        let dial = Dial { x: 10.0 + panel * (k as f32 + 0.5), base, radius };
        let heading = format!("in the plane of incidence, θi = {}°", degrees(theta_i));
        canvas.text(&heading, (dial.x, TOP + 12.0), LABEL_SIZE, Align::Center, BLACK);
        let label = if peaks.is_empty() { String::new() } else { polar::axis_label(&scale) };
        dial.draw(canvas, &scale, theta_i, &label);
        let shown = curves.iter().filter(|curve| curve.figure.values.is_some());
        dial.lobes(
            canvas,
            &scale,
            theta_i,
            &shown.map(|c| (c.name, c.color, plane(c, k))).collect::<Vec<_>>(),
        );
        let deltas = curves.iter().filter(|curve| curve.figure.values.is_none());
        let said = deltas.map(|curve| {
            let rho = curve.figure.rho.as_ref().map_or(f64::INFINITY, |rho| (curve.of)(rho.at(theta_i)));
            (format!("{}: a delta, ρ_dh({}°) = {rho:.4}", curve.name, degrees(theta_i)), curve.color)
        });
        dial.say(canvas, &said.collect::<Vec<_>>());
    }
}

/// ρ_dh over θ, and the white furnace.
fn furnace(canvas: &mut Canvas, frame: Rect, plate: &Plate) {
    let heading = "directional-hemispherical reflectance";
    canvas.text(heading, (frame.x + frame.w / 2.0, TOP + 12.0), LABEL_SIZE, Align::Center, BLACK);
    let curves = curves(plate);
    let line = |curve: &FigureCurve| -> Vec<(f64, f64)> {
        let rho = curve.figure.rho.iter().flat_map(Reflectance::samples);
        rho.map(|(theta, rho)| (theta, (curve.of)(rho))).collect()
    };
    let lines: Vec<_> = curves.iter().map(line).collect();
    let max = lines.iter().flatten().map(|&(_, rho)| rho).fold(1.0, f64::max);
    let (x, y) = (
        PlotScale { range: [0.0, FRAC_PI_2], kind: ScaleKind::Degrees },
        PlotScale { range: [0.0, 1.12 * max], kind: ScaleKind::Linear },
    );
    canvas.border(frame, GREY);
    ticks_below(canvas, frame, &x, true);
    ticks_left(canvas, frame, &y, true);
    axis_labels(canvas, frame, "θ [°]", "ρ_dh");
    let at = |(theta, rho): (f64, f64)| {
        (frame.x + frame.w * x.at(theta) as f32, frame.y + frame.h * (1.0 - y.at(rho) as f32))
    };
    let one = at((0.0, 1.0)).1;
    canvas.dashes((frame.x, one), (frame.x + frame.w, one), 1.5, BLACK);
    let (said, x) = ("1, a white furnace", frame.x + 8.0);
    canvas.text(said, (x, one - 9.0), TICK_SIZE, Align::Left, BLACK);
    let right = x + canvas.text_width(said, TICK_SIZE);
    let others = [[(frame.x, one), (frame.x + frame.w, one)], [(x, one - 9.0), (right, one - 9.0)]];

    let mut named = Vec::new();
    for (curve, line) in curves.iter().zip(lines) {
        let points = thinned(&line.into_iter().map(at).collect::<Vec<_>>());
        canvas.line(&points, 2.2, curve.color);
        named.push(Named { name: curve.name, color: curve.color, points });
    }
    if named.len() > 1 {
        labels::write(canvas, Rect { x: frame.x + 2.0, w: frame.w - 4.0, ..frame }, &named, &others, 0.45);
    }
    let unbounded = curves.iter().filter(|curve| curve.figure.rho.is_err());
    for (k, curve) in unbounded.enumerate() {
        let said = format!("{}: no bound", curve.name);
        let y = frame.y + 0.5 * frame.h + 20.0 * k as f32;
        canvas.text(&said, (frame.x + frame.w / 2.0, y), TICK_SIZE, Align::Center, curve.color);
    }
}

/// A row of discs for each setting: over the hemisphere for each θi, and the two spheres.
fn discs(canvas: &mut Canvas, top: f32, width: f32, plate: &Plate) {
    let columns = plate.thetas.len() + 2;
    let used = LABELS + columns as f32 * DISC + BAR_ROOM;
    let gap = ((width - 48.0 - used) / (columns as f32 - 0.5)).min(130.0);
    let column = |k: usize| {
        let bar = if k >= plate.thetas.len() { BAR_ROOM } else { 0.0 };
        24.0 + LABELS + bar + k as f32 * (DISC + gap)
    };
    let values = plate.figures.iter().filter_map(|figure| figure.values.as_ref());
    let has_values = values.clone().next().is_some();
    let scale = colors(values.flat_map(|values| &values.lobes).map(|lobes| &lobes.hemisphere[..]));
    let exposure = exposure(plate);

    let mut heading = |k: usize, lines: [&str; 2]| {
        for (line, y) in lines.into_iter().zip([top + 16.0, top + 36.0]) {
            canvas.text(line, (column(k) + 0.5 * DISC, y), TICK_SIZE, Align::Center, BLACK);
        }
    };
    let count = plate.thetas.len();
    for (k, &theta_i) in plate.thetas.iter().enumerate() {
        heading(k, [&format!("θi = {}°, over the hemisphere", degrees(theta_i)), "seen along n: f [sr⁻¹]"]);
    }
    let white = if exposure == 1.0 { "1".into() } else { format!("1/{exposure}") };
    heading(count, ["point light, 45° from the eye", &format!("white: π f cos θi = {white} and more")]);
    heading(count + 1, ["uniform light: ρ_dh(θe)", "white: 1, as the furnace behind it"]);

    for (row, (figure, color)) in plate.figures.iter().zip(CURVES).enumerate() {
        let y = top + HEADING + ROW * row as f32;
        if plate.figures.len() > 1 {
            label(canvas, (24.0, y + 0.5 * DISC), &figure.label, color);
        }
        let frame = |k: usize| Rect { x: column(k), y, w: DISC, h: DISC };
        for (k, &theta_i) in plate.thetas.iter().enumerate() {
            let title = format!("{}, θi = {}°: f over the hemisphere", figure.label, degrees(theta_i));
            match &figure.values {
                Some(values) => hemisphere(canvas, frame(k), &values.lobes[k].hemisphere, &scale, &title),
                None => empty(canvas, frame(k), ["a delta:", "no values"]),
            }
            marks(canvas, frame(k), theta_i, figure.values.is_some());
        }
        match &figure.values {
            Some(values) => lit(canvas, frame(count), &values.sphere, exposure, &figure.label),
            None => empty(canvas, frame(count), ["a delta:", "no values"]),
        }
        match &figure.rho {
            Ok(rho) => uniform(canvas, frame(count + 1), rho, &figure.label),
            Err(_) => empty(canvas, frame(count + 1), ["ρ_dh has", "no bound"]),
        }
    }
    if has_values {
        let x = column(count) - gap - BAR_ROOM + 14.0;
        color_bar(canvas, Rect { x, y: top + HEADING, w: 14.0, h: DISC }, &scale, "f [sr⁻¹]");
    }
    let y = top + HEADING + ROW * plate.figures.len() as f32 + 6.0;
    let mut x = column(0);
    ring(canvas, (x + 6.0, y), false);
    canvas.text("ωi", (x + 18.0, y), TICK_SIZE, Align::Left, BLACK);
    x += 56.0;
    cross(canvas, (x + 6.0, y), false);
    canvas.text("mirror direction", (x + 18.0, y), TICK_SIZE, Align::Left, BLACK);
}

/// The scale of f over all hemispheres: down to what 95 % of each exceed, over sixteen decades at most, so
/// that a narrow lobe leaves some of it to a wide one.
fn colors<'a>(hemispheres: impl Iterator<Item = &'a [[f32; 3]]>) -> PlotScale {
    let (mut all, mut low) = (Vec::new(), f64::INFINITY);
    for hemisphere in hemispheres {
        let f = hemisphere.iter().map(|f| luminance(f.map(f64::from)));
        let mut f: Vec<_> = f.filter(|f| f.is_finite()).collect();
        let place = f.len() / 20;
        if place > 0 {
            low = low.min(*f.select_nth_unstable_by(place, f64::total_cmp).1);
        }
        all.extend(f);
    }
    let mut scale = PlotScale::of_values(all.iter().copied(), true);
    if scale.kind == ScaleKind::Log {
        let high = scale.range[1];
        scale.range[0] = low.clamp(1e-16 * high, 0.1 * high);
    }
    scale
}

/// Room for the colour bar with its labels.
const BAR_ROOM: f32 = 116.0;

/// "roughness = 0.3" on two lines, beside its colour.
fn label(canvas: &mut Canvas, (x, y): (f32, f32), text: &str, color: Color) {
    let lines: Vec<_> = match text.split_once(" = ") {
        Some((key, value)) => vec![format!("{key} ="), value.to_owned()],
        None => vec![text.to_owned()],
    };
    let mut at = y - 10.0 * (lines.len() - 1) as f32;
    canvas.line(&[(x, y - 16.0), (x, y + 16.0)], 5.0, color);
    for line in &lines {
        let line = canvas.fit(line, LABEL_SIZE, LABELS - 26.0);
        canvas.text(&line, (x + 12.0, at), LABEL_SIZE, Align::Left, BLACK);
        at += 20.0;
    }
}

/// A circle with words in place of what is not there.
fn empty(canvas: &mut Canvas, frame: Rect, words: [&str; 2]) {
    let (x, y) = (frame.x + 0.5 * frame.w, frame.y + 0.5 * frame.h);
    canvas.arc((x, y), 0.5 * frame.w, [0.0, 2.0 * PI], 1.0, PALE);
    for (word, dy) in words.into_iter().zip([-24.0, -4.0]) {
        canvas.text(word, (x, y + dy), TICK_SIZE, Align::Center, GREY);
    }
}

fn hemisphere(canvas: &mut Canvas, frame: Rect, f: &[[f32; 3]], scale: &PlotScale, title: &str) {
    let color = |&f: &[f32; 3]| {
        let value = luminance(f.map(f64::from));
        if value.is_finite() { viridis(scale.at(value)) } else { WHITE }
    };
    disc(canvas, frame, f.iter().map(color).collect(), title);
}

fn lit(canvas: &mut Canvas, frame: Rect, samples: &[[f32; 3]], exposure: f32, label: &str) {
    let clipped = |f: [f32; 3]| f.map(|f| (f * exposure).clamp(0.0, 1.0));
    let color = |k: usize| match radius(k) {
        r if r <= 1.0 => pixel(samples, k / SIDE, k % SIDE, clipped).map(|x| srgb(f64::from(x))),
        _ => WHITE,
    };
    disc(
        canvas,
        frame,
        (0..SIDE * SIDE).map(color).collect(),
        &format!("{label}: a sphere under a point light"),
    );
}

/// Radiance under radiance 1 from everywhere: ρ_hd(θe), which is ρ_dh(θe) by reciprocity.
fn uniform(canvas: &mut Canvas, frame: Rect, rho: &Reflectance, label: &str) {
    let color = |k: usize| match radius(k) {
        r if r <= 1.0 => match rho.at(r.asin()) {
            rho if rho.iter().any(|&rho| rho > 1.002) => GAIN,
            rho => rho.map(srgb),
        },
        _ => WHITE,
    };
    disc(
        canvas,
        frame,
        (0..SIDE * SIDE).map(color).collect(),
        &format!("{label}: a sphere in uniform light"),
    );
}

/// Pixels, and the border of their disc.
fn disc(canvas: &mut Canvas, frame: Rect, colors: Vec<Color>, title: &str) {
    canvas.image(frame, Pixels { width: SIDE, colors }, title);
    let middle = (frame.x + 0.5 * frame.w, frame.y + 0.5 * frame.h);
    canvas.arc(middle, 0.5 * frame.w + 0.5, [0.0, 2.0 * PI], 1.2, [150; 3]);
}

/// The distance of a pixel's middle from that of the disc, whose border is at 1.
fn radius(k: usize) -> f64 {
    let middle = |k: usize| (2 * k + 1) as f64 / SIDE as f64 - 1.0;
    middle(k % SIDE).hypot(middle(k / SIDE))
}

/// ωi and the mirror direction on a hemisphere.
fn marks(canvas: &mut Canvas, frame: Rect, theta_i: f64, on_dark: bool) {
    let (x, y) = (frame.x + 0.5 * frame.w, frame.y + 0.5 * frame.h);
    let off = 0.5 * frame.w * theta_i.sin() as f32;
    ring(canvas, (x - off, y), on_dark);
    cross(canvas, (x + off, y), on_dark);
}

fn ring(canvas: &mut Canvas, at: (f32, f32), on_dark: bool) {
    if on_dark {
        canvas.arc(at, 5.0, [0.0, 2.0 * PI], 3.2, BLACK);
    }
    canvas.arc(at, 5.0, [0.0, 2.0 * PI], 1.6, if on_dark { WHITE } else { BLACK });
}

fn cross(canvas: &mut Canvas, (x, y): (f32, f32), on_dark: bool) {
    let both = [[(x - 5.0, y), (x + 5.0, y)], [(x, y - 5.0), (x, y + 5.0)]];
    if on_dark {
        both.iter().for_each(|line| canvas.line(line, 3.2, BLACK));
    }
    both.iter().for_each(|line| canvas.line(line, 1.6, if on_dark { WHITE } else { BLACK }));
}

/// A power of two, 1 to 64, by which the brightest of the spheres, but for its brightest pixels, is below
/// white.
fn exposure(plate: &Plate) -> f32 {
    let values = plate.figures.iter().filter_map(|figure| figure.values.as_ref());
    let bright = values.filter_map(|values| {
        let mut lit: Vec<f32> =
            values.sphere.iter().map(|f| f[0].max(f[1]).max(f[2])).filter(|&f| f > 0.0).collect();
        let place = (lit.len() * 97 / 100).min(lit.len().checked_sub(1)?);
        Some(*lit.select_nth_unstable_by(place, f32::total_cmp).1)
    });
    let brightest = bright.fold(0.0, f32::max);
    if brightest > 0.0 { (1.02 / brightest).log2().floor().clamp(0.0, 6.0).exp2() } else { 1.0 }
}

/// IEC 61966-2-1, of linear light.
fn srgb(linear: f64) -> u8 {
    let x = linear.clamp(0.0, 1.0);
    let encoded = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
    (255.0 * encoded).round() as u8
}

fn degrees(theta: f64) -> String {
    short((theta.to_degrees() * 1e6).round() * 1e-6)
}
