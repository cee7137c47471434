//! The errors that gonio promises, pinned as numbers of the tests' own. The suite takes its budgets from here, and a
//! test at the end compares them with what the code states: a promise that is loosened fails. No number here may
//! grow; where the code has become better, the better one is written here.
//!
//! Errors of values in f32 are relative, and in units of u = 2⁻²⁴, the largest error of one rounding. Each is the
//! count of the roundings that can meet, with the weights with which they do; its derivation stands in a few words
//! beside it and in full in the file of the part. Values below the floor of a lobe are held to their budget times
//! that floor, as f32 loses digits there to underflow or to a difference.

use crate::common::{axis, listed, model};
use gonio::bake::Evaluator;
use gonio::base::precision::{self, Precision};
use gonio::check::{Check, cross_check, reference};
use gonio::model::compensation::Compensation;
use gonio::model::lobe::Lobe;
use gonio::model::parameters::Setting;
use gonio::model::{MICROFACETS, MIRRORS, Model};
use gonio::plan::TablePlan;
use gonio::table::Values;
use gonio::table::axis::Variable::{DeltaPhi, PhiE, PhiI, ThetaE, ThetaI};
use gonio::table::quantity::{BRDF, RHO_DH};
use gonio::verify::{Subject, Sum, Tolerances};
use std::f64::consts::PI;

/// 2⁻²⁴.
const U: f64 = 1.0 / 16_777_216.0;

// ---- For all ---------------------------------------------------------------------------------------

/// Values in f32 of products alone: factors, α and weights round once each; q of D = q²/π five times, squared;
/// G2/(4 μi μe) six; the fifth power of Schlick's Fc, of what rounds four times, twenty; products four.
pub const VALUE_F32: f64 = 40.0 * U;

/// The least absolute tolerance of an integral in f32, for each 1 that ρ reaches: some hundred terms, measured 5e-7.
pub const INTEGRAL_F32: f64 = 1e-6;

/// Of the CPU path, f64 that is stored in f32: one rounding.
pub const STORED_F32: f64 = U;

/// Of the CPU path in f64, where a value has the 40 roundings of `VALUE_F32` in f32; in proportion to these elsewhere.
/// sin θi − sin θe comes from a half sum of angles that is rounded near π/2, where both directions graze.
const VALUE_F64: f64 = 1e-8;

/// Of the f64 reference: values relative, and integrals absolute.
pub const REFERENCE_VALUE: f64 = 1e-12;
pub const REFERENCE_INTEGRAL: f64 = 1e-9;

/// What an exchange of ωi and ωe may change of a value of GGX, relative, where the driver contracts a·b + c: one rounding
/// each in G2's sum and in h's, which D squares twice, is 3e-7; the atlas promises this.
pub const RECIPROCITY: f64 = 1e-6;

/// Of spherical-harmonic coefficients of a map, relative to the largest: in f32 36 roundings of a term, its two factors, the
/// products and the sums of 16 terms and of 16 such sums, times √5, the most that Y is of Y of l = 0; in f64 differences of
/// sines over cells of 16384 columns.
pub const HARMONICS_F32: f64 = 36.0 * 2.236_067_977_499_79 * U;
pub const HARMONICS_F64: f64 = 1e-11;

/// f below which errors are taken relative to it, sr⁻¹: f32 ends at 2⁻¹²⁶ = 1e-38, and D is squared.
pub const FLOOR: f64 = 1e-30;

/// The same of lobes about an axis that is not the normal: cos γ is a difference there, and known absolutely.
const AXIS_FLOOR: f64 = 1e-3;

// ---- Models and parts ------------------------------------------------------------------------------

/// What is promised of the lobes of a distribution of normals, or of a model that is made of no parts.
struct Promise {
    name: &'static str,
    /// The relative error of its values in f32, in u.
    roundings: f64,
    /// The least tolerance of its integrals in f32, for each 1 that ρ reaches.
    integral: f64,
    /// The energy that it reflects at most, max(A + B); of a distribution with Smith's masking of its own.
    energy: f64,
    /// As [`FLOOR`], where digits are lost earlier.
    floor: f64,
}

const fn promise(name: &'static str, roundings: f64, energy: f64) -> Promise {
    Promise { name, roundings, integral: INTEGRAL_F32, energy, floor: FLOOR }
}

