//! Promises of the white furnace of any f: gains are found wherever the lobe is, none is invented, and the stated bar
//! contains the truth.

use crate::common::device;
use gonio::bake::{Evaluator, Unobserved};
use gonio::verify::user_shader::{UserFunction, UserShader};
use gonio::verify::{
    Exceptions, Finding, Limited, ParameterRange, Report, Symmetry, Verdict, VerifyOptions, check,
};

/// A twentieth of the default.
const OPTIONS: VerifyOptions = VerifyOptions { budget: 1_000_000, search: true };

/// GGX of F = 1 with height-correlated masking and any two widths.
const WHITE: &str = "
fn white(i: vec3f, o: vec3f, a: vec2f) -> f32 {
    let m = i + o;
    let slope = m.xy / a;
    let q = dot(m, m) / (dot(slope, slope) + m.z * m.z);
    let stretch = vec3f(a, 1.0);
    return q * q / (6.2831853 * a.x * a.y) / (o.z * length(i * stretch) + i.z * length(o * stretch));
}
";

fn subject(body: &str, ranges: &[(&str, f64, f64)], isotropic: bool) -> UserShader<'static> {
    let Evaluator::Device(device) = device() else { unreachable!("common::device asserts it") };
    let arguments: String = ranges.iter().map(|(name, ..)| format!(", {name}: f32")).collect();
    let source = format!("{WHITE}\nfn f(i: vec3f, o: vec3f{arguments}) -> f32 {{ {body} }}");
    let function = UserFunction::parse("f.wgsl", source, "f").unwrap();
    let ranges =
        ranges.iter().map(|&(name, low, high)| ParameterRange::new(name, low, high).unwrap()).collect();
    let symmetry = Symmetry { isotropic, bilateral: isotropic };
    UserShader::new(device, function, ranges, false, symmetry).unwrap()
}

fn report(body: &str, ranges: &[(&str, f64, f64)]) -> Report {
    check(&mut subject(body, ranges, true), &OPTIONS, &Unobserved).unwrap()
}

fn energy(body: &str, ranges: &[(&str, f64, f64)], isotropic: bool) -> Finding {
    let report = check(&mut subject(body, ranges, isotropic), &OPTIONS, &Unobserved).unwrap();
    let energy = report.find("energy").unwrap().clone();
    println!("{body}: {:?} {} {:?}", energy.verdict, energy.said, energy.input);
    energy
}

fn gains(body: &str, least: f64, most: f64) {
    let found = energy(body, &[], true);
    let certain = found.deviation.unwrap();
    assert_eq!(found.verdict, Verdict::Broken, "{body}: {}", found.said);
    assert!(certain >= least && certain <= most, "{body}: {certain} is not within {least} and {most}");
}

/// White GGX loses, and never gains: at widths that make a spike, where rounding of the directions is all that is seen
/// near the horizon, and at any other.
#[test]
fn white_ggx_is_kept_at_all_widths() {
    for (low, high) in [(1e-4, 1e-4), (1e-3, 1e-3), (0.02, 1.0)] {
        let found = energy("return white(i, o, vec2f(a, a));", &[("a", low, high)], true);
        assert_eq!(found.verdict, Verdict::Kept, "{low}: {}", found.said);
    }
}

#[test]
fn anisotropic_white_ggx_is_kept() {
    let ranges = [("a", 0.08, 0.9), ("b", 0.08, 0.9)];
    let found = energy("return white(i, o, vec2f(a, b));", &ranges, false);
    assert_eq!(found.verdict, Verdict::Kept, "{}", found.said);
}

/// 1/π in f32 and what the sums are off by are no gain; two parts in ten thousand are.
#[test]
fn a_gain_of_two_parts_in_ten_thousand_is_found_and_none_is_invented() {
    gains("return 1.0002 * 0.318309886;", 1.000_19, 1.000_201);
    assert_eq!(energy("return 0.318309886;", &[], true).verdict, Verdict::Kept);
}

/// A lobe three times too bright within 0.2° of the horizon.
#[test]
fn a_gain_near_the_horizon_is_found() {
    gains(
        "let g = 2.0 / (1.0 + (i.z + o.z) * 300.0); return 0.98 * (1.0 + g) * white(i, o, vec2f(0.002));",
        1.5,
        3.0,
    );
}

