//! Light: closed forms, maps against the reference, and the equations that define what a BRDF does to light.
//!
//! The numbers of equations are those of the lecture notes that the project began from, as its design paraphrases them:
//! (8) reciprocity, (9) energy, (11) outgoing radiance, (12) radiosity, (13) the ideal mirror. Which number belongs to
//! which is inferred from their order there.

use crate::common::{
    device, evaluators, golden, is_thorough, listed, model, nodes, reference_model, sample_data,
};
use crate::promises::{HARMONICS_F32, HARMONICS_F64};
use gonio::bake::{Evaluator, Unobserved};
use gonio::base::precision::Precision;
use gonio::base::quadrature::gauss_legendre;
use gonio::base::timings::Timings;
use gonio::check::Check;
use gonio::io::format::EXR;
use gonio::io::{Provenance, verify};
use gonio::light::bake::{Order, lobes_of};
use gonio::light::exitant::{Integrated, View, prefiltered, radiance, radiosity, split_sum};
use gonio::light::harmonics::{coefficients, convolved, evaluate};
use gonio::light::irradiance::in_closed_form;
use gonio::light::{
    Directional, Disk, Environment, Frame, InvalidTexels, Light, MapFile, Radiance, Sky, direction, read,
};
use gonio::model::compensation::Factor;
use gonio::model::lobe::Lobe;
use gonio::reference::{Parameters, Setting, light as reference};
use gonio::scene::{Scene, parse_recipe};
use gonio::shader::{Kernel, compose, validate};
use gonio::table::Table;
use gonio::table::axis::{Axis, Variable};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::path::{Path, PathBuf};
use std::process::Command;

const REFUSE: InvalidTexels = InvalidTexels::Refuse { remedy: "give --clamp" };

fn close(a: f64, b: f64, relative: f64) {
    assert!((a - b).abs() <= relative * b.abs(), "{a} is not {b} to {relative:e}");
}

fn close3(a: [f64; 3], b: [f64; 3], relative: f64) {
    a.into_iter().zip(b).for_each(|(a, b)| close(a, b, relative));
}

/// Normals all over the sphere, and the extremes.
fn normals() -> Vec<[f64; 3]> {
    let spread = golden(40, 0.2).into_iter().zip(golden(40, 0.7)).enumerate();
    let spread = spread.map(|(k, (u, _))| direction((1.0 - 2.0 * u).acos(), 2.4 * k as f64));
    let extremes =
        [[0.0, 0.0], [PI, 0.0], [FRAC_PI_2, 0.0], [FRAC_PI_2, 1.0], [1e-7, 2.0], [FRAC_PI_2 - 1e-9, PI]];
    spread.chain(extremes.map(|[t, p]| direction(t, p))).collect()
}

/// A sky with a sun of four texels, 10⁵ brighter.
fn sun_and_sky(width: usize, height: usize) -> Environment {
    let texel = |row: usize, column: usize| {
        let sky = [0.3, 0.5, 1.0].map(|x: f32| x * (1.0 + (row as f32 * 0.3).sin() * 0.5));
        let in_sun = row / 2 == height / 8 && column / 2 == width / 5;
        if in_sun { [1e5, 0.9e5, 0.7e5] } else { sky }
    };
    let texels = (0..height).flat_map(|row| (0..width).map(move |column| texel(row, column))).collect();
    Environment::new(width, height, texels).unwrap().rotated(0.4)
}

fn order<'a>(evaluator: &'a Evaluator, light: &'a Light, check: Check) -> Order<'a> {
    Order { evaluator, light, name: "test", tolerance: 1e-4, check, observer: &Unobserved }
}

/// What three bands of harmonics miss of the irradiance of any light at most, as a share of ∫ L dω: of a direction,
/// max(0, x) less ¼ + x/2 + (5/32)(3x² − 1), which is 3/32 at x = 0.
const TRUNCATION: f64 = 3.0 / 32.0;

/// Every texel that was compared is within the tolerance, by this file's comparison of what was measured.
fn assert_within(order: &Order, table: &Table) {
    let measured = table.error.measured_max.unwrap();
    assert!(
        measured <= order.tolerance && table.error.texels_checked > 0,
        "{}: {:?}",
        table.name,
        table.error
    );
    order.within_tolerance(table).unwrap();
}

fn grid(rows: usize, columns: usize) -> [Axis; 2] {
    [Axis::natural(Variable::ThetaN, rows).unwrap(), Axis::natural(Variable::PhiN, columns).unwrap()]
}

fn scene(lobe: &str) -> Scene {
    let text = format!("[materials.m]\nlobes = [{{ {lobe} }}]\n");
    parse_recipe(Path::new("test.toml"), text.as_bytes()).unwrap()
}

fn lobes(lobe: &str) -> Vec<Lobe> {
    lobes_of(scene(lobe).material("m").unwrap(), None).unwrap()
}

fn le(
    evaluator: &Evaluator,
    lobes: &[Lobe],
    light: &Light,
    views: &[View],
    tolerance: f64,
) -> Vec<Integrated> {
    radiance(evaluator, lobes, light, views, tolerance, &Unobserved).unwrap()
}