/// The models that are made of no parts.
const MODELS: [Promise; 17] = [
    promise("lambert", 40.0, 1.0),
    promise("gltf_diffuse", 40.0, 1.0),
    promise("gltf_oren_nayar", 40.0, 1.0),
    // A + B/2 where ωi grazes, 1.01512 at σ = 0.2.
    promise("oren-nayar", 40.0, 1.0152),
    promise("fujii", 40.0, 1.0),
    promise("eon", 40.0, 1.0),
    // 785/504 where ωi grazes and the roughness is 1.
    promise("burley", 40.0, 1.5576),
    // 785/(504 · 1.51).
    promise("frostbite", 40.0, 1.0315),
    // 1.5126 where ωi grazes and the roughness is 1.
    promise("disney-subsurface", 40.0, 1.5127),
    promise("disney-sheen", 40.0, 1.0),
    // 40, and five of the exponent tan²θm/α², which is 128 at most where f > FLOOR. ρ grows as 1/√μ.
    promise("ward", 680.0, f64::INFINITY),
    promise("ward-dur", 680.0, 1.0),
    // 40, and fourteen of the exponent n/2 ln(1 + tan²θm): four of n, four of tan²θm, six of the logarithm; of 128.
    promise("blinn", 1832.0, 1.0),
    promise("ashikhmin-shirley", 1832.0, 1.0),
    promise("ashikhmin-shirley-diffuse", 40.0, 1.0),
    // 40; seventeen of the exponent −n ln cos γ, which is 34 at most: four of n, seven of the cosines, six of the
    // logarithm; and four of cos γ, a difference, where n = 1: 4 · 3/(2π) over the floor.
    Promise { floor: AXIS_FLOOR, ..promise("phong", 2_527.859_317_102_744, 1.0) },
    Promise { floor: AXIS_FLOOR, ..promise("lafortune", 2_527.859_317_102_744, 1.0) },
];

/// The distributions of normals.
const NORMALS: [Promise; 8] = [
    promise("ggx", 40.0, 1.0),
    // 40, and five of the exponent tan²θm/α² ≤ 128.
    promise("beckmann", 680.0, 1.0),
    // 60 and 12 of the ratio of the α, here 1: see `ratio_of_alphas`.
    promise("ggx-anisotropic", 72.0, 1.0),
    // 700 and 730 of the ratio.
    promise("beckmann-anisotropic", 1430.0, 1.0),
    // 40, and nine of the exponent γ ln(1 + …) ≤ 128: four of the quotient, four of the logarithm, one of γ. All values
    // of an integral share the peak's ten roundings. (1 − α)/(α ln 1/α) at γ = 1 and α = 1/1000.
    Promise { integral: INTEGRAL_F32 + 10.0 * U, ..promise("gtr", 1192.0, 144.63) },
    // 40; ten of the exponent γ ln(1 + …), which is 192 at most, as D has 1/(α² cos⁴θm) before its power: four of the
    // quotient, four of the logarithm, two of γ; and 45 of Λ, measured, which an integral's fixed direction has too.
    Promise { integral: INTEGRAL_F32 + 45.0 * U, ..promise("student-t", 2005.0, 1.0) },
    // 40, and eleven of the exponent: four of its quotient, four of the logarithm, three of p. √π at α = 1.
    promise("blinn-phong", 1448.0, 1.7725),
    // 40; nine of D's exponent ≤ 128; of Λ's, 3.4 · 4 · 6.3 = 86 and six of 20 to 40, 180. An integral's fixed direction
    // has one Λ, six roundings of 2⁻²⁰. |h|² sin²θm underflows at 1e-19 of |h|.
    Promise { integral: INTEGRAL_F32 + 96.0 * U, floor: 1e-13, ..promise("charlie", 1458.0, 8.98) },
];

