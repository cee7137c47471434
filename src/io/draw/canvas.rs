//! A drawing: fills, lines, discs, images and text, as a list of marks. Two back ends make files of it:
//! [`raster`](crate::io::draw::raster) a PNG and [`svg`](crate::io::draw::svg) an SVG.

use crate::base::error::{Error, Result};
use crate::io::draw::{raster, svg};
use ab_glyph::{Font, FontRef, PxScale, ScaleFont};
use epaint_default_fonts::{HACK_REGULAR, UBUNTU_LIGHT};

/// Red, green, blue; sRGB.
pub(crate) type Color = [u8; 3];

pub(crate) const BLACK: Color = [16; 3];
pub(crate) const GREY: Color = [96; 3];
pub(crate) const PALE: Color = [224; 3];
pub(crate) const WHITE: Color = [255; 3];

/// A rectangle; y points down.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rect {
    pub x: f32,
    pub y: f32,
    pub w: f32,
    pub h: f32,
}

/// Which point of a text is at its position; upwards it is always centred.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Align {
    Left,
    Center,
    Right,
    /// Centred and turned by 90°, to be read from the right.
    Turned,
}

/// Pixels, row by row from the top.
#[derive(Debug, Clone)]
pub(crate) struct Pixels {
    pub width: usize,
    pub colors: Vec<Color>,
}

/// Something drawn. Later marks lie over earlier ones.
pub(crate) enum Mark {
    Fill(Rect, Color),
    /// A line through points, with round ends and corners.
    Line {
        points: Vec<(f32, f32)>,
        width: f32,
        color: Color,
    },
    Disc {
        center: (f32, f32),
        radius: f32,
        color: Color,
    },
    /// Pixels over a frame, and what they show.
    Image {
        frame: Rect,
        pixels: Pixels,
        title: String,
    },
    Text {
        text: String,
        at: (f32, f32),
        size: f32,
        align: Align,
        color: Color,
    },
}

/// A drawing under way, on white. Its unit is a pixel of a PNG at scale 1.
pub(crate) struct Canvas {
    pub size: (usize, usize),
    pub marks: Vec<Mark>,
    pub fonts: Fonts,
}

/// In the order of preference: the first font that has a glyph draws it.
pub(crate) struct Fonts([FontRef<'static>; 2]);

impl Canvas {
    /// An empty drawing.
    pub fn new(width: usize, height: usize) -> Result<Self> {
        let font = |bytes| {
            FontRef::try_from_slice(bytes).map_err(|error| Error::Internal(format!("built-in font: {error}")))
        };
        let fonts = Fonts([font(UBUNTU_LIGHT)?, font(HACK_REGULAR)?]);
        Ok(Self { size: (width, height), marks: Vec::new(), fonts })
    }

    /// Its width.
    pub fn width(&self) -> usize {
        self.size.0
    }

    /// The bytes of a PNG file with `scale` pixels to a unit; no times in it.
    pub fn to_png(&self, scale: usize) -> Result<Vec<u8>> {
        raster::encode(self, scale)
    }

    /// The text of an SVG file. Nothing in it has a name, so that a page may hold several.
    pub fn to_svg(&self) -> Result<String> {
        svg::encode(self)
    }

    /// Fills a rectangle, to whole pixels.
    pub fn fill(&mut self, frame: Rect, color: Color) {
        self.marks.push(Mark::Fill(frame, color));
    }

    /// Draws the border of a rectangle, a unit wide, around its inside.
    pub fn border(&mut self, Rect { x, y, w, h }: Rect, color: Color) {
        self.fill(Rect { x: x - 1.0, y: y - 1.0, w: w + 2.0, h: 1.0 }, color);
        self.fill(Rect { x: x - 1.0, y: y + h, w: w + 2.0, h: 1.0 }, color);
        self.fill(Rect { x: x - 1.0, y: y - 1.0, w: 1.0, h: h + 2.0 }, color);
        self.fill(Rect { x: x + w, y: y - 1.0, w: 1.0, h: h + 2.0 }, color);
    }

    /// Draws a line through the points, `width` wide.
    pub fn line(&mut self, points: &[(f32, f32)], width: f32, color: Color) {
        if points.len() > 1 {
            self.marks.push(Mark::Line { points: points.to_vec(), width, color });
        }
    }

    /// Draws a straight line in dashes.
    pub fn dashes(&mut self, (ax, ay): (f32, f32), (bx, by): (f32, f32), width: f32, color: Color) {
        const DASH: f32 = 5.0;
        let length = (bx - ax).hypot(by - ay);
        let at = |s: f32| (ax + (bx - ax) * s / length, ay + (by - ay) * s / length);
        for k in 0..(length / (2.0 * DASH)).ceil() as usize {
            let start = 2.0 * DASH * k as f32;
            self.line(&[at(start), at((start + DASH).min(length))], width, color);
        }
    }

    /// Draws an arc of a circle, from one angle to another: from the right, counter-clockwise.
    pub fn arc(&mut self, (x, y): (f32, f32), radius: f32, [from, to]: [f32; 2], width: f32, color: Color) {
        let steps = ((to - from).abs() * radius / 3.0).ceil().clamp(8.0, 360.0) as usize;
        let at = |k: usize| {
            let (sin, cos) = (from + (to - from) * k as f32 / steps as f32).sin_cos();
            (x + radius * cos, y - radius * sin)
        };
        self.line(&(0..=steps).map(at).collect::<Vec<_>>(), width, color);
    }

    /// Draws a filled disc.
    pub fn disc(&mut self, center: (f32, f32), radius: f32, color: Color) {
        self.marks.push(Mark::Disc { center, radius, color });
    }

    /// Draws pixels over a frame; the title says what they show, where a format can say it.
    pub fn image(&mut self, frame: Rect, pixels: Pixels, title: &str) {
        self.marks.push(Mark::Image { frame, pixels, title: title.to_owned() });
    }

    /// Writes a text of `size`, from ascent to descent.
    pub fn text(&mut self, text: &str, at: (f32, f32), size: f32, align: Align, color: Color) {
        if !text.is_empty() {
            self.marks.push(Mark::Text { text: text.to_owned(), at, size, align, color });
        }
    }

    /// The width of a text of `size`.
    pub fn text_width(&self, text: &str, size: f32) -> f32 {
        self.fonts.width(text, size)
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
}

impl Fonts {
    /// The width of a text of `size`.
    pub fn width(&self, text: &str, size: f32) -> f32 {
        let advance =
            |(font, c): (&FontRef, char)| font.as_scaled(PxScale::from(size)).h_advance(font.glyph_id(c));
        self.glyphs(text).map(advance).sum()
    }

    /// Each character with the font that draws it.
    pub fn glyphs<'t>(&'t self, text: &'t str) -> impl Iterator<Item = (&'t FontRef<'static>, char)> {
        text.chars().map(|c| (self.0.iter().find(|font| font.glyph_id(c).0 != 0).unwrap_or(&self.0[0]), c))
    }
}

/// ab_glyph's size is the height from ascent to descent; an em is about 0.87 of it.
pub(crate) const EM: f32 = 0.87;
/// Capitals and digits are about 0.7 em high: half of it, below the middle, is their baseline.
pub(crate) const BASELINE: f32 = 0.35 * EM;
