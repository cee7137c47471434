//! The colour map of the previews.

use crate::io::draw::canvas::Color;

/// Viridis (van der Walt and Smith, 2015, CC0), which the eye sees as even steps, also without colour
/// vision or in print: a polynomial of degree 6 for each of R, G and B, fitted by Matt Zucker
/// (shadertoy.com/view/WlfXRN, CC0), within 0.01 of the original table.
pub(crate) fn viridis(t: f64) -> Color {
    const C: [[f64; 3]; 7] = [
        [0.277_727_327_223_417_7, 0.005_407_344_544_966_578, 0.334_099_805_335_306_1],
        [0.105_093_043_108_577_4, 1.404_613_529_898_575, 1.384_590_162_594_685],
        [-0.330_861_828_725_556_3, 0.214_847_559_468_213, 0.095_095_163_028_236_59],
        [-4.634_230_498_983_486, -5.799_100_973_351_585, -19.332_440_956_279_87],
        [6.228_269_936_347_081, 14.179_933_366_805_09, 56.690_552_600_681_05],
        [4.776_384_997_670_288, -13.745_145_377_746_01, -65.353_032_633_372_34],
        [-5.435_455_855_934_631, 4.645_852_612_178_535, 26.312_435_249_583_2],
    ];
    let t = t.clamp(0.0, 1.0);
    std::array::from_fn(|i| {
        let value = C.iter().rev().fold(0.0, |sum, c| sum * t + c[i]);
        (value * 255.0).round() as u8 // `as` saturates, and NaN gives 0
    })
}