/// The energy with other maskings, where it is not 1: measured at the worst α where one direction grazes.
const ENERGY: [(&str, &str, f64); 24] = [
    ("ggx", "disney-clearcoat", 3.438),
    ("beckmann", "disney-clearcoat", 2.181),
    ("ggx-anisotropic", "disney-clearcoat", 22.56),
    ("beckmann-anisotropic", "disney-clearcoat", 18.3),
    ("ggx-anisotropic", "ashikhmin-neubelt", 5.0),
    ("beckmann-anisotropic", "ashikhmin-neubelt", 2.821),
    ("gtr", "smith-separable", 144.63),
    ("gtr", "schlick-ggx", 144.63),
    ("gtr", "disney-clearcoat", 3.438),
    ("gtr", "smith-joint-approx", 144.63),
    ("student-t", "schlick-ggx", 2.80),
    ("student-t", "schlick-ggx-direct", 2.80),
    ("student-t", "ashikhmin-neubelt", 1.40),
    ("student-t", "smith-joint-approx", 2.80),
    ("student-t", "disney-clearcoat", 11.2),
    ("blinn-phong", "smith-separable", 1.345),
    ("blinn-phong", "disney-clearcoat", 3.438),
    ("charlie", "smith-separable", 2.72),
    // k = α/2 vanishes with α, and ρ grows without a bound.
    ("charlie", "schlick-ggx", f64::INFINITY),
    ("charlie", "smith-joint-approx", f64::INFINITY),
    ("charlie", "schlick-ggx-direct", 16.9),
    ("charlie", "ashikhmin-neubelt", 5.67),
    ("charlie", "disney-clearcoat", 19.22),
    // ρ grows as α/μ; with every distribution.
    ("", "none", f64::INFINITY),
];

/// The Fresnel terms: what they add to the roundings that Schlick's has, and what F reaches.
const FRESNEL: [(&str, f64, f64); 7] = [
    ("schlick", 0.0, 1.0),
    ("none", 0.0, 1.0),
    // Their worst case is 29, and Schlick's 24 of 40: by variances within 40 (tests/suite/fresnel.rs).
    ("dielectric", 0.0, 1.0),
    ("conductor", 0.0, 1.0),
    ("f82", 0.0, 1.0),
    // Of x five weigh 5 more at p = 10; six of y = p ln 1/x ≤ 69; three of an exponential, twice.
    ("generalized-schlick", 445.0, 1.0),
    // 32 of I, which F'/F = 256 multiplies where F is the least. 1.283 in R, near 85°.
    ("thin-film", 8192.0, 1.29),
];

const DEFAULT: [&str; 2] = ["smith-correlated", "schlick"];

/// The parts of a model by its name, NORMALS[-MASKING-FRESNEL]; or of a mirror, [-FRESNEL].
struct Parts {
    normals: &'static Promise,
    masking: &'static str,
    fresnel: (f64, f64),
}

const MIRROR: Promise = promise("mirror", 40.0, 1.0);
const NO_FRESNEL: (f64, f64) = (0.0, 1.0);

fn parts(model: &str) -> Option<Parts> {
    let fresnel = |name: &str| {
        FRESNEL.iter().find(|term| term.0 == name).map(|&(_, roundings, energy)| (roundings, energy))
    };
    if let Some(normals) = MODELS.iter().find(|promise| promise.name == model) {
        return Some(Parts { normals, masking: "", fresnel: NO_FRESNEL });
    }
    if let Some(rest) = model.strip_prefix("mirror") {
        let term = if rest.is_empty() { DEFAULT[1] } else { rest.strip_prefix('-')? };
        return Some(Parts { normals: &MIRROR, masking: "", fresnel: fresnel(term)? });
    }
    let normals = NORMALS.iter().filter(|promise| model.starts_with(promise.name));
    let normals = normals.max_by_key(|promise| promise.name.len())?;
    let rest = &model[normals.name.len()..];
    if rest.is_empty() {
        return Some(Parts { normals, masking: DEFAULT[0], fresnel: fresnel(DEFAULT[1])? });
    }
    let maskings = [
        "smith-correlated",
        "smith-separable",
        "smith-joint-approx",
        "schlick-ggx-direct",
        "schlick-ggx",
        "v-cavity",
        "kelemen",
        "ashikhmin-neubelt",
        "disney-clearcoat",
        "none",
    ];
    maskings.into_iter().find_map(|masking| {
        let term = rest.strip_prefix('-')?.strip_prefix(masking)?.strip_prefix('-')?;
        Some(Parts { normals, masking, fresnel: fresnel(term)? })
    })
}

fn parts_of(model: &Model) -> Parts {
    parts(model.name)
        .unwrap_or_else(|| panic!("no promise of {} is pinned in tests/suite/promises.rs", model.name))
}

/// The relative error of a model's values in f32; of two α, where they are equal.
pub fn value_f32(model: &Model) -> f64 {
    let Parts { normals, fresnel, .. } = parts_of(model);
    normals.roundings * U + fresnel.0 * U
}

