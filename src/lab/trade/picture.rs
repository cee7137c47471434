//! The picture of a trade-off: error against time, both logarithmic, one line a method.

use crate::base::error::Result;
use crate::io::draw::canvas::{Align, BLACK, Canvas, Color, GREY, Rect};
use crate::io::draw::panel::{BELOW, LABEL_SIZE, LEFT, axis_labels, ticks_below, ticks_left};
use crate::io::draw::scale::{PlotScale, ScaleKind};
use crate::lab::trade::{Point, Trade};

/// Of different lightness too, so that they differ in print: Okabe & Ito 2008.
const METHODS: [(&str, Color); 6] = [
    ("warped", [213, 94, 0]),
    ("gauss", [0, 158, 115]),
    ("grid", [230, 159, 0]),
    ("hammersley", [86, 180, 233]),
    ("vndf", [0, 72, 140]),
    ("random", [204, 121, 167]),
];

const FRONT: Color = [205; 3];

/// The bytes of a PNG file.
pub(crate) fn draw(trade: &Trade) -> Result<Vec<u8>> {
    let mut canvas = Canvas::new(1000, 720)?;
    let frame = Rect { x: LEFT + 10.0, y: 84.0, w: 1000.0 - LEFT - 150.0, h: 720.0 - 84.0 - BELOW - 8.0 };
    let drawn = |p: &&Point| p.max_error.is_finite() && p.max_error > 0.0 && p.table_seconds > 0.0;
    let points: Vec<_> = trade.points.iter().filter(drawn).collect();
    let scale = |values: &[f64]| {
        let min = values.iter().copied().fold(f64::INFINITY, f64::min);
        let max = values.iter().copied().fold(0.0, f64::max);
        let range = if min < max { [min / 1.6, max * 1.6] } else { [1e-6, 1.0] };
        PlotScale { range, kind: ScaleKind::Log }
    };
    let time = scale(&points.iter().map(|p| 1e3 * p.table_seconds).collect::<Vec<_>>());
    let error = scale(&points.iter().map(|p| p.max_error).collect::<Vec<_>>());
    let place = |p: &Point| {
        let x = frame.x + time.at(1e3 * p.table_seconds) as f32 * frame.w;
        (x, frame.y + (1.0 - error.at(p.max_error) as f32) * frame.h)
    };
    let title = canvas.fit(&trade.table, 22.0, 940.0);
    canvas.text(&title, (30.0, 28.0), 22.0, Align::Left, BLACK);
    let legend = "grey band: the Pareto front; rings: measured on a subset, time extrapolated; \
                  crosses: stored in 16 bits";
    canvas.text(legend, (30.0, 56.0), LABEL_SIZE, Align::Left, GREY);
    canvas.border(frame, GREY);
    ticks_below(&mut canvas, frame, &time, true);
    ticks_left(&mut canvas, frame, &error, true);
    axis_labels(&mut canvas, frame, "time for the whole table [ms]", "largest error");

    let mut front: Vec<_> = points.iter().filter(|p| p.on_front).map(|p| place(p)).collect();
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    canvas.line(&front, 15.0, FRONT);
    let mut labels: Vec<f32> = Vec::new();
    for (method, color) in METHODS {
        let (line, narrow): (Vec<_>, Vec<_>) =
            points.iter().copied().filter(|p| p.method == method).partition(|p| p.is_whole());
        for (x, y) in narrow.iter().map(|p| place(p)) {
            canvas.line(&[(x - 4.0, y - 4.0), (x + 4.0, y + 4.0)], 1.5, color);
            canvas.line(&[(x - 4.0, y + 4.0), (x + 4.0, y - 4.0)], 1.5, color);
        }
        canvas.line(&line.iter().map(|p| place(p)).collect::<Vec<_>>(), 2.5, color);
        for point in &line {
            canvas.disc(place(point), 5.0, color);
            if point.extrapolated {
                canvas.disc(place(point), 2.6, [255; 3]);
            }
        }
        let Some((x, y)) = line.last().map(|p| place(p)) else { continue };
        // Names of lines that end together stand below each other.
        let mut y = y;
        while labels.iter().any(|other| (other - y).abs() < 18.0) {
            y += 18.0;
        }
        labels.push(y);
        canvas.text(method, (x + 10.0, y), LABEL_SIZE, Align::Left, color);
    }
    canvas.to_png(1)
}
