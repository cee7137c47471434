//! PNG previews, for people: numbers, a line plot, heat maps, or small multiples of slices.

use crate::base::error::Result;
use crate::io::Provenance;
use crate::io::draw::canvas::{Align, BLACK, Canvas, Color, GREY, Rect};
use crate::io::draw::panel::{
    BAR, BELOW, LABEL_SIZE, LEFT, Shown, Slice, TICK_SIZE, axis_labels, color_bar, heat_map, ticks_below,
    ticks_left,
};
use crate::io::draw::scale;
use crate::io::draw::scale::{PlotScale, ScaleKind};
use crate::io::format::{Format, Streamed};
use crate::table::axis::Axis;
use crate::table::{ErrorKind, Table};

/// A preview to look at, not to read values from.
pub static PNG: Format = Format {
    name: "png",
    extension: "png",
    summary: "PNG: a picture to look at, not to read values from",
    encode,
    streamed: Streamed::Preview,
};

/// The bytes of the file. Axes of one sample are no axes here; the subtitle names their values.
fn encode(table: &Table, _: &Provenance) -> Result<Vec<u8>> {
    let axes: Vec<_> = (0..table.axes.len()).filter(|&k| table.axes[k].len() > 1).collect();
    match axes[..] {
        [] => numbers(table),
        [x] => lines(table, x),
        // As the file has it: the last axis is the width.
        [y, x] => maps(table, x, y),
        [ref slow @ .., x, y] => multiples(table, slow, x, y),
    }
}

/// Room for the title and two lines below it.
const HEADER: f32 = 92.0;
/// More channels than this do not fit a page.
const MOST_CHANNELS: usize = 6;

/// A table of one texel.
fn numbers(table: &Table) -> Result<Vec<u8>> {
    let shown = table.channels.iter().take(24);
    let mut canvas = Canvas::new(820, HEADER as usize + 32 * shown.len() + 24)?;
    header(&mut canvas, table, &[]);
    for (k, channel) in shown.enumerate() {
        let line = format!("{channel} = {} {}", table.values.show(k), unit(table));
        canvas.text(&line, (24.0, HEADER + 16.0 + 32.0 * k as f32), 22.0, Align::Left, BLACK);
    }
    canvas.to_png(1)
}

/// A table over one axis: a line for each channel.
fn lines(table: &Table, x: usize) -> Result<Vec<u8>> {
    let frame = Rect { x: LEFT + 18.0, y: HEADER + 8.0, w: 860.0, h: 460.0 };
    let mut canvas = Canvas::new(1100, (frame.y + frame.h + BELOW) as usize)?;
    let axis = &table.axes[x];
    let scale_x = PlotScale::of_axis(axis);
    let values = table.values.iter();
    let scale_y = PlotScale::of_values(values, is_density(table)).with_margin();
    let notes = if scale_y.kind == ScaleKind::Log { vec!["logarithmic".to_owned()] } else { vec![] };
    header(&mut canvas, table, &notes);

    ticks_below(&mut canvas, frame, &scale_x, true);
    ticks_left(&mut canvas, frame, &scale_y, true);
    canvas.border(frame, GREY);
    axis_labels(&mut canvas, frame, &scale::label(axis.variable()), &quantity(table));

    for (c, channel) in table.channels.iter().enumerate() {
        let color = line_color(channel, c);
        let at = |texel: usize| {
            let v = scale_y.at(table.value(texel, c)).clamp(0.0, 1.0) as f32;
            (frame.x + frame.w * scale_x.at(axis.values()[texel]) as f32, frame.y + frame.h * (1.0 - v))
        };
        let points: Vec<_> = (0..axis.len()).map(at).collect();
        canvas.line(&points, 2.0, color);
        if points.len() <= 64 {
            points.iter().for_each(|&point| canvas.disc(point, 3.0, color));
        }
        let (x, y) = (frame.x + frame.w + 20.0, frame.y + 14.0 + 26.0 * c as f32);
        canvas.line(&[(x, y), (x + 24.0, y)], 3.0, color);
        let name = canvas.fit(channel, LABEL_SIZE, 1100.0 - x - 40.0);
        canvas.text(&name, (x + 32.0, y), LABEL_SIZE, Align::Left, BLACK);
    }
    canvas.to_png(1)
}