/// The same at a setting, where it depends on that.
pub fn value_f32_at(model: &Model, setting: &Setting) -> f64 {
    let Parts { normals, fresnel, .. } = parts_of(model);
    let roundings = match normals.name {
        // A component of the tangential half vector is off by 4 √2 roundings of its length, and ht² by as many times half
        // the ratio: D has that twice, or in its exponent.
        "ggx-anisotropic" => 60.0 + 12.0 * ratio_of_alphas(setting),
        "beckmann-anisotropic" => 700.0 + 730.0 * ratio_of_alphas(setting),
        // The exponent is γ ln 1/α² at most.
        "gtr" => 40.0 + 9.0 * (-2.0 * setting.parameters[0] * setting.alpha.ln()).min(128.0),
        // The steepest slope is that of the least cosine.
        "student-t" => {
            let (gamma, alpha) = (setting.parameters[0], setting.alpha);
            let steepest = 1.0 / ((gamma - 1.0) * (alpha * U).powi(2));
            85.0 + 10.0 * (gamma * steepest.ln_1p()).min(192.0)
        }
        _ => normals.roundings,
    };
    roundings * U + fresnel.0 * U
}

/// αx = α √aspect + (1 − α √aspect) strength² and αy = α/√aspect: the larger over the other.
fn ratio_of_alphas(&Setting { alpha, parameters: [aspect, strength, ..] }: &Setting) -> f64 {
    let alpha = if strength > 0.0 { alpha.max(1e-6) } else { alpha };
    let (x, y) = (alpha * aspect.sqrt(), alpha / aspect.sqrt());
    let x = x + (1.0 - x) * strength * strength;
    (x / y).max(y / x)
}

/// The relative error of a model's values on the CPU path in f64.
pub fn value_f64(model: &Model) -> f64 {
    VALUE_F64 * value_f32(model) / VALUE_F32
}

/// f below which a model's errors are relative to it, sr⁻¹.
pub fn floor(model: &Model) -> f64 {
    parts_of(model).normals.floor
}

/// The same of the f64 reference, which does not underflow. It takes δφ, which is rounded to 1e-16: where cos γ of a lobe
/// about an axis is small, f has that absolutely.
pub fn reference_floor(model: &Model) -> f64 {
    if floor(model) == AXIS_FLOOR { AXIS_FLOOR } else { FLOOR }
}

/// The least tolerance of a model's integrals that f32 meets: of what reflects more than 1, as much more.
pub fn integral_f32(model: &Model) -> f64 {
    let energy = energy(model);
    parts_of(model).normals.integral * if energy.is_finite() { energy.max(1.0) } else { 1.0 }
}

/// What ρ_dh of A + B reaches at most; infinite where nothing is promised.
pub fn energy(model: &Model) -> f64 {
    let Parts { normals, masking, fresnel } = parts_of(model);
    let other = ENERGY.iter().find(|row| row.1 == masking && (row.0 == normals.name || row.0.is_empty()));
    let energy = match (other, masking) {
        (Some(row), _) => row.2,
        (None, "" | "smith-correlated") => normals.energy,
        (None, _) => 1.0,
    };
    energy * fresnel.1
}

// ---- What the code states --------------------------------------------------------------------------

/// Every model that can be asked for by name.
fn built_in() -> impl Iterator<Item = &'static Model> {
    gonio::model::MODELS.into_iter().chain(MICROFACETS.iter()).chain(MIRRORS.iter())
}

/// Why a number that the code states is not the pinned one, if it is not: up to the last digits.
fn difference(what: &str, stated: f64, pinned: f64) -> Option<String> {
    if stated == pinned || pinned.is_finite() && (stated - pinned).abs() <= 1e-12 * pinned {
        None
    } else if stated < pinned {
        Some(format!("{what}: the code promises {stated:e}, better than {pinned:e}: pin the better one"))
    } else {
        Some(format!(
            "{what}: the code promises {stated:e}, LESS than the pinned {pinned:e}: do not loosen it"
        ))
    }
}

fn assert_none(differences: impl Iterator<Item = String>) {
    let differences: Vec<_> = differences.collect();
    assert!(differences.is_empty(), "\n{}", differences.join("\n"));
}

#[test]
fn no_model_promises_less_than_is_pinned() {
    let differences = |model: &'static Model| {
        let name = model.name;
        [
            difference(&format!("{name}, values in f32"), model.value_f32, value_f32(model)),
            difference(&format!("{name}, integrals in f32"), model.integral_f32(), integral_f32(model)),
            difference(&format!("{name}, energy"), model.rho_bound, energy(model)),
        ]
    };
    assert_none(built_in().flat_map(differences).flatten());
    let common = [
        difference("values in f32", precision::VALUE_F32, VALUE_F32),
        difference("integrals in f32", precision::INTEGRAL_F32, INTEGRAL_F32),
        difference("f64 as stored in f32", precision::STORED_F32, STORED_F32),
        difference("reciprocity of the atlas", gonio::lab::atlas::RECIPROCITY, RECIPROCITY),
    ];
    assert_none(common.into_iter().flatten());
    // A row that no model has any more pins nothing.
    for promise in MODELS.iter().chain(&NORMALS) {
        model(promise.name);
    }
}

