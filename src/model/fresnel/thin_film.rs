//! A thin film on a base, of one channel of linear sRGB: Belcour & Barla 2017, "A Practical Extension to Microfacet
//! Theory for the Modeling of Varying Iridescence", as KHR_materials_iridescence approximates it (ratified 2022,
//! "Iridescence Fresnel"). Twin of `shaders/fresnel/thin_film.wgsl`.
//!
//! Light that the film reflects (R12) interferes with what the base reflects (R23) after m turns within the film. With
//! Schlick's reflectances at both interfaces, phases of 0 or π, T = 1 − R12 and the path o = 2 η d cosθ₂:
//!
//! ```text
//! I = R12 + Rs + 2 (Rs − T) Σ_m √(R12 R23)ᵐ S(m o, m φ),  m = 1, 2,  Rs = T² R23/(1 − R12 R23)
//! S(o, φ) = Σ_k w_k cos(2π p_k o + φ) exp(−(2π o)² v_k),  φ = π, or 2π where the base is the thinner
//! F = (I + √(I² + ε²))/2,  ε = 1/256
//! ```
//!
//! S is the Fourier transform of the eye's response over wave numbers, four Gaussians k that are summed into linear sRGB
//! (Rec. 709).
//!
//! | parameter | range | unit | default | what it is |
//! |---|---|---|---|---|
//! | `thickness` | [0, 2000] | nm | 400 | the film's thickness d |
//! | `film_eta` | [1, 3] | | 1.3 | the film's index η over that of what is outside |
//! | `f0` | [0, 1] | | 0.04 | what the base reflects at normal incidence without a film, for R, G and B |
//! | `channel` | [0, 2] | | its own in R, G and B; of a basis 1 | 0 is R, 1 is G, 2 is B, between them their mix |
//! | `specular` | [0, 1] | | 1 | what weighs F, as iridescenceFactor does: the base's Schlick has the rest |
//!
//! **Where it is not the specification's, on purpose.** I of the red channel is as low as −0.2, where a colour is out of
//! Rec. 709's gamut (green's and blue's stay above 0), and renderers take max(I, 0): no f32 keeps digits of what crosses
//! 0, and no rule of few nodes converges at a kink. F is above that by ε/2 = 0.002 where I = 0, and by ε²/4I elsewhere,
//! 1e-4 at 0.04. And R12 R23 is not clamped to [1e-5, 0.9999]: F differs by 0.011 at most, only where an interface all
//! but vanishes.
//!
//! **What the specification does, and physics does not.** F reaches 1.283 in R and 1.059 in G and B, near 85° over a
//! bright base: the response to white is (1.205, 0.948, 0.910) in Rec. 709 while the mean over phases is taken as white.
//! A film of index 1, which d → 0 is too (by a smoothstep over 0.03 nm), still has Schlick's reflectance x⁵: without a
//! film F is the base's at normal incidence alone, F0 and the specification's 1e-4 more, and some 0.17 in place of 0.07 at
//! 60° over glass. F jumps at all other angles where η passes the base's index.
//!
//! Limits: d → ∞ is the mean over phases, R12 + Rs, without colour from some 2000 nm on; F → 1 at grazing. A film with
//! η < 1.1 and d > 300 nm is refused: towards grazing it swings faster than any tolerance is kept at.
//!
//! Promises: all of a microfacet model's but energy, of which it may gain 0.29. Integrals keep tolerances down to 1e-6;
//! where F of the red channel dips through 0, finer ones are not kept. Values: see `FILM_F32`.

use crate::base::tolerance::decade;
use crate::model::fresnel::{AsPolynomial, Fresnel, FresnelCounts};
use crate::model::parameters::{Parameters, Setting};
use crate::model::{Component, Parameter, SlopeCounts, Term, part};
use std::cell::Cell;
use std::f64::consts::{FRAC_PI_2, TAU};

pub(crate) struct ThinFilm;

const THICKNESS: usize = 4;
const FILM_ETA: usize = 5;
const F0: usize = 6;
const CHANNEL: usize = 7;

