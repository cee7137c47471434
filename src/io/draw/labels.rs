//! Names beside lines, where they cover nothing.

use crate::io::draw::canvas::{Align, Canvas, Color, Rect};
use crate::io::draw::panel::TICK_SIZE;

/// A line and its name.
pub(crate) struct Named<'a> {
    pub name: &'a str,
    pub color: Color,
    pub points: Vec<(f32, f32)>,
}

/// Writes each name beside its own line, within the frame: of many places the one that covers the fewest
/// points of lines and of `others`, and no other name. A place nearer to `best`, a share of the line's length,
/// wins a tie.
pub(crate) fn write(
    canvas: &mut Canvas,
    frame: Rect,
    lines: &[Named],
    others: &[[(f32, f32); 2]],
    best: f32,
) {
    let dense: Vec<_> = lines.iter().map(|line| resampled(&line.points)).collect();
    let others: Vec<_> = others.iter().flat_map(|line| resampled(line)).collect();
    let mut taken: Vec<Rect> = Vec::new();
    for (line, points) in lines.iter().zip(&dense).filter(|(_, points)| !points.is_empty()) {
        let (w, h) = (canvas.text_width(line.name, TICK_SIZE), TICK_SIZE);
        let places = points.iter().enumerate().step_by(4).flat_map(|(k, &(x, y))| {
            let off_best = (k as f32 / points.len() as f32 - best).abs();
            // Beside the point, close or, where that is not free, farther off.
            [6.0, 16.0].into_iter().flat_map(move |gap: f32| {
                let [left, middle, right] = [-gap - w, -0.5 * w, gap];
                let [above, level, below] = [-0.7 * gap - h, -0.5 * h, 0.7 * gap];
                let around = [
                    (right, level),
                    (left, level),
                    (middle, above),
                    (middle, below),
                    (right, above),
                    (left, above),
                    (right, below),
                    (left, below),
                ];
                let place = move |(dx, dy)| (off_best + 0.1 * gap, Rect { x: x + dx, y: y + dy, w, h });
                around.into_iter().map(place)
            })
        });
        let cost = |(far, place): &(f32, Rect)| {
            let wide = grown(*place, 3.0);
            let covered =
                dense.iter().flatten().chain(&others).filter(|&&point| contains(wide, point)).count();
            // A name between two lines could be either's.
            let around = grown(*place, 14.0);
            let neighbours = dense.iter().filter(|other| !std::ptr::eq(*other, points)).flatten();
            let doubtful = neighbours.filter(|&&point| contains(around, point)).count();
            let names = taken.iter().filter(|other| meet(**other, wide)).count();
            let inside = contains(frame, (place.x, place.y)) && contains(frame, (place.x + w, place.y + h));
            far + covered as f32 + 0.3 * doubtful as f32 + 1e3 * names as f32 + if inside { 0.0 } else { 1e4 }
        };
        let best = places.map(|place| (cost(&place), place.1)).min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, place)) = best else { continue };
        taken.push(place);
        canvas.text(line.name, (place.x, place.y + 0.5 * h), TICK_SIZE, Align::Left, line.color);
    }
}

/// Points along a line, no more than three units apart.
fn resampled(points: &[(f32, f32)]) -> Vec<(f32, f32)> {
    let mut dense = Vec::new();
    for pair in points.windows(2) {
        let ((ax, ay), (bx, by)) = (pair[0], pair[1]);
        let steps = ((bx - ax).hypot(by - ay) / 3.0).ceil().min(1e3);
        dense.extend((0..steps as usize).map(|k| {
            let t = k as f32 / steps;
            (ax + (bx - ax) * t, ay + (by - ay) * t)
        }));
    }
    dense
}

fn grown(Rect { x, y, w, h }: Rect, by: f32) -> Rect {
    Rect { x: x - by, y: y - by, w: w + 2.0 * by, h: h + 2.0 * by }
}

fn contains(frame: Rect, (x, y): (f32, f32)) -> bool {
    (frame.x..=frame.x + frame.w).contains(&x) && (frame.y..=frame.y + frame.h).contains(&y)
}

fn meet(a: Rect, b: Rect) -> bool {
    a.x < b.x + b.w && b.x < a.x + a.w && a.y < b.y + b.h && b.y < a.y + a.h
}