#[test]
fn a_looser_promise_is_seen() {
    for stated in [VALUE_F32 * (1.0 + 1e-9), 41.0 * U, f64::INFINITY, f64::NAN] {
        assert!(difference("x", stated, VALUE_F32).unwrap().contains("LESS"), "{stated}");
    }
    assert!(difference("x", 39.0 * U, VALUE_F32).unwrap().contains("better"));
    assert!(difference("x", f64::INFINITY, 1.0).is_some() && difference("x", 1.0, f64::INFINITY).is_some());
    assert_eq!(difference("x", f64::INFINITY, f64::INFINITY), None);
    assert!(parts("ggx-smith-separable-gold").is_none() && parts("ggy").is_none());
}

/// A plan at a setting takes f32 down to the tolerance that is pinned for it, and no further.
#[test]
fn no_setting_promises_less_than_is_pinned() {
    let at = |name: &str, alpha: f64, parameters: &[(&str, f64)]| {
        let model = model(name);
        let plan = |quantity, axes| {
            let parameters: Vec<_> = parameters.iter().map(|&(name, x)| (name.to_owned(), x)).collect();
            let plan = TablePlan::basis("t", quantity, model, Some(alpha.sqrt()), axes).unwrap();
            plan.with_parameters(&parameters).unwrap()
        };
        let all = [ThetaI, PhiI, ThetaE, PhiE].map(|variable| axis(variable, 2)).to_vec();
        let isotropic = [ThetaI, ThetaE, DeltaPhi].map(|variable| axis(variable, 2)).to_vec();
        let values = plan(&BRDF, if model.is_anisotropic() { all } else { isotropic });
        let setting = values.lobes()[0].setting_at(None).unwrap();
        let around = if model.is_anisotropic() { vec![axis(PhiI, 2)] } else { Vec::new() };
        let integrals = plan(&RHO_DH, [vec![axis(ThetaI, 2)], around].concat());
        (values, integrals, value_f32_at(model, &setting))
    };
    // The last column is what the least tolerance of an integral is multiplied with. Of gtr the energy at the setting: in
    // closed form (1 − α)/(α ln 1/α) at γ = 1, and 4/α ∫ sin²θm D dθm elsewhere, here by arbitrary precision. Of unequal α a
    // twentieth of what values lose more than those of equal α, as measured: of α = 1 and 1/1000, (60 + 12 000)/72/20.
    type PinnedSetting<'a> = (&'a str, f64, &'a [(&'a str, f64)], f64);
    let rows: [PinnedSetting; 13] = [
        ("ggx", 1e-6, &[], 1.0),
        ("ggx-anisotropic", 0.1, &[("aspect", 1.0)], 1.0),
        ("ggx-anisotropic", 0.1, &[("aspect", 0.25)], 1.0),
        ("ggx-anisotropic", 0.01, &[("aspect", 100.0)], 1.0),
        ("ggx-anisotropic", 1e-3, &[("aspect", 1.0), ("strength", 1.0)], 8.375),
        ("beckmann-anisotropic", 0.1, &[("aspect", 9.0)], 1.0),
        ("beckmann-anisotropic", 0.01, &[("aspect", 100.0)], 2.576_923_076_923_077),
        ("gtr", 0.1, &[("gamma", 1.0)], 3.908_650_337_129_27),
        ("gtr", 0.01, &[("gamma", 1.5)], 3.209_666_328_38),
        ("gtr", 0.5, &[("gamma", 2.0)], 1.0),
        ("gtr", 1e-3, &[("gamma", 10.0)], 1.0),
        ("student-t", 0.5, &[("gamma", 3.0)], 1.0),
        ("student-t", 1e-6, &[("gamma", 40.0)], 1.0),
    ];
    for (name, alpha, parameters, times) in rows {
        let (values, integrals, value) = at(name, alpha, parameters);
        let integral = times * parts(name).unwrap().normals.integral;
        for (plan, pinned) in [(values, value), (integrals, integral)] {
            let precision = |share: f64| plan.clone().with_tolerance(share * pinned).unwrap().precision();
            let what = format!("{name} at alpha = {alpha}, {parameters:?}, {}", plan.quantity().name);
            assert_eq!(precision(1.0 + 1e-9), Precision::F32, "{what}: LESS than {pinned:e} is promised");
            assert_eq!(precision(1.0 - 1e-9), Precision::F64, "{what}: better than {pinned:e}: pin it");
        }
    }
}