/// ∫ cⁿ⁺¹ dω = 2π/(n + 2) at normal incidence: 1.2 of what comes, and 0.7.
#[test]
fn a_lobe_back_to_the_source_is_summed() {
    let lobe =
        |gain: f64| format!("return {gain:?} * 8002.0 / 6.2831853 * pow(max(dot(i, o), 0.0), 8000.0);");
    gains(&lobe(1.2), 1.195, 1.202);
    assert_eq!(energy(&lobe(0.7), &[], true).verdict, Verdict::Kept);
}

/// A lobe about a fixed share of the tangent, where neither the mirror nor the source is.
#[test]
fn a_lobe_off_the_mirror_direction_is_found() {
    gains(
        "let d = vec3f(-0.45 * i.xy, 0.0); let p = vec3f(d.xy, sqrt(1.0 - dot(d, d)));
         return 1.3 * 4000.0 / 6.2831853 * exp(4000.0 * (dot(p, o) - 1.0)) / p.z;",
        1.28,
        1.31,
    );
}

/// 5 % more within ± 0.005 of one cosine.
#[test]
fn a_narrow_band_of_incidences_is_found() {
    gains("return 0.99 * 0.318309886 * select(1.0, 1.05, abs(i.z - 0.437) < 0.005);", 1.039, 1.0396);
}

/// 1 − 1 in f32 is below zero by rounding, which is no fault; a thousandth is. What is broken says how much of it is.
#[test]
fn rounding_below_zero_is_told_from_a_fault() {
    let report = report(
        "return 0.3 * (dot(i, o) + 1.0 - (dot(i, o) + 1.0) * 1.00000003 - 3e-8) + 0.2 * i.z * o.z;",
        &[],
    );
    assert_eq!(report.find("non-negative").unwrap().verdict, Verdict::Kept, "{report:?}");
    let report = self::report("return 0.2 * i.z * o.z - 1e-3;", &[]);
    let negative = report.find("non-negative").unwrap();
    let extent = negative.extent.as_ref().unwrap();
    assert!(
        negative.verdict == Verdict::Broken && extent.broken > 0 && extent.broken < extent.of,
        "{negative:?}"
    );
}

/// A corner of eight parameters, and the mirror direction, hold to the bit.
#[test]
fn corners_and_relations_to_the_bit_are_tried() {
    let names = ["a", "b", "c", "d", "e", "g", "h", "k"];
    let body = "let t = (1.0 - a) + b + (1.0 - c) + d; return 0.1 + 1e-9 * t / t + 1e-20 * (e + g + h + k);";
    let found = report(body, &names.map(|name| (name, 0.0, 1.0)));
    assert_eq!(found.find("finite").unwrap().verdict, Verdict::Broken);
    let found = report("let t = i.xy + o.xy; return 0.1 + 1e-9 * t.x / dot(t, t);", &[]);
    assert_eq!(found.find("finite").unwrap().verdict, Verdict::Broken);
}

/// A gain that is allowed, a tolerance, and a range of angles.
#[test]
fn exceptions_are_kept_to() {
    let verdict = |body: &str, property: &str, exceptions: &dyn Fn(&mut Exceptions)| {
        let mut all = Exceptions::default();
        exceptions(&mut all);
        let mut subject = subject(body, &[], true);
        let report = check(&mut Limited::new(&mut subject, &all), &OPTIONS, &Unobserved).unwrap();
        report.find(property).unwrap().verdict
    };
    let bright = "return 1.2 * 0.318309886;";
    assert_eq!(verdict(bright, "energy", &|e| e.allow("energy", 1.21, "a test").unwrap()), Verdict::Declared);
    assert_eq!(verdict(bright, "energy", &|e| e.allow("energy", 1.19, "a test").unwrap()), Verdict::Broken);
    let uneven = "return 0.1 * (1.0 + 0.002 * i.z);";
    assert_eq!(verdict(uneven, "reciprocity", &|e| e.tolerance("reciprocity", 3e-3).unwrap()), Verdict::Kept);
    let pole = "return 0.1 + select(0.0, 1e-3 / o.z, o.z < 0.01) * 1e38;";
    assert_eq!(verdict(pole, "finite", &|e| e.theta([0.0, 1.5]).unwrap()), Verdict::Kept);
    assert_eq!(verdict(pole, "finite", &|_| {}), Verdict::Broken);
    assert!(Exceptions::default().allow("finite", 1.0, "").is_err());
    assert!(Exceptions::default().tolerance("energy", f64::NAN).is_err());
    assert!(Exceptions::default().theta([1.0, 0.5]).is_err());
}
