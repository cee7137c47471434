//! A drawing as a PNG file.

use crate::base::error::{Error, Result};
use crate::io::draw::canvas::{Align, BASELINE, Canvas, Color, Fonts, Mark, Pixels, Rect};
use ab_glyph::{Font, PxScale, ScaleFont, point};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

/// The bytes of a PNG file with `scale` pixels to a unit.
pub(crate) fn encode(canvas: &Canvas, scale: usize) -> Result<Vec<u8>> {
    let (width, height) = (canvas.size.0 * scale, canvas.size.1 * scale);
    let mut raster = Raster { width, height, scale: scale as f32, pixels: vec![255; width * height * 3] };
    canvas.marks.iter().for_each(|mark| raster.draw(mark, &canvas.fonts));
    png(&raster.pixels, [width, height])
}

/// The bytes of a PNG file of pixels alone.
pub(crate) fn encode_pixels(pixels: &Pixels) -> Result<Vec<u8>> {
    png(pixels.colors.as_flattened(), [pixels.width, pixels.colors.len() / pixels.width.max(1)])
}

fn png(rgb: &[u8], [width, height]: [usize; 2]) -> Result<Vec<u8>> {
    let mut png = Vec::new();
    PngEncoder::new_with_quality(&mut png, CompressionType::Default, FilterType::Adaptive)
        .write_image(rgb, width as u32, height as u32, ExtendedColorType::Rgb8)
        .map_err(|error| Error::Internal(format!("PNG: {error}")))?;
    Ok(png)
}

struct Raster {
    width: usize,
    height: usize,
    scale: f32,
    pixels: Vec<u8>,
}

impl Raster {
    fn draw(&mut self, mark: &Mark, fonts: &Fonts) {
        let s = self.scale;
        let scaled = |&(x, y): &(f32, f32)| (x * s, y * s);
        match mark {
            &Mark::Fill(Rect { x, y, w, h }, color) => {
                self.fill(Rect { x: x * s, y: y * s, w: w * s, h: h * s }, color);
            }
            &Mark::Line { ref points, width, color } => {
                self.line(&points.iter().map(scaled).collect::<Vec<_>>(), 0.5 * width * s, color);
            }
            Mark::Disc { center, radius, color } => {
                self.line(&[scaled(center), scaled(center)], radius * s, *color);
            }
            Mark::Image { frame, pixels, .. } => self.image(*frame, pixels),
            &Mark::Text { ref text, at, size, align, color } => {
                self.text(text, scaled(&at), size * s, align, color, fonts);
            }
        }
    }

    /// Mixes a colour into one pixel; outside the picture nothing happens.
    fn mix(&mut self, x: i32, y: i32, color: Color, coverage: f32) {
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

    fn fill(&mut self, Rect { x, y, w, h }: Rect, color: Color) {
        for row in y.round() as i32..(y + h).round() as i32 {
            for column in x.round() as i32..(x + w).round() as i32 {
                self.mix(column, row, color, 1.0);
            }
        }
    }

    /// Each pixel takes the nearest of the image's.
    fn image(&mut self, Rect { x, y, w, h }: Rect, pixels: &Pixels) {
        let s = self.scale;
        let [left, top] = [x, y].map(|x| (x * s).round() as i32);
        let [columns, rows] = [w, h].map(|w| (w * s).round() as usize);
        let height = pixels.colors.len() / pixels.width.max(1);
        for row in 0..rows {
            for column in 0..columns {
                let [i, j] = [column * pixels.width / columns, row * height / rows];
                let color = pixels.colors[j * pixels.width + i];
                self.mix(left + column as i32, top + row as i32, color, 1.0);
            }
        }
    }

    /// Every pixel within `radius` of the line; the edge fades over one pixel. A pixel is mixed once, however
    /// many of the line's segments are near it.
    fn line(&mut self, points: &[(f32, f32)], radius: f32, color: Color) {
        let reach = radius + 1.0;
        let end = |values: &dyn Fn(&(f32, f32)) -> f32, most: usize| {
            let low = points.iter().map(values).fold(f32::INFINITY, f32::min) - reach;
            let high = points.iter().map(values).fold(f32::NEG_INFINITY, f32::max) + reach;
            (low.max(0.0) as usize, (high.max(0.0) as usize + 1).min(most))
        };
        let ((left, right), (top, bottom)) = (end(&|p| p.0, self.width), end(&|p| p.1, self.height));
        if left >= right || top >= bottom {
            return;
        }
        let mut coverage = vec![0f32; (right - left) * (bottom - top)];
        for pair in points.windows(2) {
            let ((ax, ay), (bx, by)) = (pair[0], pair[1]);
            let (dx, dy) = (bx - ax, by - ay);
            let length2 = (dx * dx + dy * dy).max(1e-6); // a point is a segment too
            let rows = (ay.min(by) - reach).max(top as f32) as usize
                ..((ay.max(by) + reach).max(0.0) as usize + 1).min(bottom);
            for y in rows {
                let columns = (ax.min(bx) - reach).max(left as f32) as usize
                    ..((ax.max(bx) + reach).max(0.0) as usize + 1).min(right);
                for x in columns {
                    let (px, py) = (x as f32 + 0.5 - ax, y as f32 + 0.5 - ay);
                    let t = ((px * dx + py * dy) / length2).clamp(0.0, 1.0);
                    let distance = (px - t * dx).hypot(py - t * dy);
                    let at = &mut coverage[(y - top) * (right - left) + x - left];
                    *at = at.max(radius + 0.5 - distance);
                }
            }
        }
        for (k, &coverage) in coverage.iter().enumerate().filter(|(_, coverage)| **coverage > 0.0) {
            let (x, y) = (left + k % (right - left), top + k / (right - left));
            self.mix(x as i32, y as i32, color, coverage);
        }
    }

    fn text(&mut self, text: &str, (x, y): (f32, f32), size: f32, align: Align, color: Color, fonts: &Fonts) {
        let width = fonts.width(text, size);
        let mut pen = match align {
            Align::Left => 0.0,
            Align::Center | Align::Turned => -width / 2.0,
            Align::Right => -width,
        };
        let (x, y) = (x.round(), y.round());
        for (font, c) in fonts.glyphs(text) {
            let scaled = font.as_scaled(PxScale::from(size));
            let glyph = font.glyph_id(c).with_scale_and_position(size, point(pen, BASELINE * size));
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
}

const WEIGHT: f32 = 1.35;