/// Errors are relative to max(f, floor): where f is 0, an error of a thousandth of the pinned floor is a thousandth.
#[test]
fn no_floor_is_higher_than_pinned() {
    // Schlick's Fc is 0 at normal incidence; Charlie's D there; a Gaussian 1 rad from its peak; a lobe behind its axis.
    for (name, alpha, [theta_i, theta_e, delta_phi]) in [
        ("ggx", 0.1, [0.0, 0.0, 0.0]),
        ("gtr", 0.1, [0.0, 0.0, 0.0]),
        ("beckmann", 1e-3, [0.0, 1.0, 0.0]),
        ("ward-dur", 1e-3, [0.0, 1.0, 0.0]),
        ("charlie", 0.01, [0.0, 0.0, 0.0]),
        ("phong", 0.1, [1.5, 1.5, PI]),
        ("lafortune", 0.1, [1.5, 1.5, PI]),
    ] {
        let model = model(name);
        let axes =
            vec![listed(ThetaI, &[theta_i]), listed(ThetaE, &[theta_e]), listed(DeltaPhi, &[delta_phi])];
        let plan = TablePlan::basis("t", &BRDF, model, Some(f64::sqrt(alpha)), axes).unwrap();
        let mut values = reference(&plan, 0);
        let last = values.last_mut().unwrap();
        assert!(*last < 1e-6 * floor(model), "{name}: {last:e} is no 0");
        *last += 1e-3 * floor(model);
        let error = cross_check(&plan, &Values::F64(values), Check::All, None, &|_| Ok(())).unwrap();
        let measured = error.measured_max.unwrap();
        assert!((measured - 1e-3).abs() < 1e-6, "{name}: {measured:e} of a floor of {:e}", floor(model));
    }
}

/// What `gonio check` allows of a model: half as much again would be a looser promise.
#[test]
fn no_check_allows_more_than_is_pinned() {
    for model in gonio::model::MODELS.into_iter().filter(|model| !model.is_delta()) {
        let lobe = Lobe::new(model, Some(0.5), vec![[1.0; 2]; 3]).unwrap();
        let subject = Sum::model(&Evaluator::Cpu, lobe, Vec::new()).unwrap();
        let Tolerances { reciprocity, isotropy, bilateral, energy, agreement } = subject.tolerances();
        let setting = Lobe::new(model, Some(0.5), vec![[1.0; 2]; 3]).unwrap().setting_at(None).unwrap();
        let name = model.name;
        let differences = [
            difference(&format!("{name}, reciprocity"), reciprocity, 1e-6),
            difference(&format!("{name}, isotropy"), isotropy, 1e-6),
            difference(&format!("{name}, bilateral symmetry"), bilateral, 0.0),
            difference(&format!("{name}, energy"), energy, 2.0 * INTEGRAL_F32),
            difference(&format!("{name}, agreement"), agreement, value_f32_at(model, &setting)),
            // Of f below 1e-21, Fc underflows by up to 2⁻¹²⁶ times the largest D.
            difference(&format!("{name}, floor"), subject.faint(), floor(model).max(1e-21)),
        ];
        assert_none(differences.into_iter().flatten());
    }
}

/// What Turquin's compensation declares: E of GGX with F = 1 is from 1 − ln 2 to 1, so that f of exchanged directions
/// differs by 0.7 of the larger, and ρ_dh reaches 1/(1 − ln 2).
#[test]
fn compensation_declares_no_more_than_is_pinned() {
    let lobe = Lobe::new(model("ggx-smith-correlated-none"), Some(1.0), vec![[1.0, 0.0]; 3]).unwrap();
    let subject = |kind| Sum::compensated(&Evaluator::Cpu, lobe.clone(), kind, Vec::new()).unwrap();
    assert!(subject(Compensation::KullaConty).declared().is_empty());
    let turquin = subject(Compensation::Turquin);
    let bounds: Vec<_> =
        turquin.declared().iter().map(|declared| (declared.property, declared.bound)).collect();
    assert_eq!(bounds, [("reciprocity", 0.7), ("energy", 3.26)]);
}
