//! What an engine loses: the published forms of the GGX term in f32, from unit vectors, run on the device as
//! they are written, against the f64 reference of D·V at the angles that were meant.
//!
//! Two things are lost. Rounding a unit vector to f32 turns it by up to 1e-7 rad, which a lobe of that
//! width cannot bear, whatever the formula; the row [`ROUNDED`] has that alone, all else in f64. And the
//! formulas lose what they cancel. This project's own evaluation, from angles, has neither.

use crate::backend::gpu::INSTALL;
use crate::bake::points::Points;
use crate::bake::{Evaluator, Observer};
use crate::base::angles::Angles;
use crate::base::error::{Error, Result};
use crate::check::{reference_angles, reference_of_model};
use crate::lab::atlas::band::{BandSubject, measure};
use crate::lab::atlas::{DECADES, Page, alphas, directions, page};
use crate::model;
use crate::model::lobe::Lobe;
use crate::verify::user_shader::{UserFunction, UserShader};
use crate::verify::{ParameterRange, Subject as _, Symmetry};
use gonio_reference::{Parameters, Setting};
use std::f64::consts::PI;

/// The row of directions that are rounded to f32, and nothing else.
pub const ROUNDED: &str = "rounded directions, rest in f64";
/// The row of this project's evaluation.
pub const OWN: &str = "gonio, from angles";

/// A published form: its name, who has it, and its WGSL.
struct Form {
    name: &'static str,
    source: &'static str,
    wgsl: &'static str,
}

/// A form from its file below `shaders/study/`.
macro_rules! form {
    ($name:literal, $file:literal, $source:literal) => {
        Form {
            name: $name,
            source: $source,
            wgsl: concat!(
                include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/study/", $file, ".wgsl")),
                include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/study/brdf.wgsl"))
            ),
        }
    };
}

const FORMS: [Form; 7] = [
    form!("acos(n·h)", "half_angle", "Rusinkiewicz 1998; MERL BRDFRead.cpp"),
    form!("NoH²(α²−1)+1", "noh2", "Karis 2013; three.js, D_GGX"),
    form!("(NoH α²−NoH)NoH+1", "mad", "Karis 2013; Unreal Engine, BRDF.ush, D_GGX"),
    form!("tan²θm = (1−cos²)/cos²", "tan2", "Walter et al. 2007, eq. 33; pbrt-v4, scattering.h"),
    form!("1−NoH²", "one_minus_noh2", "Filament (desktop) and Bevy, D_GGX"),
    form!("|n×h|²", "cross", "Filament (mobile), D_GGX"),
    form!("h.x, h.y, h.z", "components", "Burley 2012, appendix B; Mitsuba 3, microfacet.h"),
];

/// Steps of an observer.
#[cfg(feature = "cli")]
pub(crate) const STEPS: usize = FORMS.len() + 2;

/// A page, without a map, for each form; then for the rounding alone, and for this project's evaluation.
/// Inputs are pairs that a lobe reflects into each other, θ up to 89.9°: about `budget` values
/// of each.
///
/// # Errors
/// On the CPU path, which runs no WGSL; when the device fails, or the observer stops it.
pub fn study(evaluator: &Evaluator, budget: u64, observer: &dyn Observer) -> Result<Vec<Page>> {
    let Evaluator::Device(device) = evaluator else {
        return Err(Error::Device(format!("the study runs WGSL, and needs a Vulkan device. {INSTALL}")));
    };
    let mut forms = Vec::new();
    for Form { name, source, wgsl } in FORMS {
        observer.begin(&format!("study of {name}"));
        let function = UserFunction::parse(name, wgsl, "brdf")?;
        let alpha = ParameterRange::new("alpha", DECADES[0], 1.0)?;
        let symmetry = Symmetry { isotropic: true, bilateral: true };
        let mut shader = UserShader::new(device, function, vec![alpha], false, symmetry)?;
        let evaluate =
            |alpha: f64, angles: &[Angles], values: &mut Vec<f32>| shader.evaluate(&[alpha], angles, values);
        forms.push(form(name, source, budget, evaluate, observer)?);
    }
    observer.begin("study of rounded directions");
    let rounded = |alpha: f64, angles: &[Angles], values: &mut Vec<f32>| {
        values.extend(angles.iter().map(|angles| of_rounded(angles, alpha) as f32));
        Ok(())
    };
    forms.push(form(ROUNDED, "what any formula of f32 unit vectors starts from", budget, rounded, observer)?);
    observer.begin("study of angles");
    let model = model::find("ggx")?;
    // F0 = F90 = 1: no Fresnel.
    let mut points = Points::new(evaluator, &[Lobe::new(model, Some(1.0), vec![[1.0; 2]])?])?;
    let own = |alpha: f64, angles: &[Angles], values: &mut Vec<f32>| points.sweep(&[alpha], angles, values);
    forms.push(form(OWN, "shaders/pair.wgsl", budget, own, observer)?);
    Ok(forms)
}

fn form(
    name: &str,
    source: &str,
    budget: u64,
    mut evaluate: impl FnMut(f64, &[Angles], &mut Vec<f32>) -> Result<()>,
    observer: &dyn Observer,
) -> Result<Page> {
    let alphas = alphas();
    let ggx = reference_of_model(model::find("ggx")?)
        .ok_or_else(|| Error::Internal("ggx has no reference".into()))?;
    let per_alpha = (budget as usize / alphas.len()).max(1);
    let mut subject = BandSubject {
        channels: 1,
        evaluate: &mut |alphas, angles, values| {
            values.clear();
            evaluate(alphas[0], angles, values)
        },
        reference: &|angles, alpha| {
            let setting = Setting::measured(ggx.measure(), alpha, &Parameters::DEFAULT).ok();
            let f = setting.and_then(|setting| ggx.brdf(&reference_angles(angles), &setting));
            f.map_or([f64::NAN; 2], |[a, b]| [a + b, 0.0])
        },
        name: &|_, alpha| format!("--model ggx --set alpha={alpha:?} --set f0=1 --set f90=1"),
        faint: 0.0,
    };
    let mut tallies = Vec::new();
    for &alpha in &alphas {
        // A lobe's pairs are of its own α.
        let angles = directions::in_the_lobe(alpha, per_alpha);
        tallies.extend(measure(&mut subject, &[alpha], &angles, &|_| Ok(()))?);
        observer.advance(1.0 / alphas.len() as f64)?;
    }
    Ok(page(name, source, &alphas, tallies, None))
}

/// D·V in f64 of the directions as f32 has them, by the components of h: no form can know better.
fn of_rounded(angles: &Angles, alpha: f64) -> f64 {
    let [wi, wo] = crate::verify::user_shader::directions(angles, false).map(|w| w.map(f64::from));
    let h: [f64; 3] = std::array::from_fn(|k| wi[k] + wo[k]);
    let (ht2, hz2) = (h[0] * h[0] + h[1] * h[1], h[2] * h[2]);
    let q = (ht2 + hz2) / (alpha * hz2 + ht2 / alpha);
    let root = |mu: f64| (alpha * alpha + (1.0 - alpha * alpha) * mu * mu).sqrt();
    q * q / PI * 0.5 / (wi[2] * root(wo[2]) + wo[2] * root(wi[2]))
}
