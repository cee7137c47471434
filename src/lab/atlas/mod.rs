//! The error atlas: what f32 on a device loses against the f64 reference, for every model that has values,
//! over (θi, θe, δφ) and α with all their extremes; and, as a [`study()`], what the field's published forms
//! of the GGX term lose.
//!
//! ```text
//! relative error = |f − f64| / max(f64, floor)        ULP = |f − f64| / spacing of f32 at max(f64, floor)
//! reciprocity    = |f(ωi, ωe) − f(ωe, ωi)| / max of both
//! ```
//!
//! of each component (A, what F0 weighs, and B, what F90 does). The floor is 1e-30 sr⁻¹, or 2⁻¹⁰⁰ of A + B:
//! below it f32 runs out of exponents.
//!
//! There is no search as in [`verify`](crate::verify): rounding is noise in the digits of an input and has
//! no slope to climb. The number of inputs decides how far the tail of it is seen.

mod band;
mod directions;
mod map;
pub(crate) mod picture;
mod study;
mod write;

pub use band::{Band, WorstInput};
pub use map::ErrorMap;
#[cfg(feature = "cli")]
pub(crate) use study::STEPS;
pub use study::{OWN, ROUNDED, study};
pub use write::{to_json, write};

use crate::bake::points::Points;
use crate::bake::{Evaluator, Observer};
use crate::base::angles::Angles;
use crate::base::error::{Error, Result};
use crate::base::precision::VALUE_F32;
use crate::check::{reference_angles, reference_of_model, reference_parameters};
use crate::model::Model;
use crate::model::lobe::Lobe;
use band::{BandSubject, BandTally, measure};
use gonio_reference::Setting;
use serde::Serialize;

/// Where decades of α begin, and the end of the last.
pub const DECADES: [f64; 7] = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0];
/// α in each decade, evenly in log α from its beginning; 0.5 and 1 are with the last.
const PER_DECADE: i32 = 8;

/// Values of a model that an atlas looks at unless told otherwise.
pub const DEFAULT_BUDGET: u64 = 4_000_000;

/// The largest relative error that a value of a model may have at an α: its own budget, where that is more than
/// most models'. Else, were all roundings to meet at their largest, 2.4e-6 ([`VALUE_F32`]); that they do
/// not, as their signs are chance, makes 2e-6. Where α < 1e-4 there is room for devices whose divisions are off
/// by 2.5 ULP in place of a half, as WGSL allows.
pub fn promise(model: &Model, alpha: f64) -> f64 {
    let most = if alpha >= 1e-4 { 2e-6 } else { 1e-5 };
    if model.value_f32 > VALUE_F32 { model.value_f32 } else { most }
}

/// What an exchange of ωi and ωe may change, relative: a driver that contracts a·b + c rounds one of its two
/// products and not the other, which is which changes, and all else is the same. Without contraction nothing
/// changes, bit for bit.
pub const RECIPROCITY: f64 = 1e-6;

/// What its pages are of, and its files are called.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PageKind {
    /// Models.
    Atlas,
    /// Published forms of the GGX term.
    Study,
}

impl PageKind {
    /// Its files' name, without the extension.
    pub fn name(self) -> &'static str {
        match self {
            Self::Atlas => "atlas",
            Self::Study => "study",
        }
    }
}

/// A page: one subject.
#[derive(Debug, Clone, Serialize)]
pub struct Page {
    /// The model, or the form.
    pub subject: String,
    /// Author, year, equation.
    pub source: String,
    /// The decades of α; one band where there is none.
    pub decades: Vec<Band>,
    /// The same for each α.
    pub alphas: Vec<Band>,
    /// Where over the hemispheres; not of a study's forms.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub map: Option<ErrorMap>,
}

impl Page {
    /// The band with the largest error.
    pub fn worst(&self) -> Option<&Band> {
        self.decades.iter().reduce(|worst, band| if band.max > worst.max { band } else { worst })
    }

    /// Whether every promise is kept.
    pub fn is_kept(&self) -> bool {
        self.decades.iter().all(Band::is_kept)
    }
}