/// E = πL, whatever the normal.
#[test]
fn a_constant_light_gives_pi() {
    let light = Light::Constant(Radiance::new([1.0, 2.0, 0.5]).unwrap());
    for normal in normals() {
        let e = in_closed_form(&light, normal).unwrap();
        close3(e, [PI, 2.0 * PI, 0.5 * PI], 1e-15);
    }
    // As a map it is integrated.
    let map = Light::Map(Environment::new(1, 1, vec![[1.0, 2.0, 0.5]]).unwrap());
    for evaluator in evaluators() {
        let table =
            order(evaluator, &map, Check::All).irradiance(grid(8, 8), &mut Timings::default()).unwrap();
        for texel in 0..table.texels() {
            let e = std::array::from_fn(|c| table.value(texel, c));
            close3(e, [PI, 2.0 * PI, 0.5 * PI], 1e-6);
        }
    }
}

/// E = π L sin² σ cos θ while all of it is above the horizon, and by the definition where the horizon cuts it.
#[test]
fn a_disk_is_in_closed_form() {
    for sigma in [1e-4, 4.65e-3, 0.3, 1.2] {
        for theta in [0.0, 0.2, 0.8, 1.3, 1.5, FRAC_PI_2, 1.7, 2.5] {
            let disk = Disk::new(direction(0.9, 2.0), sigma, [3.0; 3]).unwrap();
            let light = Light::Disk(disk);
            let towards = Frame::new(0.9, 2.0).to_world(direction(theta, 0.7));
            let e = in_closed_form(&light, towards).unwrap()[0];
            if theta + sigma < FRAC_PI_2 {
                close(e, 3.0 * PI * sigma.sin().powi(2) * theta.cos(), 1e-9);
            }
            let truth = reference::irradiance(&light.to_reference().unwrap(), towards)[0];
            let most = 3.0 * PI * sigma.sin().powi(2);
            // What an arc cosine near its end leaves of a small disk at the horizon.
            assert!((e - truth).abs() < 1e-6 * most, "σ = {sigma}, θ = {theta}: {e}, {truth}");
        }
    }
}

#[test]
fn a_sky_is_in_closed_form() {
    let sky = Sky::new([2.0, 1.0, 0.5], [0.5, 3.0, 0.5], [0.1, 0.2, 0.7]).unwrap();
    for normal in normals() {
        let e = in_closed_form(&Light::Sky(sky), normal).unwrap();
        close3(e, reference::irradiance(&Light::Sky(sky).to_reference().unwrap(), normal), 1e-9);
    }
    close(in_closed_form(&Light::Sky(sky), [0.0, 0.0, 1.0]).unwrap()[0], PI * 0.5 + TAU * 1.5 / 3.0, 1e-14);
}

#[test]
fn a_sun_and_a_sky_keep_their_energy() {
    let map = sun_and_sky(128, 64);
    let light = Light::Map(map.clone());
    for evaluator in evaluators() {
        let table =
            order(evaluator, &light, Check::All).irradiance(grid(16, 16), &mut Timings::default()).unwrap();
        let off = table.error.measured_max.unwrap();
        println!("{}: {off:.1e}, estimate {:?}", table.precision, table.error.estimate);
        assert!(off < 1e-4, "{:?}", table.error);
    }
    // E(n) − E(−n) = n·∫ L ω dω: the sun's share of it is the map's own sum.
    let mut vector = [0.0; 3];
    for row in 0..64 {
        for column in 0..128 {
            let cell = map.cell(row, column).vector();
            (0..3).for_each(|k| vector[k] += f64::from(map.texel(row, column)[0]) * cell[k]);
        }
    }
    let one = |t: f64, p: f64| {
        let axes = [listed(Variable::ThetaN, &[t]), listed(Variable::PhiN, &[p.rem_euclid(TAU)])];
        order(device(), &light, Check::Sample(0))
            .irradiance(axes, &mut Timings::default())
            .unwrap()
            .value(0, 0)
    };
    for (t, p) in [(0.3, 1.0), (1.0, 4.0), (1.5, 2.0)] {
        let n = direction(t, p);
        let net = one(t, p) - one(PI - t, p + PI);
        let truth: f64 = (0..3).map(|k| n[k] * vector[k]).sum();
        assert!((net - truth).abs() < 1e-4 * truth.abs().max(1.0), "{net}, {truth}");
    }
}

/// Maps of which most normals see nothing or next to nothing: suns of one texel, of one channel each, at the poles, the horizon
/// and the map's edges; halves of the sphere.
fn faint_maps() -> Vec<Environment> {
    let map = |lit: &dyn Fn(usize, usize) -> bool| {
        let texel = |k: usize| if lit(k / 64, k % 64) { [1e5, 1.0, 1e-5] } else { [0.0; 3] };
        Environment::new(64, 32, (0..64 * 32).map(texel).collect()).unwrap()
    };
    let suns = [(0, 0), (0, 37), (31, 63), (1, 5), (30, 12), (15, 10), (16, 31), (7, 0)];
    let suns = suns.map(|sun| map(&|row, column| (row, column) == sun));
    let halves = [map(&|row, _| row < 16), map(&|row, _| row >= 16), map(&|_, column| column < 32)];
    let rings = [map(&|row, _| row == 0), map(&|row, _| row == 16)];
    suns.into_iter().chain(halves).chain(rings).flat_map(|map| [map.clone(), map.rotated(0.3)]).collect()
}

