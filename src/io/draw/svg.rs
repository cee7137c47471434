//! A drawing as an SVG file: text stays text, and images are PNG files within it.

use crate::base::error::Result;
use crate::base::words::printable;
use crate::io::draw::canvas::{Align, BASELINE, Canvas, Color, EM, Mark, Rect};
use crate::io::draw::raster;
use std::fmt::Write;

/// The fonts of the raster images where they are installed, else what looks like them.
const FONTS: &str = "Ubuntu, 'DejaVu Sans', 'Segoe UI', Roboto, Helvetica, Arial, sans-serif";

/// The text of the file.
pub(crate) fn encode(canvas: &Canvas) -> Result<String> {
    let (width, height) = canvas.size;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"{FONTS}\" stroke-linecap=\"round\" \
         stroke-linejoin=\"round\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n"
    );
    for mark in &canvas.marks {
        svg += &element(mark)?;
        svg.push('\n');
    }
    Ok(svg + "</svg>\n")
}

fn element(mark: &Mark) -> Result<String> {
    Ok(match mark {
        &Mark::Fill(Rect { x, y, w, h }, color) => format!(
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\"/>",
            short(x),
            short(y),
            short(w),
            short(h),
            hex(color)
        ),
        Mark::Line { points, width, color } => {
            let points: Vec<_> = points.iter().map(|&(x, y)| format!("{},{}", short(x), short(y))).collect();
            format!(
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"/>",
                points.join(" "),
                hex(*color),
                short(*width)
            )
        }
        &Mark::Disc { center: (x, y), radius, color } => format!(
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\"/>",
            short(x),
            short(y),
            short(radius),
            hex(color)
        ),
        Mark::Image { frame: Rect { x, y, w, h }, pixels, title } => format!(
            "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" \
             href=\"data:image/png;base64,{}\"><title>{}</title></image>",
            short(*x),
            short(*y),
            short(*w),
            short(*h),
            base64(&raster::encode_pixels(pixels)?),
            escape(title)
        ),
        Mark::Text { text, at: (x, y), size, align, color } => {
            let (anchor, turn) = match align {
                Align::Left => ("start", String::new()),
                Align::Center => ("middle", String::new()),
                Align::Right => ("end", String::new()),
                Align::Turned => {
                    ("middle", format!(" transform=\"rotate(-90 {} {})\"", short(*x), short(*y)))
                }
            };
            format!(
                "<text x=\"{}\" y=\"{}\" font-size=\"{}\" text-anchor=\"{anchor}\" fill=\"{}\"{turn}>{}</text>",
                short(*x),
                short(y + BASELINE * size),
                short(EM * size),
                hex(*color),
                escape(text)
            )
        }
    })
}

/// Hundredths of a pixel.
fn short(x: f32) -> String {
    let text = format!("{x:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn hex([r, g, b]: Color) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Text as XML and HTML have it, also within quotes.
pub(crate) fn escape(text: &str) -> String {
    printable(text).chars().fold(String::new(), |mut escaped, c| {
        match c {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            c => escaped.push(c),
        }
        escaped
    })
}

/// RFC 4648, section 4.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let word =
            chunk.iter().fold(0u32, |word, &byte| word << 8 | u32::from(byte)) << (8 * (3 - chunk.len()));
        for k in 0..4 {
            let digit = char::from(DIGITS[(word >> (18 - 6 * k) & 63) as usize]);
            let _ = text.write_char(if k <= chunk.len() { digit } else { '=' }); // a String takes anything
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// RFC 4648, section 10.
    #[test]
    fn base64_has_the_vectors_of_its_standard() {
        let vectors = [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")];
        vectors.iter().for_each(|(plain, text)| assert_eq!(base64(plain.as_bytes()), *text));
    }
}