impl Fresnel for ThinFilm {
    const TERM: Term = Term {
        name: "thin-film",
        summary: "iridescence of a thin film, one channel of linear sRGB",
        source: "Belcour & Barla 2017 as in KHR_materials_iridescence",
        part: part!("fresnel/thin_film", "elementary"),
    };
    const COMPONENTS: &'static [Component] = &Component::SPECULAR;
    const BOUND: f64 = 1.29;
    const VALUE_F32: f64 = FILM_F32;
    /// On the far side ωi·ωm keeps away from 0, where F changes the most. In √μ, F has twice its degree, for which so many
    /// nodes are exact.
    const COUNTS: Option<FresnelCounts> = Some(FresnelCounts {
        near: |schlick, s, tolerance| more(schlick, degree(s, tolerance), NEAR),
        far: |schlick, s, tolerance| more(schlick, degree(s, tolerance), FAR),
        mean_nodes: degree,
    });
    const AS_POLYNOMIAL: Option<AsPolynomial> = Some(AsPolynomial {
        degree,
        // Measured for stretched lobes (`tolerances_are_kept` in `fresnel_series.rs`): azimuths need no more, and 0.2 of
        // the degree are 1.6 times a tolerance off.
        counts: |schlick, degree| {
            schlick.map(|s| SlopeCounts { nodes: s.nodes + (2 * degree).div_ceil(5), ..s })
        },
    });
    const PARAMETERS: &'static [Parameter] = &[
        Parameter {
            name: "thickness",
            summary: "the film's thickness",
            unit: "nm",
            range: [0.0, 2000.0],
            default: Some(400.0),
            place: THICKNESS,
        },
        Parameter {
            name: "film_eta",
            summary: "the film's index of refraction, over that of the medium outside",
            unit: "",
            range: [1.0, 3.0],
            default: Some(1.3),
            place: FILM_ETA,
        },
        Parameter {
            name: "f0",
            summary: "reflectance at normal incidence of what is below the film, had it none",
            unit: "",
            range: [0.0, 1.0],
            default: Some(0.04),
            place: F0,
        },
        Parameter {
            name: Parameter::CHANNEL,
            summary: "whose reflectance it is: 0 is R, 1 is G and 2 is B, as R, G and B of a material have it",
            unit: "",
            range: [0.0, 2.0],
            default: Some(1.0),
            place: CHANNEL,
        },
    ];

    /// 2 η d in µm, η² − 1 and (η₃ − η)/(η₃ + η) in place of d, η and F0.
    fn derive(parameters: &mut Parameters) {
        [parameters[THICKNESS], parameters[FILM_ETA], parameters[F0]] = film(parameters);
    }

    fn refused(parameters: &Parameters) -> Option<&'static str> {
        let faint = parameters[FILM_ETA] < 1.1 && parameters[THICKNESS] > 300.0;
        faint.then_some(
            "a film of film_eta < 1.1 and more than 300 nm swings faster towards grazing than any tolerance is kept \
             at; give a film_eta of 1.1 or more, or a thinner film",
        )
    }

    #[inline(never)]
    fn fresnel(c: f64, x: f64, s: &Setting) -> [f64; 2] {
        let [path, e, step] = film(&s.parameters);
        let n2 = 1.0 + e;
        let above = e / (1.0 + n2.sqrt()).powi(2);
        let c2 = ((e + c * c) / n2).sqrt();
        let x2 = x * (1.0 + c) / (n2 * (1.0 + c2));
        let t12 = (1.0 - above * above) * transmitted(c, x);
        let t23 = (1.0 - step) * (1.0 + step) * transmitted(c2, x2);
        let r12 = above * above + (1.0 - above * above) * x.powi(5);
        let r23 = step * step + (1.0 - step) * (1.0 + step) * x2.powi(5);
        let share = r23 * t12 / (t12 + r12 * t23).max(NOTHING);
        let r = (r12 * r23).sqrt();
        let o = path * c2;
        let (mut s1, mut s2) = (0.0, 0.0);
        for (k, w) in sensitivity(s.parameters[CHANNEL]).into_iter().enumerate() {
            let (cosine, decay) = ((TAU * PEAK[k] * o).cos(), (-WIDTH[k] * o * o).exp());
            s1 += w * cosine * decay;
            s2 += w * (2.0 * cosine * cosine - 1.0) * decay.powi(4);
        }
        let swing = 2.0 * t12 * (1.0 - share) * r * (if step < 0.0 { -s1 } else { s1 } - r * s2);
        [positive(r12 + t12 * share + swing), 0.0]
    }
}

/// The most that F takes beyond Schlick's where cos φ > 0, and where it is < 0.
const NEAR: SlopeCounts = SlopeCounts { azimuths: 110, nodes: 150 };
const FAR: SlopeCounts = SlopeCounts { azimuths: 30, nodes: 40 };

/// What F takes beyond Schlick's, by its degree in c. Measured over all parameters: shares of the degree, and not more
/// than `most`, as what turns sharply in c is averaged over azimuths. In sixteens, so that few rules differ.
fn more(schlick: SlopeCounts, degree: usize, most: SlopeCounts) -> SlopeCounts {
    let share = |of: f64, most: usize| ((of * degree as f64) as usize).min(most);
    SlopeCounts {
        azimuths: schlick.azimuths + share(0.6, most.azimuths),
        nodes: (schlick.nodes + share(0.8, most.nodes)).next_multiple_of(16),
    }
}

/// The degree of the polynomial in c that F is, within a tolerance.
fn degree(s: &Setting, tolerance: f64) -> usize {
    LAST.with(|last| {
        let (parameters, degrees) = last.get();
        if parameters == s.parameters {
            return degrees[decade(tolerance)];
        }
        let degrees = degrees_of(s);
        last.set((s.parameters, degrees));
        degrees[decade(tolerance)]
    })
}

thread_local! {
    /// What was asked for last, as it is asked for again at each texel of a table.
    static LAST: Cell<(Parameters, [usize; 10])> = const { Cell::new(([f64::NAN; 8], [0; 10])) };
}