/// E is not negative, and `estimate` bounds its true error, on both paths.
#[test]
fn faint_irradiance_is_within_its_estimate() {
    for map in faint_maps() {
        let light = Light::Map(map);
        for evaluator in evaluators() {
            let order = order(evaluator, &light, Check::All);
            let table = order.irradiance(grid(9, 10), &mut Timings::default()).unwrap();
            assert_within(&order, &table);
            let (estimate, measured) = (table.error.estimate.unwrap(), table.error.measured_max.unwrap());
            assert!(measured <= estimate, "{}: {:?}", table.precision, table.error);
        }
    }
}

/// A table that misses its tolerance says by how much one texel does, and which; or that only the estimate does.
#[test]
fn a_miss_names_one_texel() {
    let light = Light::Map(sun_and_sky(64, 32));
    let order = order(&Evaluator::Cpu, &light, Check::All);
    let mut table = order.irradiance(grid(2, 3), &mut Timings::default()).unwrap();
    let strict = Order { tolerance: 1e-12, ..order };
    let why = strict.within_tolerance(&table).unwrap_err().to_string();
    assert!(why.contains("reference = ") && why.contains("theta_n = ") && why.contains("1e-12"), "{why}");
    table.error.measured_max = Some(0.0);
    let why = strict.within_tolerance(&table).unwrap_err().to_string();
    assert!(why.contains("by its estimate") && !why.contains("theta_n"), "{why}");
}

/// Le and M of the same are not negative either.
#[test]
fn faint_light_is_never_sent_back_below_zero() {
    let one = scene("model = \"ggx\", roughness = 0.5, f0 = [0.9, 0.5, 0.04]");
    for map in faint_maps().into_iter().step_by(11) {
        let light = Light::Map(map);
        for evaluator in evaluators() {
            let order = Order { tolerance: 1e-2, ..order(evaluator, &light, Check::Sample(0)) };
            let axes = [
                listed(Variable::ThetaN, &[0.0, 1.6, PI]),
                listed(Variable::PhiN, &[0.3]),
                listed(Variable::ThetaE, &[0.0, 1.3]),
                listed(Variable::PhiE, &[0.3]),
            ];
            order.radiance(one.material("m").unwrap(), &[], axes, &mut Timings::default()).unwrap();
            order.radiosity(&one, "m", grid(3, 2), &mut Timings::default()).unwrap();
        }
    }
}

/// Of a sky that is black below the horizon a surface that faces down sees nothing, and one that nearly does sees
/// E → π/4 t² Lh, t its angle from the nadir.
#[test]
fn a_surface_that_faces_down_sees_no_sky() {
    let sky = |zenith, horizon| Light::Sky(Sky::new([zenith; 3], [horizon; 3], [0.0; 3]).unwrap());
    let e = |light: &Light, t: f64| in_closed_form(light, [t.sin(), 0.0, -t.cos()]).unwrap()[0];
    for t in [0.0, 1e-15, 1e-9, 1e-5, 1e-3] {
        close(e(&sky(0.0, 1.0), t), 0.25 * PI * t * t, 2.0 * t);
        close(e(&sky(1.0, 0.0), t), 2.0 / 9.0 * t.powi(3), 2.0 * t);
    }
    let ground = Light::Sky(Sky::new([0.0; 3], [0.0; 3], [1.0; 3]).unwrap());
    close(e(&ground, PI - 1e-4), 0.25 * PI * 1e-8, 1e-6);
    for light in [sky(0.0, 1.0), sky(2.0, 0.0), sky(1.0, 0.3)] {
        let order = order(&Evaluator::Cpu, &light, Check::All);
        assert_within(&order, &order.irradiance(grid(33, 7), &mut Timings::default()).unwrap());
    }
}

/// The comparer sees a map that is turned by a hundredth of a radian.
#[test]
fn the_comparison_can_fail() {
    let map = sun_and_sky(128, 64);
    let irradiance = |map: &Environment| {
        let light = Light::Map(map.clone());
        reference::irradiance(&light.to_reference().unwrap(), reference::Frame::new(1.0, 1.0).normal())
    };
    let right = irradiance(&map);
    let turned = map.rotated(1e-2);
    let wrong = irradiance(&turned);
    assert!((right[0] - wrong[0]).abs() > 1e-4 * right[0]);
    let light = Light::Map(turned);
    let axes = [listed(Variable::ThetaN, &[1.0]), listed(Variable::PhiN, &[1.0])];
    let table = order(device(), &light, Check::All).irradiance(axes, &mut Timings::default()).unwrap();
    close(table.value(0, 0), wrong[0], 1e-5);
    assert!((table.value(0, 0) - right[0]).abs() > 1e-4 * right[0]);
}

/// What every WebGPU device takes: no f64, no extension.
#[test]
fn the_kernel_is_portable() {
    validate(&compose(Kernel::Irradiance, None, 3, Precision::F32), Precision::F32).unwrap();
}