/// A table over two axes: a heat map for each channel, each with its own colour bar.
fn maps(table: &Table, x: usize, y: usize) -> Result<Vec<u8>> {
    let shown = table.channels.len().min(MOST_CHANNELS);
    let columns = shown.min(3);
    let side = [560.0, 440.0, 264.0][columns - 1];
    let (cell_w, cell_h) = (LEFT + side + BAR, 30.0 + side + BELOW);
    let size = (cell_w * columns as f32, HEADER + cell_h * shown.div_ceil(columns) as f32);
    let mut canvas = Canvas::new(size.0.max(700.0) as usize, size.1 as usize)?;

    let mut notes = vec![];
    if shown < table.channels.len() {
        notes.push(format!("the first {shown} of {} channels", table.channels.len()));
    }
    header(&mut canvas, table, &notes);
    for c in 0..shown {
        let (column, row) = ((c % columns) as f32, (c / columns) as f32);
        let frame = Rect { x: LEFT + cell_w * column, y: HEADER + 30.0 + cell_h * row, w: side, h: side };
        let slice = Slice { table, at: vec![0; table.axes.len()], x, y, shown: Shown::Channel(c) };
        let scale = PlotScale::of_values(slice.values(), is_density(table));
        heat_map(&mut canvas, frame, &slice, &scale);
        ticks_below(&mut canvas, frame, &PlotScale::of_axis(&table.axes[x]), false);
        ticks_left(&mut canvas, frame, &PlotScale::of_axis(&table.axes[y]), false);
        let [label_x, label_y] = [x, y].map(|axis| scale::label(table.axes[axis].variable()));
        axis_labels(&mut canvas, frame, &label_x, &label_y);
        let name = canvas.fit(&table.channels[c], LABEL_SIZE, side);
        canvas.text(&name, (frame.x + side / 2.0, frame.y - 16.0), LABEL_SIZE, Align::Center, BLACK);
        color_bar(&mut canvas, Rect { x: frame.x + side + 14.0, w: 16.0, ..frame }, &scale, &quantity(table));
    }
    canvas.to_png(1)
}

/// A table over three axes or more: slices at a few values of the slow axes, all with one colour bar.
fn multiples(table: &Table, slow: &[usize], x: usize, y: usize) -> Result<Vec<u8>> {
    let mut notes = vec![];
    let shown: Vec<_> = if table.channels == ["R", "G", "B"] {
        notes.push("luminance (Rec. 709) of R, G, B".to_owned());
        vec![Shown::Luminance]
    } else {
        (0..table.channels.len().min(3)).map(Shown::Channel).collect()
    };
    if table.channels.len() > 3 {
        notes.push(format!("the first 3 of {} channels", table.channels.len()));
    }

    // The last one or two slow axes are spread out, the rest stay in their middle.
    let (fixed, spread) = slow.split_at(slow.len().saturating_sub(2));
    let mut at = vec![0; table.axes.len()];
    for &k in fixed {
        at[k] = table.axes[k].len() / 2;
        let place = scale::in_words(table.axes[k].variable(), table.axes[k].values()[at[k]]);
        notes.push(format!("slice at {place}"));
    }
    let chosen: Vec<_> = match (spread, shown.len()) {
        ([only], 1) => vec![(*only, choose(&table.axes[*only], 6))],
        ([rows, columns], 1) => {
            vec![(*rows, choose(&table.axes[*rows], 3)), (*columns, choose(&table.axes[*columns], 3))]
        }
        ([rows, columns], _) => {
            vec![(*rows, choose(&table.axes[*rows], 2)), (*columns, choose(&table.axes[*columns], 3))]
        }
        (any, _) => any.iter().map(|&k| (k, choose(&table.axes[k], 3))).collect(),
    };
    let columns = chosen.last().map_or(1, |(_, indices)| indices.len().min(3));
    let mut panels: Vec<_> =
        shown.into_iter().map(|shown| Slice { table, at: at.clone(), x, y, shown }).collect();
    for (k, indices) in chosen {
        panels = panels.iter().flat_map(|panel| indices.iter().map(move |&i| panel.moved(k, i))).collect();
    }

    let scale = PlotScale::of_values(panels.iter().flat_map(Slice::values), is_density(table));
    if scale.kind == ScaleKind::Log {
        notes.push(format!("logarithmic colours over at most {} decades", scale::DECADES));
    }
    let (w, h, gap) = (368.0, 236.0, 24.0);
    let rows = panels.len().div_ceil(columns);
    let right = LEFT + (w + gap) * columns as f32;
    let bottom = HEADER + (h + 34.0) * rows as f32;
    let mut canvas = Canvas::new((right - gap + 14.0 + BAR).max(700.0) as usize, (bottom + BELOW) as usize)?;
    header(&mut canvas, table, &notes);
    for (k, panel) in panels.iter().enumerate() {
        let (column, row) = (k % columns, k / columns);
        let corner = (LEFT + (w + gap) * column as f32, HEADER + 30.0 + (h + 34.0) * row as f32);
        let frame = Rect { x: corner.0, y: corner.1, w, h };
        heat_map(&mut canvas, frame, panel, &scale);
        let heading = canvas.fit(&panel.heading(spread), TICK_SIZE, w);
        canvas.text(&heading, (frame.x + w / 2.0, frame.y - 15.0), TICK_SIZE, Align::Center, BLACK);
        let [label_x, label_y] = [x, y].map(|axis| scale::label(table.axes[axis].variable()));
        if column == 0 {
            ticks_left(&mut canvas, frame, &PlotScale::of_axis(&table.axes[y]), false);
            axis_labels(&mut canvas, frame, "", &label_y);
        }
        if k + columns >= panels.len() {
            ticks_below(&mut canvas, frame, &PlotScale::of_axis(&table.axes[x]), false);
            axis_labels(&mut canvas, frame, &label_x, "");
        }
    }
    let tall = Rect { x: right - gap + 14.0, y: HEADER + 30.0, w: 16.0, h: bottom - HEADER - 34.0 };
    color_bar(&mut canvas, tall, &scale, &quantity(table));
    canvas.to_png(1)
}