/// The degrees for 1e-1 … 1e-10: from where on the coefficients of F in Chebyshev polynomials of c add up to less.
fn degrees_of(s: &Setting) -> [usize; 10] {
    let quarter = |k: usize| FRAC_PI_2 * k as f64 / POINTS as f64;
    let cosines: Vec<f64> = (0..4 * POINTS).map(|k| quarter(k).cos()).collect();
    // cos²(ψ/2) = (1 + cos ψ)/2 at the zeros of the polynomial of degree POINTS.
    let half_angles = (0..POINTS).map(|k| 0.5 * quarter(2 * k + 1));
    let values: Vec<f64> =
        half_angles.map(|half| ThinFilm::fresnel(half.cos().powi(2), half.sin().powi(2), s)[0]).collect();
    let mut rest = 0.0;
    let mut degrees = [0; 10];
    for n in (1..POINTS / 2).rev() {
        let cosine = |k: usize| cosines[n * (2 * k + 1) % (4 * POINTS)];
        let sum: f64 = values.iter().enumerate().map(|(k, f)| f * cosine(k)).sum();
        rest += (2.0 * sum / POINTS as f64).abs();
        for (decade, degree) in degrees.iter_mut().enumerate() {
            if *degree == 0 && rest > 10f64.powi(-1 - decade as i32) {
                *degree = n;
            }
        }
    }
    degrees
}

/// Twice the largest degree that is told.
const POINTS: usize = 512;

/// 2 η d in µm, η² − 1 and (η₃ − η)/(η₃ + η), η₃ being the base's index.
///
/// η tends to 1 as d → 0, by the specification's smoothstep over 0.03 nm; η₃ = (1 + s)/(1 − s) with s² = F0 + 1e-4, the
/// specification's guard, which needs no more than s ≤ 1 where η₃ is not divided out.
fn film(parameters: &Parameters) -> [f64; 3] {
    let t = (parameters[THICKNESS] / FADE).min(1.0);
    let over = (parameters[FILM_ETA] - 1.0) * t * t * (3.0 - 2.0 * t); // η − 1
    let eta = 1.0 + over;
    let s = (parameters[F0] + GUARD).min(1.0).sqrt();
    let step = ((1.0 + s) - eta * (1.0 - s)) / ((1.0 + s) + eta * (1.0 - s));
    [2e-3 * eta * parameters[THICKNESS], over * (1.0 + eta), step]
}

/// 1 − x⁵ for c = 1 − x.
fn transmitted(c: f64, x: f64) -> f64 {
    let x2 = x * x;
    c * (1.0 + x + x2 * (1.0 + x + x2))
}

/// (I + √(I² + ε²))/2.
fn positive(i: f64) -> f64 {
    let sum = i.abs() + (i * i + FLOOR * FLOOR).sqrt();
    0.5 * if i < 0.0 { FLOOR * FLOOR / sum } else { sum }
}

/// What the channel weighs the four Gaussians with; between two channels, their mix.
fn sensitivity(channel: f64) -> [f64; 4] {
    let (r, b) = ((1.0 - channel).max(0.0), (channel - 1.0).max(0.0));
    std::array::from_fn(|k| r * RED[k] + (1.0 - r - b) * GREEN[k] + b * BLUE[k])
}

/// What it adds to the relative error of values in f32. Roundings leave I off by 36 u, u = 2⁻²⁴, measured over 6·10⁶ films
/// and angles: ten of the phase, 2π times the turns that the response lets be seen (τ exp(−aτ²) ≤ 1.85), under weights of
/// the red channel of 5.3 in all; and c by as much as that of a value is off. F'/F = 1/√(I² + ε²) ≤ 256 where F is the
/// least: 32 u of I count 256 times. Measured, both together: 4826 u in R, 304 u in G.
const FILM_F32: f64 = 32.0 * 256.0 / (1 << 24) as f64;

/// Where the film's index is its own, nm.
const FADE: f64 = 0.03;
/// What is added to F0, of the specification.
const GUARD: f64 = 1e-4;
/// ε of [`positive`]
const FLOOR: f64 = 1.0 / 256.0;

/// The eye's response to wave numbers, x̄ as two Gaussians, ȳ and z̄ as one each: turns of the phase in 1 µm of path,
/// (2π)² of their variance in µm⁻², and their weights in linear sRGB.
const PEAK: [f64; 4] = [1.681, 1.7953, 2.2084, 2.2399];
const WIDTH: [f64; 4] = [0.17085469570813808, 0.3673308844415041, 0.2610352450417717, 0.1787661705960513];
const RED: [f64; 4] = [2.743336128642896, -1.5374795811707604, -0.4990909943782536, 0.49860320008640424];
const GREEN: [f64; 4] = [-0.8205709051728567, 1.8764270747599021, 0.0416026460166455, -0.14913931798046975];
const BLUE: [f64; 4] = [0.047107146134183334, -0.2040711720381654, 1.0584119201914826, 0.008561755726616296];
/// Far below any T but that of grazing, where 0/0 is 0.
const NOTHING: f64 = 1e-18;