/// A real map: 64 × 32 normals within 1e-4, and its harmonics within their known truncation.
#[test]
#[ignore = "needs the sample data: set GONIO_DATA, see CONTRIBUTING.md"]
fn sample_data_light_as_the_reference_says() {
    let MapFile { map, .. } = read(&sample_data("env/museum.exr"), REFUSE).unwrap();
    assert_eq!((map.width(), map.height()), (512, 256));
    let light = Light::Map(map);
    let order = order(device(), &light, Check::Sample(256));
    let table = order.irradiance(grid(32, 64), &mut Timings::default()).unwrap();
    println!("measured {:?}, estimate {:?}", table.error.measured_max, table.error.estimate);
    assert!(
        table.error.texels_checked >= 256 && table.error.measured_max.unwrap() < 1e-4,
        "{:?}",
        table.error
    );
    assert!(table.error.estimate.unwrap() < 1e-4, "{:?}", table.error);
    assert_within(&order, &table);
    let (_, off) = order.harmonics(&table, &mut Timings::default()).unwrap();
    println!("three bands miss E by {off:.4} of ∫ L dω");
    assert!(off > 1e-3 && off < TRUNCATION, "{off}");
}

#[test]
fn harmonics_of_a_direction_miss_by_what_truncation_says() {
    let sun = Light::Directional(Directional::new(direction(0.7, 2.0), [1.0; 3]).unwrap());
    let e = convolved(&coefficients(&sun));
    // At x = cos θ the three bands are ¼ + x/2 + (5/32)(3x² − 1).
    for theta in [0.0f64, 0.5, FRAC_PI_2, 2.0, PI] {
        let x = theta.cos();
        let normal = Frame::new(0.7, 2.0).to_world(direction(theta, 0.3));
        let bands = 0.25 + 0.5 * x + 5.0 / 32.0 * (3.0 * x * x - 1.0);
        assert!((evaluate(&e, normal)[0] - bands).abs() < 1e-12);
        assert!((bands - x.max(0.0)).abs() <= TRUNCATION + 1e-15);
    }
}

/// A map of what a disk, a sky or a constant is has their coefficients, as far as its texels go.
#[test]
fn harmonics_of_a_map_are_those_of_what_it_shows() {
    let sky = Sky::new([2.0, 1.0, 0.5], [0.5; 3], [0.1; 3]).unwrap();
    let disk = Disk::new(direction(1.0, 2.5), 0.6, [2.0; 3]).unwrap();
    for light in
        [Light::Sky(sky), Light::Disk(disk), Light::Constant(Radiance::new([1.0, 0.0, 3.0]).unwrap())]
    {
        let (width, height) = (512, 256);
        let blank = Environment::new(width, height, vec![[0.0; 3]; width * height]).unwrap();
        let texels = (0..width * height).map(|k| {
            let cell = blank.cell(k / width, k % width);
            let middle = |[a, b]: [f64; 2]| 0.5 * (a + b);
            light.radiance(direction(middle(cell.theta), middle(cell.phi))).map(|x| x as f32)
        });
        let map = Light::Map(Environment::new(width, height, texels.collect()).unwrap());
        for (a, b) in coefficients(&light).as_flattened().iter().zip(coefficients(&map).as_flattened()) {
            // A disk's edge is a texel wide.
            assert!((a - b).abs() < 5e-3 * 2.0, "{light:?}: {a}, {b}");
        }
    }
}

/// Le = albedo E/π.
#[test]
fn lambert_sends_back_its_share_of_the_irradiance() {
    let light = Light::Map(sun_and_sky(64, 32));
    let frame = Frame::new(0.5, 1.0);
    let view = View { frame, theta_e: 0.8, phi_e: 2.0 };
    let e = reference::irradiance(&light.to_reference().unwrap(), frame.normal());
    for evaluator in evaluators() {
        let lit =
            le(evaluator, &lobes("model = \"lambert\", albedo = [0.8, 0.4, 0.1]"), &light, &[view], 1e-5);
        close3(lit[0].value, [0.8, 0.4, 0.1].map(|a: f64| a / PI).zip3(e), 1e-6);
    }
    // Of lights in closed form it is exact.
    let light = Light::Disk(Disk::new(direction(0.3, 1.0), 0.2, [5.0; 3]).unwrap());
    let lit = le(device(), &lobes("model = \"lambert\", albedo = 0.5"), &light, &[view], 1e-5);
    let e = in_closed_form(&light, frame.normal()).unwrap();
    close3(lit[0].value, e.map(|e| 0.5 * e / PI), 1e-6);
}

trait Zip3 {
    fn zip3(self, other: [f64; 3]) -> [f64; 3];
}

impl Zip3 for [f64; 3] {
    fn zip3(self, other: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|c| self[c] * other[c])
    }
}

/// (13): f = k δ(θi − θe) δ(φi + π − φe) with k = 1/(cos θi sin θi) sends the map back as it is, each direction that
/// which is opposite in azimuth, for ∫ f cos θi sin θi dθi dφi of it is 1.
#[test]
fn equation_13_a_mirror_returns_the_map() {
    let map = sun_and_sky(64, 32);
    let light = Light::Map(map.clone());
    let mirror = lobes("model = \"mirror\", f0 = 1.0, f90 = 1.0");
    let frame = Frame::new(0.6, 2.0);
    let views: Vec<_> = golden(200, 0.3)
        .into_iter()
        .enumerate()
        .map(|(k, u)| View { frame, theta_e: u * FRAC_PI_2, phi_e: 0.7 * k as f64 })
        .collect();
    for (one, view) in le(device(), &mirror, &light, &views, 1e-4).iter().zip(&views) {
        let from = frame.to_world(direction(view.theta_e, view.phi_e + PI));
        close3(one.value, map.radiance(from), 1e-6);
    }
}

