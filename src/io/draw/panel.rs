//! The pieces of a preview: a heat map of a slice, its ticks, labels and colour bar.

use crate::io::draw::canvas::{Align, BLACK, Canvas, GREY, PALE, Pixels, Rect};
use crate::io::draw::colormap::viridis;
use crate::io::draw::scale;
use crate::io::draw::scale::PlotScale;
use crate::table::Table;
use crate::table::axis::Axis;

/// Room for tick labels and the axis label at the left of a frame and below it.
pub(crate) const LEFT: f32 = 78.0;
pub(crate) const BELOW: f32 = 56.0;
/// Room for a colour bar with its labels.
pub(crate) const BAR: f32 = 110.0;
pub(crate) const TICK_SIZE: f32 = 15.0;
pub(crate) const LABEL_SIZE: f32 = 17.0;
/// What a heat map shows of a texel.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Shown {
    Channel(usize),
    Luminance,
}

/// A plane through a table: all samples of two axes at one index of each other axis.
pub(crate) struct Slice<'a> {
    pub table: &'a Table,
    /// The index along every axis; those of `x` and `y` do not count.
    pub at: Vec<usize>,
    pub x: usize,
    pub y: usize,
    pub shown: Shown,
}

impl Slice<'_> {
    fn value(&self, i: usize, j: usize) -> f64 {
        let index = |k: usize| {
            if k == self.x {
                i
            } else if k == self.y {
                j
            } else {
                self.at[k]
            }
        };
        let axes = self.table.axes.iter().enumerate();
        let texel = axes.fold(0, |flat, (k, axis)| flat * axis.len() + index(k));
        match self.shown {
            Shown::Channel(c) => self.table.value(texel, c),
            // Rec. ITU-R BT.709-6, item 3.2
            Shown::Luminance => {
                let rgb = [0.2126, 0.7152, 0.0722].into_iter().enumerate();
                rgb.map(|(c, weight)| weight * self.table.value(texel, c)).sum()
            }
        }
    }

    pub fn values(&self) -> impl Iterator<Item = f64> + Clone {
        let [width, height] = [self.x, self.y].map(|k| self.table.axes[k].len());
        (0..width).flat_map(move |i| (0..height).map(move |j| self.value(i, j)))
    }

    /// The same plane at index `i` of axis `k`.
    pub fn moved(&self, k: usize, i: usize) -> Self {
        let mut at = self.at.clone();
        at[k] = i;
        Self { at, ..*self }
    }

    /// What tells this plane from the others: its channel and its values of the axes `spread`.
    pub fn heading(&self, spread: &[usize]) -> String {
        let axes = &self.table.axes;
        let place = |&k: &usize| scale::in_words(axes[k].variable(), axes[k].values()[self.at[k]]);
        let mut words: Vec<_> = spread.iter().map(place).collect();
        if let Shown::Channel(c) = self.shown
            && self.table.channels.len() > 1
        {
            words.insert(0, self.table.channels[c].clone());
        }
        words.join(", ")
    }
}

/// Paints every sample's cell; where cells are finer than pixels, the largest value shows.
pub(crate) fn heat_map(canvas: &mut Canvas, frame: Rect, slice: &Slice, scale: &PlotScale) {
    let (width, height) = (frame.w as usize, frame.h as usize);
    let columns = cells(&slice.table.axes[slice.x], width);
    let rows = cells(&slice.table.axes[slice.y], height);
    let color = |&(top, end): &(usize, usize), &(left, right): &(usize, usize)| {
        let inside = (left..=right).flat_map(|i| (top..=end).map(move |j| slice.value(i, j)));
        let value = inside.fold(f64::NEG_INFINITY, f64::max);
        if value.is_finite() { viridis(scale.at(value)) } else { GREY }
    };
    let colors = rows.iter().rev().flat_map(|row| columns.iter().map(move |column| color(row, column)));
    let pixels = Pixels { width, colors: colors.collect() };
    canvas.image(frame, pixels, &slice.table.name);
    canvas.border(frame, GREY);
}

/// The first and last sample whose cells each of `pixels` pixels covers. Cells meet half-way between
/// samples and end with the axis's range, so on nodes the outer ones are half cells.
fn cells(axis: &Axis, pixels: usize) -> Vec<(usize, usize)> {
    let scale = PlotScale::of_axis(axis);
    let middle = |pair: &[f64]| scale.at(0.5 * (pair[0] + pair[1]));
    let edges: Vec<_> = axis.values().windows(2).map(middle).collect();
    let cell = |u: f64| edges.partition_point(|&edge| edge <= u);
    let n = pixels as f64;
    (0..pixels).map(|p| (cell((p as f64 + 0.01) / n), cell((p as f64 + 0.99) / n))).collect()
}

pub(crate) fn ticks_below(canvas: &mut Canvas, frame: Rect, scale: &PlotScale, grid: bool) {
    let base = frame.y + frame.h;
    for (value, label) in scale.ticks((frame.w / 64.0) as usize) {
        let x = frame.x + (frame.w - 1.0) * scale.at(value) as f32;
        if grid {
            canvas.fill(Rect { x, y: frame.y, w: 1.0, h: frame.h }, PALE);
        }
        canvas.fill(Rect { x, y: base, w: 1.0, h: 6.0 }, GREY);
        canvas.text(&label, (x, base + 16.0), TICK_SIZE, Align::Center, BLACK);
    }
}

pub(crate) fn ticks_left(canvas: &mut Canvas, frame: Rect, scale: &PlotScale, grid: bool) {
    for (value, label) in scale.ticks((frame.h / 40.0) as usize) {
        let y = frame.y + (frame.h - 1.0) * (1.0 - scale.at(value) as f32);
        if grid {
            canvas.fill(Rect { x: frame.x, y, w: frame.w, h: 1.0 }, PALE);
        }
        canvas.fill(Rect { x: frame.x - 6.0, y, w: 6.0, h: 1.0 }, GREY);
        canvas.text(&label, (frame.x - 10.0, y), TICK_SIZE, Align::Right, BLACK);
    }
}

pub(crate) fn axis_labels(canvas: &mut Canvas, frame: Rect, below: &str, left: &str) {
    let (x, y) = (frame.x + frame.w / 2.0, frame.y + frame.h / 2.0);
    canvas.text(below, (x, frame.y + frame.h + 40.0), LABEL_SIZE, Align::Center, BLACK);
    canvas.text(left, (frame.x - LEFT + 16.0, y), LABEL_SIZE, Align::Turned, BLACK);
}

pub(crate) fn color_bar(canvas: &mut Canvas, frame: Rect, scale: &PlotScale, label: &str) {
    let rows = frame.h as usize;
    let color = |row| viridis(1.0 - (row as f64 + 0.5) / rows as f64);
    canvas.image(frame, Pixels { width: 1, colors: (0..rows).map(color).collect() }, label);
    canvas.border(frame, GREY);
    let right = frame.x + frame.w;
    for (value, label) in scale.ticks((frame.h / 44.0) as usize) {
        let y = frame.y + (frame.h - 1.0) * (1.0 - scale.at(value) as f32);
        canvas.fill(Rect { x: right, y, w: 6.0, h: 1.0 }, GREY);
        canvas.text(&label, (right + 10.0, y), TICK_SIZE, Align::Left, BLACK);
    }
    let label = canvas.fit(label, LABEL_SIZE, frame.h);
    canvas.text(&label, (right + 66.0, frame.y + frame.h / 2.0), LABEL_SIZE, Align::Turned, BLACK);
}
