//! A small RGB canvas: filled rectangles, smooth lines and text.

use crate::error::{Error, Result};
use ab_glyph::{Font, FontRef, PxScale, ScaleFont, point};
use epaint_default_fonts::{HACK_REGULAR, UBUNTU_LIGHT};
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};

/// Red, green, blue; sRGB.
pub(super) type Color = [u8; 3];

pub(super) const BLACK: Color = [16; 3];
pub(super) const GREY: Color = [96; 3];
pub(super) const PALE: Color = [224; 3];

/// A rectangle in pixels; y points down.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub x: f32,
    pub y: f32,
    pub w: f32,
    pub h: f32,
}

/// Which point of a text is at its position; upwards it is always centred.
#[derive(Debug, Clone, Copy)]
pub(super) enum Align {
    Left,
    Center,
    Right,
    /// Centred and turned by 90°, to be read from the right.
    Turned,
}

/// An image under construction.
pub(super) struct Canvas {
    width: usize,
    height: usize,
    pixels: Vec<u8>,
    /// In the order of preference: the first font that has a glyph draws it.
    fonts: [FontRef<'static>; 2],
}

impl Canvas {
    /// A white canvas.
    pub fn new(width: usize, height: usize) -> Result<Self> {
        let font = |bytes| {
            FontRef::try_from_slice(bytes).map_err(|error| Error::Internal(format!("built-in font: {error}")))
        };
        let pixels = vec![255; width * height * 3];
        Ok(Self { width, height, pixels, fonts: [font(UBUNTU_LIGHT)?, font(HACK_REGULAR)?] })
    }

    /// Pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// The bytes of a PNG file; no times in it.
    pub fn into_png(self) -> Result<Vec<u8>> {
        let (width, height) = (self.width as u32, self.height as u32);
        let mut png = Vec::new();
        PngEncoder::new(&mut png)
            .write_image(&self.pixels, width, height, ExtendedColorType::Rgb8)
            .map_err(|error| Error::Internal(format!("PNG: {error}")))?;
        Ok(png)
    }

    /// Mixes a colour into one pixel; outside the canvas nothing happens.
    pub fn mix(&mut self, x: i32, y: i32, color: Color, coverage: f32) {
        let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else { return };
        if x >= self.width || y >= self.height {
            return;
        }
        let at = (y * self.width + x) * 3;
        for (old, new) in self.pixels[at..at + 3].iter_mut().zip(color) {
            let mixed = f32::from(*old) + (f32::from(new) - f32::from(*old)) * coverage.clamp(0.0, 1.0);
            *old = mixed.round() as u8;
        }
    }

    /// Fills a rectangle, to whole pixels.
    pub fn fill(&mut self, frame: Frame, color: Color) {
        let Frame { x, y, w, h } = frame;
        for row in y.round() as i32..(y + h).round() as i32 {
            for column in x.round() as i32..(x + w).round() as i32 {
                self.mix(column, row, color, 1.0);
            }
        }
    }

    /// Draws the border of a rectangle, one pixel wide, around its inside.
    pub fn border(&mut self, Frame { x, y, w, h }: Frame, color: Color) {
        self.fill(Frame { x: x - 1.0, y: y - 1.0, w: w + 2.0, h: 1.0 }, color);
        self.fill(Frame { x: x - 1.0, y: y + h, w: w + 2.0, h: 1.0 }, color);
        self.fill(Frame { x: x - 1.0, y: y - 1.0, w: 1.0, h: h + 2.0 }, color);
        self.fill(Frame { x: x + w, y: y - 1.0, w: 1.0, h: h + 2.0 }, color);
    }

    /// Draws a line through the points, `width` pixels wide, with smooth edges.
    pub fn line(&mut self, points: &[(f32, f32)], width: f32, color: Color) {
        for pair in points.windows(2) {
            self.segment(pair[0], pair[1], width / 2.0, color);
        }
    }

    /// Draws a filled disc.
    pub fn disc(&mut self, center: (f32, f32), radius: f32, color: Color) {
        self.segment(center, center, radius, color);
    }

    /// Every pixel within `radius` of the segment; the edge fades over one pixel.
    fn segment(&mut self, (ax, ay): (f32, f32), (bx, by): (f32, f32), radius: f32, color: Color) {
        let (dx, dy) = (bx - ax, by - ay);
        let length2 = (dx * dx + dy * dy).max(1e-6); // a point is a segment too
        let reach = radius + 1.0;
        for y in (ay.min(by) - reach) as i32..=(ay.max(by) + reach) as i32 {
            for x in (ax.min(bx) - reach) as i32..=(ax.max(bx) + reach) as i32 {
                let (px, py) = (x as f32 + 0.5 - ax, y as f32 + 0.5 - ay);
                let t = ((px * dx + py * dy) / length2).clamp(0.0, 1.0);
                let distance = (px - t * dx).hypot(py - t * dy);
                self.mix(x, y, color, radius + 0.5 - distance);
            }
        }
    }

    /// Writes a text of `size` pixels.
    pub fn text(&mut self, text: &str, (x, y): (f32, f32), size: f32, align: Align, color: Color) {
        let width = self.text_width(text, size);
        let start = match align {
            Align::Left => 0.0,
            Align::Center | Align::Turned => -width / 2.0,
            Align::Right => -width,
        };
        // Capitals and digits are about 0.7 em high: half of it puts their middle at y.
        let baseline = 0.35 * size * EM;
        let (x, y) = (x.round(), y.round());
        let mut pen = start;
        for (font, c) in self.glyphs(text) {
            let scaled = font.as_scaled(PxScale::from(size));
            let glyph = font.glyph_id(c).with_scale_and_position(size, point(pen, baseline));
            pen += scaled.h_advance(font.glyph_id(c));
            let Some(outline) = font.outline_glyph(glyph) else { continue };
            let corner = outline.px_bounds().min;
            outline.draw(|u, v, coverage| {
                let (u, v) = (corner.x + u as f32, corner.y + v as f32);
                let (px, py) = if let Align::Turned = align { (x + v, y - u - 1.0) } else { (x + u, y + v) };
                // Light strokes on white look thin: some weight helps.
                self.mix(px as i32, py as i32, color, coverage * WEIGHT);
            });
        }
    }

    /// The width of a text of `size` pixels.
    pub fn text_width(&self, text: &str, size: f32) -> f32 {
        let advance =
            |(font, c): (FontRef, char)| font.as_scaled(PxScale::from(size)).h_advance(font.glyph_id(c));
        self.glyphs(text).map(advance).sum()
    }

    /// The text, cut with "…" where it is wider than `width`.
    pub fn fit(&self, text: &str, size: f32, width: f32) -> String {
        let mut cut = text.to_owned();
        while self.text_width(&cut, size) > width && cut.pop().is_some() {
            cut.pop();
            cut.push('…');
        }
        cut
    }

    /// Each character with the font that draws it.
    fn glyphs<'t>(&self, text: &'t str) -> impl Iterator<Item = (FontRef<'static>, char)> + use<'t> {
        let fonts = self.fonts.clone();
        text.chars().map(move |c| {
            let font = fonts.iter().find(|font| font.glyph_id(c).0 != 0).unwrap_or(&fonts[0]);
            (font.clone(), c)
        })
    }
}

/// ab_glyph's size is the height from ascent to descent; an em is about 0.87 of it.
const EM: f32 = 0.87;
const WEIGHT: f32 = 1.35;