/// (8): f(ωi, ωe) = f(ωe, ωi), as light shows it: what a directional light of irradiance 1 from ωi sends to ωe, over
/// cos θi, is what the same from ωe sends to ωi, over cos θe.
#[test]
fn equation_8_light_and_eye_may_change_places() {
    let frame = Frame::new(1.1, 0.4);
    for lobe in [
        "model = \"ggx\", roughness = 0.4, f0 = [0.9, 0.6, 0.3]",
        "model = \"lambert\", albedo = 0.5",
        "model = \"burley\", roughness = 0.6, albedo = 0.7",
        "model = \"charlie\", roughness = 0.5",
    ] {
        let lobes = lobes(lobe);
        let f = |i: (f64, f64), e: (f64, f64)| {
            let light =
                Light::Directional(Directional::new(frame.to_world(direction(i.0, i.1)), [1.0; 3]).unwrap());
            let view = View { frame, theta_e: e.0, phi_e: e.1 };
            le(device(), &lobes, &light, &[view], 1e-4)[0].value.map(|l| l / i.0.cos())
        };
        for (i, e) in [((0.3, 0.1), (1.2, 2.0)), ((0.7, 3.0), (0.7, 0.0)), ((1.4, 5.0), (0.05, 1.0))] {
            close3(f(i, e), f(e, i), 1e-5);
        }
    }
}

/// (9): ∫ f cos θe dωe ≤ 1, so that no light is sent back more than came, M ≤ E: under a sun too.
#[test]
fn equation_9_no_more_leaves_than_came() {
    let light = Light::Map(sun_and_sky(64, 32));
    for lobe in ["model = \"ggx\", roughness = 0.5, f0 = 1.0", "model = \"lambert\", albedo = 1.0"] {
        let scene = scene(lobe);
        let order = order(device(), &light, Check::Sample(0));
        let order = Order { tolerance: 1e-3, ..order };
        let [_, share] = order.radiosity(&scene, "m", grid(3, 4), &mut Timings::default()).unwrap();
        for texel in 0..share.texels() {
            let share = share.value(texel, 0);
            assert!(share > 0.5 && share <= 1.0 + 1e-3, "{lobe}: {share}");
        }
    }
}

/// (11): Le = ∫ f Li cos θi dωi, against the reference, of lobes from wide to far narrower than a texel.
#[test]
fn equation_11_outgoing_radiance() {
    let map = sun_and_sky(64, 32);
    let light = Light::Map(map.clone());
    let frame = Frame::new(0.4, 1.2);
    // One of them sees the sun in its mirror.
    let sun = map.cell(8, 25);
    let local =
        frame.to_local(direction(0.5 * (sun.theta[0] + sun.theta[1]), 0.5 * (sun.phi[0] + sun.phi[1])));
    let at_sun = View { frame, theta_e: local[2].acos(), phi_e: local[1].atan2(local[0]) + PI };
    let views = [at_sun, View { frame, theta_e: 0.3, phi_e: 5.0 }, View { frame, theta_e: 1.3, phi_e: 1.0 }];
    for roughness in [0.03, 0.3, 0.9] {
        let text = format!("model = \"ggx\", roughness = {roughness}, f0 = [0.9, 0.5, 0.04]");
        let lobes = lobes(&text);
        let axes = |view: &View| {
            [
                listed(Variable::ThetaN, &[0.4]),
                listed(Variable::PhiN, &[1.2]),
                listed(Variable::ThetaE, &[view.theta_e]),
                listed(Variable::PhiE, &[view.phi_e.rem_euclid(TAU)]),
            ]
        };
        for view in &views {
            let one = scene(&text);
            let order = Order { tolerance: 1e-3, ..order(device(), &light, Check::All) };
            let [exact, _] =
                order.radiance(one.material("m").unwrap(), &[], axes(view), &mut Timings::default()).unwrap();
            println!("roughness {roughness}: {:?} {:?}", exact.error.measured_max, exact.error.estimate);
            assert_within(&order, &exact);
        }
        // And the CPU's twins say the same.
        let [a, b] = evaluators().map(|evaluator| le(evaluator, &lobes, &light, &views, 1e-3));
        for (a, b) in a.iter().zip(&b) {
            close3(a.value, b.value, 2e-3);
        }
    }
}

/// A coat without roughness is a mirror that a factor dims: Le = w (0.04 + 0.96 (1 − μe)⁵) L(r).
#[test]
fn a_smooth_coat_reflects_its_fresnel_term() {
    let lobe = Lobe::new(model("ggx-smith-correlated-none"), Some(0.0), vec![[1.0, 0.0]; 3]).unwrap();
    let coat = lobe.with_factors(vec![Factor::Coat { weight: 0.5 }]);
    let light = Light::Constant(Radiance::new([2.0; 3]).unwrap());
    for theta_e in [0.0f64, 0.8, 1.4] {
        let view = View { frame: Frame::new(0.5, 1.0), theta_e, phi_e: 0.3 };
        let reflected = 0.5 * (0.04 + 0.96 * (1.0 - theta_e.cos()).powi(5));
        let lit = le(device(), std::slice::from_ref(&coat), &light, &[view], 1e-4);
        close3(lit[0].value, [2.0 * reflected; 3], 1e-9);
    }
}