/// Up to `count` indices of an axis, from its first sample in even steps. Zenith angles stop a step
/// before their end: at grazing, values diverge and would take the whole colour scale.
fn choose(axis: &Axis, count: usize) -> Vec<usize> {
    let last = axis.len() - 1;
    let steps = if axis.variable().name().starts_with("theta") { count } else { count - 1 };
    let mut chosen: Vec<_> = (0..count).map(|k| (last * k + steps / 2) / steps).collect();
    chosen.dedup();
    chosen
}

/// Title, what holds for the whole picture, and how far to trust it.
fn header(canvas: &mut Canvas, table: &Table, notes: &[String]) {
    let width = canvas.width() as f32 - 40.0;
    let title = format!("{}: {} of {} {}", table.name, table.quantity.name, table.subject, unit(table));
    let title = canvas.fit(&title, 24.0, width);
    canvas.text(&title, (20.0, 24.0), 24.0, Align::Left, BLACK);

    let parameters =
        table.parameters.iter().map(|(name, &value)| format!("{name} = {}", scale::short(value)));
    let single = table.axes.iter().filter(|axis| axis.len() == 1);
    let single = single.map(|axis| scale::in_words(axis.variable(), axis.values()[0]));
    let notes: Vec<_> = parameters.chain(single).chain(notes.iter().cloned()).collect();

    let error = &table.error;
    let kind = if error.kind == ErrorKind::Absolute { "absolute" } else { "relative" };
    let measured = match error.measured_max {
        Some(max) => {
            let against = error.against.as_deref().unwrap_or("the reference");
            format!("largest {kind} difference from {against} {max:.1e}, {} texels", error.texels_checked)
        }
        None => "not checked against the reference".into(),
    };
    let rule = format!("{}, {}{SEPARATOR}{measured}", table.rule, table.precision);

    let mut y = 48.0;
    for (line, color) in [(notes.join(SEPARATOR), BLACK), (rule, GREY)] {
        let line = canvas.fit(&line, TICK_SIZE, width);
        if !line.is_empty() {
            canvas.text(&line, (20.0, y), TICK_SIZE, Align::Left, color);
            y += 20.0;
        }
    }
}

const SEPARATOR: &str = "   ·   ";

fn unit(table: &Table) -> String {
    if table.quantity.unit == "1" { String::new() } else { format!("[{}]", table.quantity.unit) }
}

/// The label of the values: "brdf [sr⁻¹]".
fn quantity(table: &Table) -> String {
    format!("{} {}", table.quantity.name, unit(table)).trim_end().to_owned()
}

/// Densities per solid angle span decades; reflectances do not.
fn is_density(table: &Table) -> bool {
    table.quantity.unit != "1"
}

/// R, G and B as they are; else colours that also the colour-blind tell apart (Okabe and Ito, 2008).
fn line_color(channel: &str, k: usize) -> Color {
    const COLORS: [Color; 6] =
        [[0, 114, 178], [213, 94, 0], [0, 158, 115], [204, 121, 167], [230, 159, 0], [86, 180, 233]];
    match channel {
        "R" => [204, 32, 32],
        "G" => [24, 140, 40],
        "B" => [32, 64, 208],
        _ => COLORS[k % COLORS.len()],
    }
}
