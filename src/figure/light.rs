//! The picture of a light: the light, its irradiance, and lit spheres, all at one exposure.

use crate::base::error::Result;
use crate::io::draw::canvas::{Align, BLACK, Canvas, Color, GREY, Pixels, Rect, WHITE};
use crate::io::draw::panel::LABEL_SIZE;

/// A picture's content; colours are linear, 1 is white before it is bent.
pub(crate) struct Sheet {
    pub title: String,
    pub subtitle: String,
    /// Columns, and pixels row by row.
    pub radiance: (usize, Vec<[f64; 3]>),
    pub irradiance: (usize, Vec<[f64; 3]>),
    pub balls: Vec<Ball>,
}

/// A lit sphere; NaN beyond it.
pub(crate) struct Ball {
    pub label: String,
    pub side: usize,
    pub pixels: Vec<[f64; 3]>,
}

const MAP: [f32; 2] = [640.0, 320.0];
const TOP: f32 = 76.0;
const LEFT: f32 = 24.0;
const BALL: usize = 240;

/// The bytes of a PNG file.
pub(crate) fn draw(sheet: &Sheet) -> Result<Vec<u8>> {
    let width = 2.0 * MAP[0] + 3.0 * LEFT;
    let below = TOP + MAP[1] + 44.0;
    let height = if sheet.balls.is_empty() { below + 8.0 } else { below + BALL as f32 + 52.0 };
    let mut canvas = Canvas::new(width as usize, height as usize)?;
    let title = canvas.fit(&sheet.title, 24.0, width - 50.0);
    canvas.text(&title, (LEFT, 26.0), 24.0, Align::Left, BLACK);
    let subtitle = format!("{}; one exposure for all, 1 − exp(−L), sRGB", sheet.subtitle);
    canvas.text(&subtitle, (LEFT, 54.0), LABEL_SIZE, Align::Left, GREY);
    let maps = [(&sheet.radiance, "radiance L"), (&sheet.irradiance, "irradiance E/π over normals")];
    for (k, ((columns, values), label)) in maps.into_iter().enumerate() {
        let frame = Rect { x: LEFT + k as f32 * (MAP[0] + LEFT), y: TOP, w: MAP[0], h: MAP[1] };
        let pixels = Pixels { width: *columns, colors: values.iter().map(color).collect() };
        canvas.image(frame, pixels, label);
        canvas.border(frame, GREY);
        let at = (frame.x + 0.5 * MAP[0], TOP + MAP[1] + 18.0);
        canvas.text(label, at, LABEL_SIZE, Align::Center, BLACK);
    }
    for (k, ball) in sheet.balls.iter().enumerate() {
        let side = BALL as f32;
        let frame = Rect { x: LEFT + k as f32 * (side + 22.0), y: below + 4.0, w: side, h: side };
        canvas.image(frame, enlarged(ball), &ball.label);
        let label = canvas.fit(&ball.label, LABEL_SIZE, side + 16.0);
        canvas.text(&label, (frame.x + 0.5 * side, frame.y + side + 18.0), LABEL_SIZE, Align::Center, BLACK);
    }
    canvas.to_png(1)
}

/// A sphere with smooth pixels and a round edge: between its samples it is interpolated.
fn enlarged(ball: &Ball) -> Pixels {
    let n = ball.side as f64;
    let sample = |row: usize, column: usize| ball.pixels[row * ball.side + column];
    let colors = (0..BALL * BALL).map(|k| {
        let unit = |k: usize| (2 * k + 1) as f64 / BALL as f64 - 1.0;
        let (x, y) = (unit(k % BALL), unit(k / BALL));
        if x * x + y * y > 1.0 {
            return WHITE;
        }
        let place = |u: f64| (0.5 * (u + 1.0) * n - 0.5).clamp(0.0, n - 1.0);
        let (column, row) = (place(x), place(y));
        let (mut sum, mut weights) = ([0.0; 3], 0.0);
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let (r, c) = ((row as usize + i).min(ball.side - 1), (column as usize + j).min(ball.side - 1));
            let value = sample(r, c);
            // What is beyond the edge is no sample.
            if value[0].is_nan() {
                continue;
            }
            let near = |at: f64, k: usize| (1.0 - (at - k as f64).abs()).max(1e-3);
            let weight = near(row, r) * near(column, c);
            sum = std::array::from_fn(|k| sum[k] + weight * value[k]);
            weights += weight;
        }
        if weights > 0.0 { color(&sum.map(|x| x / weights)) } else { WHITE }
    });
    Pixels { width: BALL, colors: colors.collect() }
}

/// 1 − e^{−x}, so that what is bright is still a colour, and IEC 61966-2-1 (sRGB).
fn color(linear: &[f64; 3]) -> Color {
    linear.map(|x| {
        let bent = 1.0 - (-x.max(0.0)).exp();
        let encoded = if bent <= 0.003_130_8 { 12.92 * bent } else { 1.055 * bent.powf(1.0 / 2.4) - 0.055 };
        (255.0 * encoded).round() as u8
    })
}