/// (12): M = ∫ Le cos θe dωe, by Gauss–Legendre over ωe of Le under a sky; and M = ρ_hh E where the sky is uniform.
#[test]
fn equation_12_radiosity() {
    let text = "model = \"ggx\", roughness = 0.8, f0 = 0.6";
    let (one, lobes) = (scene(text), lobes(text));
    let frame = Frame::new(0.0, 0.0);
    let light = Light::Sky(Sky::new([2.0; 3], [0.5; 3], [0.0; 3]).unwrap());
    let m = radiosity(device(), (&one, "m"), &light, &[frame], 1e-4, &Unobserved).unwrap()[0].value[0];
    // About the zenith Le is the same for all φe: M = 2π ∫ Le μ dμ.
    let rule = gauss_legendre(12);
    let view = |mu: f64| View { frame, theta_e: mu.acos(), phi_e: 0.0 };
    let views: Vec<_> = rule.iter().map(|node| view(node.x)).collect();
    let found = le(device(), &lobes, &light, &views, 1e-4);
    let sum: f64 = rule.iter().zip(&found).map(|(node, le)| node.weight * node.x * le.value[0]).sum();
    close(m, TAU * sum, 3e-4);

    let uniform = Light::Constant(Radiance::new([2.0; 3]).unwrap());
    let m = radiosity(device(), (&one, "m"), &uniform, &[frame], 1e-4, &Unobserved).unwrap()[0].value[0];
    let e = in_closed_form(&uniform, [0.0, 0.0, 1.0]).unwrap()[0];
    let ggx = &lobes[0];
    let reference = reference_model(ggx.model().name);
    let setting = Setting::new(reference.measure(), ggx.roughness(), &Parameters::DEFAULT).unwrap();
    let [a, b] = reference.rho_hh(&setting);
    close(m / e, ggx.weights()[0][0] * a + ggx.weights()[0][1] * b, 1e-6);
}

/// The lights that are no maps.
fn smooth_lights() -> [Light; 2] {
    let sky = Sky::new([1.0, 0.5, 2.0], [2.0, 3.0, 0.1], [0.3, 0.2, 0.4]).unwrap();
    let disk = Disk::new(direction(1.3, PI), 0.4, [1.0, 2.0, 0.5]).unwrap();
    [Light::Sky(sky), Light::Disk(disk)]
}

/// Le under a disk and a sky, up to where the surface is seen at 90°, against the definition: each tolerance is met.
#[test]
fn disks_and_skies_send_back_what_the_definition_says() {
    let material = scene("model = \"ggx\", roughness = 0.5, f0 = [0.9, 0.5, 0.04]");
    let thetas = [0.0, 0.6, 1.2, 1.5, FRAC_PI_2];
    for light in smooth_lights() {
        for evaluator in evaluators() {
            for &tolerance in if is_thorough() { &[1e-2, 1e-3][..] } else { &[1e-2] } {
                let axes = [
                    listed(Variable::ThetaN, &[0.2]),
                    listed(Variable::PhiN, &[0.5]),
                    listed(Variable::ThetaE, &thetas),
                    listed(Variable::PhiE, &[0.3]),
                ];
                let order = Order { tolerance, ..order(evaluator, &light, Check::All) };
                let material = material.material("m").unwrap();
                let [exact, _] =
                    order.radiance(material, &[0.1, 0.5], axes, &mut Timings::default()).unwrap();
                println!("{tolerance}: {:?} {:?}", exact.error.measured_max, exact.error.estimate);
                assert_eq!(exact.error.texels_checked, 2 * thetas.len());
                assert_within(&order, &exact);
            }
        }
    }
}

/// M and M/E over normals, each texel against ∫ ρ_dh L cos θi dωi by the reference's ρ_dh.
#[test]
fn radiosity_is_held_to_the_reference() {
    let one = scene("model = \"ggx\", roughness = 0.5, f0 = [0.9, 0.5, 0.04]");
    let lights = smooth_lights().into_iter().chain([Light::Map(sun_and_sky(64, 32))]);
    for light in lights {
        for evaluator in evaluators() {
            let order = order(evaluator, &light, Check::All);
            let tables = order.radiosity(&one, "m", grid(3, 2), &mut Timings::default()).unwrap();
            for table in &tables {
                println!("{}: {:?}", table.name, table.error.measured_max);
                assert_eq!(table.error.texels_checked, 6);
                assert_within(&order, table);
            }
        }
    }
}

/// Nine coefficients of a map on the device: as near to the reference as their roundings say.
#[test]
fn harmonics_on_the_device_are_the_references() {
    for (width, height) in [(64, 32), (1024, 8)] {
        let light = Light::Map(sun_and_sky(width, height));
        for (evaluator, budget) in evaluators().into_iter().zip([HARMONICS_F32, HARMONICS_F64]) {
            let order = order(evaluator, &light, Check::All);
            let irradiance = order.irradiance(grid(4, 4), &mut Timings::default()).unwrap();
            let (tables, _) = order.harmonics(&irradiance, &mut Timings::default()).unwrap();
            for table in tables {
                let error = table.error;
                println!("{} in {}: {:?}", table.name, table.precision, error.measured_max);
                assert_eq!(error.texels_checked, 9);
                // And the rounding to storage.
                assert!(error.measured_max.unwrap() <= budget + 6e-8, "{error:?}");
                assert!(error.estimate.unwrap() <= budget, "{error:?}: LESS than {budget:e} is promised");
            }
        }
    }
}