/// Measures a model: about `budget` values, and those of the exchanged directions.
///
/// # Errors
/// When it is a delta or has no reference, or the device fails, or the observer stops it.
pub fn measure_model(
    evaluator: &Evaluator,
    model: &'static Model,
    budget: u64,
    observer: &dyn Observer,
) -> Result<Page> {
    if model.is_delta() {
        return Err(Error::input(format!(
            "{} is a delta and has no values; its integrals are exact",
            model.name
        )));
    }
    let reference = reference_of_model(model).ok_or_else(|| {
        Error::input(format!("{} has no f64 reference, so that nothing is known of its error", model.name))
    })?;
    let unit = [[1.0, 0.0], [0.0, 1.0]];
    let channels = model.components.len();
    let lobe = Lobe::new(model, model.shape.map(|_| 1.0), unit[..channels].to_vec())?;
    let parameters = reference_parameters(model, &lobe.parameters())
        .map_err(|why| Error::input(format!("{}: {why}", model.name)))?;
    let mut points = Points::new(evaluator, &[lobe])?;
    let name = |channel: usize, alpha: f64| {
        // The component alone, in the words of gonio eval.
        let weight = |(k, component): (usize, &crate::model::Component)| {
            format!(" --set {}={}", component.weight, u8::from(k == channel))
        };
        let weights: String = model.components.iter().enumerate().map(weight).collect();
        let alpha = model.shape.map_or(String::new(), |shape| format!(" --set {}={alpha:?}", shape.name));
        format!("--model {}{alpha}{weights}", model.name)
    };
    let mut subject = BandSubject {
        channels,
        evaluate: &mut |alphas, angles, values| points.sweep(alphas, angles, values),
        reference: &|angles: &Angles, alpha| {
            let setting = Setting::measured(reference.measure(), alpha, &parameters).ok();
            let f = setting.and_then(|setting| reference.brdf(&reference_angles(angles), &setting));
            f.unwrap_or([f64::NAN; 2])
        },
        name: &name,
        faint: model.faint().unwrap_or(0.0),
    };
    // A model without a shape has the same values at each; wide lobes have no decades.
    let alphas = match model.shape {
        None => vec![1.0],
        Some(shape) => {
            let scaled = alphas().into_iter().map(|alpha| shape.most * alpha);
            scaled.filter(|&alpha| alpha >= shape.least && alpha == shape.taken(alpha)).collect()
        }
    };
    let angles = directions::everywhere((budget as usize / (alphas.len() * channels)).max(1));
    let tallies = measure(&mut subject, &alphas, &angles, &|share| observer.advance(0.9 * share))?;

    let alpha_of = |alpha| model.shape.map(|_| alpha);
    let mut page = page(model.name, model.source, &alphas, tallies, Some(model));
    if model.shape.is_none() {
        page.alphas.clear();
        page.decades.iter_mut().for_each(|band| band.alpha = None);
    }
    let worst = page.worst().and_then(|band| band.worst.as_ref()).map_or(1.0, |worst| worst.alpha);
    page.map = Some(map::measure(&mut subject, worst, alpha_of(worst))?);
    observer.advance(0.1)?;
    Ok(page)
}

/// Every α of the atlas.
fn alphas() -> Vec<f64> {
    let decade =
        |&low: &f64| (0..PER_DECADE).map(move |j| low * 10f64.powf(f64::from(j) / f64::from(PER_DECADE)));
    let mut alphas: Vec<_> = DECADES[..6].iter().flat_map(decade).chain([0.5, 1.0]).collect();
    alphas.sort_by(f64::total_cmp);
    alphas
}

/// Bands of each α and of each decade.
fn page(
    subject: &str,
    source: &str,
    alphas: &[f64],
    tallies: Vec<BandTally>,
    promised: Option<&Model>,
) -> Page {
    let band = |range: [f64; 2], tally: &BandTally| {
        tally.band(range, promised.map(|model| promise(model, range[0])))
    };
    let each = alphas.iter().zip(&tallies).map(|(&alpha, tally)| band([alpha; 2], tally)).collect();
    let last = DECADES.len() - 2;
    let decade = |k: usize| {
        let [low, high] = [DECADES[k], DECADES[k + 1]];
        let inside = |alpha: f64| low <= alpha && (alpha < high || k == last);
        let tallies =
            alphas.iter().zip(&tallies).filter(|&(&alpha, _)| inside(alpha)).map(|(_, tally)| tally);
        BandTally::sum(tallies).map(|tally| band([low, high], &tally))
    };
    let decades = (0..=last).filter_map(decade).collect();
    Page { subject: subject.into(), source: source.into(), decades, alphas: each, map: None }
}