/// LD (F0·A + F90·B) is exact where nothing varies, and an approximation elsewhere.
#[test]
fn the_split_sum_is_exact_where_it_should_be() {
    let lobes = lobes("model = \"ggx\", roughness = 0.5, f0 = 0.04, f90 = 0.04");
    let frame = Frame::new(0.5, 1.0);
    let slanted = View { frame, theta_e: 1.2, phi_e: 0.3 };
    let map = Light::Map(sun_and_sky(64, 32));
    let split =
        |light: &Light, view| split_sum(device(), &lobes, light, &[view], 1e-4, &Unobserved).unwrap()[0];
    let exact = |light: &Light, view| le(device(), &lobes, light, &[view], 1e-4)[0].value;
    let white = Light::Constant(Radiance::new([1.0; 3]).unwrap());
    close3(split(&white, slanted), exact(&white, slanted), 5e-4);
    let [a, b] = [split(&map, slanted), exact(&map, slanted)];
    assert!((a[0] - b[0]).abs() > 0.01 * b[0], "{a:?} {b:?}");
    let white = prefiltered(device(), &lobes[0], &white, &[[0.0, 0.0, 1.0]], 1e-4, &Unobserved).unwrap();
    close3(white[0], [1.0; 3], 1e-6);
}

/// Engines filter with D(ωm) cos θi at n = v = r (Karis 2013), whatever the lobe's other terms. Under a ring of light about r:
/// LD = L ∫ D cos θi sin θi dθi over the ring / the same over all, with ωm at θi/2.
#[test]
fn light_is_filtered_with_the_weight_of_engines() {
    let ring = (0..64 * 32).map(|k| [if k / 64 == 5 { 3.0 } else { 0.0 }; 3]).collect();
    let light = Light::Map(Environment::new(64, 32, ring).unwrap());
    for (roughness, terms) in
        [(0.5, ""), (0.7, ", masking = \"none\""), (0.6, ", fresnel = \"dielectric\", eta = 1.5")]
    {
        let alpha = roughness * roughness;
        let weight = |theta: f64| {
            let cos2 = (0.5 * theta).cos().powi(2);
            let d = alpha * alpha / (PI * (cos2 * (alpha * alpha - 1.0) + 1.0).powi(2));
            d * theta.cos() * theta.sin()
        };
        let integral = |a: f64, b: f64| -> f64 {
            let rule = gauss_legendre(60);
            rule.iter().map(|node| (b - a) * node.weight * weight(a + (b - a) * node.x)).sum()
        };
        let truth = 3.0 * integral(5.0 * PI / 32.0, 6.0 * PI / 32.0) / integral(0.0, FRAC_PI_2);
        let lobe = &lobes(&format!("model = \"ggx\", roughness = {roughness}{terms}"))[0];
        for evaluator in evaluators() {
            let ld = prefiltered(evaluator, lobe, &light, &[[0.0, 0.0, 1.0]], 1e-4, &Unobserved).unwrap();
            close3(ld[0], [truth; 3], 3e-4);
        }
    }
}

/// An EXR file of a map: a table over normals is one.
fn exr(dir: &Path, name: &str, width: usize, height: usize, texels: Vec<f32>) -> PathBuf {
    let light = Light::Constant(Radiance::new([1.0; 3]).unwrap());
    let axes = [nodes(Variable::ThetaN, height, [0.0, PI]), nodes(Variable::PhiN, width, [0.0, TAU])];
    let table =
        order(&Evaluator::Cpu, &light, Check::Sample(0)).irradiance(axes, &mut Timings::default()).unwrap();
    let table = Table { values: texels.into(), ..table };
    let path = dir.join(name);
    std::fs::write(&path, EXR.encode(&table, &Provenance::new()).unwrap()).unwrap();
    path
}

#[test]
fn hostile_maps_are_refused_with_their_reason() {
    let dir = tempfile::tempdir().unwrap();
    let mut texels = vec![0.5f32; 16 * 8 * 3];
    let good = exr(dir.path(), "good.exr", 16, 8, texels.clone());
    assert_eq!(read(&good, REFUSE).unwrap().map.texel(7, 15), [0.5; 3]);

    let bytes = std::fs::read(&good).unwrap();
    let write = |name: &str, bytes: &[u8]| {
        let path = dir.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    let refused = |path: &Path, what: &[&str]| {
        let why = read(path, REFUSE).unwrap_err().to_string();
        assert!(what.iter().all(|what| why.contains(what)), "{why}");
        assert!(why.contains(path.file_name().unwrap().to_str().unwrap()), "{why}");
    };
    for cut in [6, 40, bytes.len() / 2, bytes.len() - 5] {
        refused(&write("cut.exr", &bytes[..cut]), &["OpenEXR"]);
    }
    refused(&write("empty.exr", b""), &["empty"]);
    refused(&write("text.exr", b"not a map"), &["neither OpenEXR nor Radiance"]);
    refused(&dir.path().join("missing.exr"), &["cannot read"]);
    refused(
        &write("large.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8192 +X 16384\n"),
        &["16384 × 8192"],
    );
    refused(&write("long.hdr", b"#?RADIANCE\n\n-Y 1 +X 33554432\n"), &["33554432 × 1"]);
    refused(&write("cut.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\nabc"), &["Radiance HDR"]);
    refused(&write("none.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 0 +X 0\n"), &["none.hdr"]);

    texels[(3 * 16 + 5) * 3 + 1] = f32::NAN;
    texels[(4 * 16 + 5) * 3 + 2] = f32::INFINITY;
    let bad = exr(dir.path(), "bad.exr", 16, 8, texels);
    refused(&bad, &["row 3, column 5: G is NaN", "2 of 128", "--clamp"]);
    let MapFile { map, clamped, .. } = read(&bad, InvalidTexels::Clamp).unwrap();
    assert_eq!((clamped.texels, map.texel(3, 5), map.texel(4, 5)), (2, [0.5, 0.0, 0.5], [0.5; 3]));
}

/// Radiance HDR: mantissas of 8 bits and a common exponent (Ward 1991): (m + ½) 2^(e − 136), or without the half.
#[test]
fn radiance_hdr_is_read() {
    let dir = tempfile::tempdir().unwrap();
    let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n".to_vec();
    bytes.extend([128, 64, 32, 129, 200, 100, 50, 140]);
    let path = dir.path().join("two.hdr");
    std::fs::write(&path, bytes).unwrap();
    let map = read(&path, REFUSE).unwrap().map;
    assert_eq!((map.width(), map.height()), (2, 1));
    for (texel, truth) in [(map.texel(0, 0), [1.0, 0.5, 0.25]), (map.texel(0, 1), [3200.0, 1600.0, 800.0])] {
        for (a, b) in texel.into_iter().zip(truth) {
            assert!((a - b).abs() <= 0.02 * b, "{texel:?}");
        }
    }
}

/// 16384 columns: bands of rows fit any device.
#[test]
fn a_map_of_16384_columns_is_integrated() {
    let (width, height) = (16384, 8);
    let texel = |k: usize| [1.0 + (k % width) as f32 / width as f32, 0.5, (k / width) as f32];
    let map = Environment::new(width, height, (0..width * height).map(texel).collect()).unwrap();
    let light = Light::Map(map);
    let order = order(device(), &light, Check::All);
    let table = order.irradiance(grid(3, 3), &mut Timings::default()).unwrap();
    println!("{:?} {}", table.error.measured_max, table.rule);
    assert_within(&order, &table);
}

fn gonio(args: &[&str]) -> (i32, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_gonio")).args(args).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
}

#[test]
fn the_command_bakes_a_set() {
    let dir = tempfile::tempdir().unwrap();
    let map = exr(dir.path(), "map.exr", 16, 8, (0..16 * 8 * 3).map(|k| (k % 7) as f32).collect());
    let map = map.to_str().unwrap();
    for (quantity, tables) in [("irradiance", 1), ("sh", 3)] {
        let out = dir.path().join(quantity);
        let out_name = out.to_str().unwrap();
        let args =
            ["light", "--env", map, "--quantity", quantity, "--normals", "4x8", "--out", out_name, "--json"];
        let (code, stdout, stderr) = gonio(&args);
        assert_eq!(code, 0, "{stderr}");
        let manifest: serde_json::Value = serde_json::from_str(&stdout).unwrap();
        assert_eq!(manifest["tables"].as_array().unwrap().len(), tables);
        assert_eq!(manifest["light"]["width"], 16);
        assert!(manifest["tables"][0]["files"]["exr"].is_string());
        assert_eq!(verify(&out).unwrap(), Vec::<String>::new());
        assert!(out.join("light.png").exists());
    }
    let out = dir.path().join("le");
    let out_name = out.to_str().unwrap();
    let args = [
        "light",
        "lambert",
        "--set",
        "albedo=0.5",
        "--sky",
        "disk:theta=0,radius=10,radiance=2",
        "--quantity",
        "radiance",
        "--exits",
        "3x1",
        "--out",
        out_name,
        "--no-picture",
        "--format",
        "npy",
    ];
    let (code, stdout, stderr) = gonio(&args);
    assert_eq!(code, 0, "{stderr}");
    assert!(stdout.contains("radiance_split_sum"), "{stdout}");

    let radiance = ["light", "lambert", "--set", "albedo=1", "--sky", "constant:1", "--quantity", "radiance"];
    for (args, code, what) in [
        (vec!["light", "--out", out_name], 2, "--env"),
        (vec!["light", "--sky", "moon", "--out", out_name], 2, "no light"),
        (
            vec!["light", "--sky", "constant:1", "--quantity", "radiance", "--out", out_name],
            2,
            "nothing is lit",
        ),
        (vec!["light", "--env", "/nowhere.exr", "--out", out_name], 2, "nowhere.exr"),
        (
            vec!["light", "--sky", "constant:1", "--normals", "65536x65536", "--out", out_name],
            2,
            "65536 theta_n × 65536 phi_n",
        ),
        ([&radiance[..], &["--exits", "4096x4096", "--out", out_name]].concat(), 2, "4096 theta_e"),
    ] {
        let (got, _, stderr) = gonio(&args);
        assert!(got == code && stderr.contains(what), "{args:?}: {got} {stderr}");
    }
}
