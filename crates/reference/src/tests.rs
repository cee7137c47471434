//! What the reference promises of itself. The quadrature's own tests are beside it.

use crate::definition;
use crate::diffuse::gltf::GLTF_DIFFUSE;
use crate::diffuse::lambert::LAMBERT;
use crate::fresnel::none::Constant;
use crate::fresnel::schlick::Schlick;
use crate::masking::none::Unmasked;
use crate::masking::smith_correlated::SmithCorrelated;
use crate::masking::smith_separable::SmithSeparable;
use crate::microfacet::Microfacet;
use crate::mirror::Mirror;
use crate::ndf::ggx::Ggx;
use crate::quadrature::integrate;
use crate::{Angles, MIN_MU, Masking, Parameters, Reference, Setting, microfacet};
use std::f64::consts::{FRAC_PI_2, LN_2, PI};

const ALPHAS: [f64; 8] = [1e-6, 1e-4, 1e-3, 1e-2, 0.05, 0.1, 0.5, 1.0];
const MUS: [f64; 8] = [0.0, 1e-6, 1e-4, 1e-3, 1e-2, 0.1, 0.5, 1.0];

/// The larger difference of two pairs; NaN, which no `<` lets through, if either holds one.
fn difference(a: [f64; 2], b: [f64; 2]) -> f64 {
    let [x, y] = [0, 1].map(|k| (a[k] - b[k]).abs());
    if x.is_nan() || y.is_nan() { f64::NAN } else { x.max(y) }
}

fn relative(a: [f64; 2], b: [f64; 2]) -> f64 {
    difference([a[0] / b[0], a[1] / b[1]], [1.0; 2])
}

const GGX: &dyn Reference = &Microfacet { ndf: &Ggx, masking: &SmithCorrelated, fresnel: &Schlick };
const MIRROR: &dyn Reference = &Mirror { fresnel: &Schlick };

/// GGX under other maskings, without Fresnel.
const CORRELATED: &Microfacet = &white(&SmithCorrelated);
const SEPARABLE: &Microfacet = &white(&SmithSeparable);
const UNMASKED: &Microfacet = &white(&Unmasked);

const fn white(masking: &'static dyn Masking) -> Microfacet {
    Microfacet { ndf: &Ggx, masking, fresnel: &Constant }
}

/// ρ_dh as it is defined, from values: no half-vector integral, no horizon.
fn defined(model: &dyn Reference, mu: f64, alpha: f64) -> [f64; 2] {
    let theta_i = mu.acos();
    let ring = |theta_e: f64| {
        let weight = 2.0 * theta_e.cos() * theta_e.sin();
        let value = |delta_phi| {
            let f = model
                .brdf(&Angles { theta_i, theta_e, delta_phi, phi_i: 0.0 }, &alpha.into())
                .unwrap_or([f64::NAN; 2]);
            f.map(|f| weight * f)
        };
        integrate(value, &[0.0, 0.1, 1.0, PI], 1e-11).value_or_nan()
    };
    integrate(ring, &[0.0, theta_i, FRAC_PI_2], 1e-10).value_or_nan()
}

#[test]
fn the_integral_over_normals_is_the_definition() {
    let models: [(&dyn Reference, &[f64]); 3] =
        [(GGX, &[0.05, 0.1, 0.3, 1.0]), (SEPARABLE, &[0.1, 1.0]), (UNMASKED, &[0.3, 1.0])];
    for (k, (model, alphas)) in models.into_iter().enumerate() {
        for &alpha in alphas {
            for mu in [0.02, 0.2, 0.6, 0.95] {
                let error = difference(model.rho_dh(mu, &alpha.into()), defined(model, mu, alpha));
                assert!(error < 1e-9, "model {k}: ρ(μ = {mu}, α = {alpha}) is off by {error:e}");
            }
        }
    }
}

/// The check above can fail: ρ at an α that is wrong in the seventh digit does not pass.
#[test]
fn the_definition_tells_a_wrong_alpha() {
    let error = difference(GGX.rho_dh(0.6, &(0.3 * (1.0 + 1e-7)).into()), defined(GGX, 0.6, 0.3));
    assert!(error > 1e-9, "{error:e}");
    assert!(difference([f64::NAN, 0.0], [0.0; 2]).is_nan());
}

#[test]
fn lambert_reflects_everything() {
    for mu in MUS {
        assert!(difference(LAMBERT.rho_dh(mu, &0.5.into()), [1.0, 0.0]) < 1e-14, "μ = {mu}");
    }
    assert!(difference(LAMBERT.rho_hh(&0.5.into()), [1.0, 0.0]) < 1e-14);
}

/// A + B is Lambert's. At normal incidence ωi·ωm = c = cos(θe/2), so B = 8 ∫ (1 − c)⁵ (2c² − 1) c dc over
/// [1/√2, 1], a polynomial.
#[test]
fn gltf_diffuse_is_a_split_lambert() {
    for mu in MUS {
        let [a, b] = GLTF_DIFFUSE.rho_dh(mu, &0.5.into());
        assert!((a + b - 1.0).abs() < 1e-12 && b > 0.0, "μ = {mu}: {a} + {b}");
    }
    let b = GLTF_DIFFUSE.rho_dh(1.0, &0.5.into())[1];
    assert!((b - GLTF_B_AT_NORMAL).abs() < 1e-14, "{b}");
}
const GLTF_B_AT_NORMAL: f64 = 0.000081888140563477;

/// GGX, F = 1, either Smith: ρ(μ = 1, α = 1) = 1 − ln 2.
#[test]
fn ggx_has_its_closed_form() {
    for model in [GGX, SEPARABLE] {
        let [a, b] = model.rho_dh(1.0, &1.0.into());
        assert!((a + b - (1.0 - LN_2)).abs() < 1e-11, "{a} + {b}");
    }
}

/// What Fresnel splits adds up to what is there without it.
#[test]
fn without_fresnel_it_is_the_sum() {
    let angles = Angles { theta_i: 0.4, theta_e: 1.1, delta_phi: 0.3, phi_i: 0.0 };
    let sum = |f: Option<[f64; 2]>| f.map_or(f64::NAN, |[a, b]| a + b);
    assert!(
        (sum(CORRELATED.brdf(&angles, &0.2.into())) / sum(GGX.brdf(&angles, &0.2.into())) - 1.0).abs()
            < 1e-14
    );
    for (mu, alpha) in [(0.1, 0.2), (0.7, 1.0), (0.3, 0.0)] {
        let [a, b] = GGX.rho_dh(mu, &alpha.into());
        assert!(difference(CORRELATED.rho_dh(mu, &alpha.into()), [a + b, 0.0]) < 1e-10);
    }
    assert_eq!(CORRELATED.rho_hh(&0.0.into()), [1.0, 0.0]);
    assert_eq!(
        Microfacet { ndf: &Ggx, masking: &SmithSeparable, fresnel: &Schlick }.rho_hh(&0.0.into()),
        MIRROR.rho_hh(&0.0.into())
    );
}

/// As α → 0, ρ of separable Smith depends on μ/α alone: 0.8815 where it is least, near μ = 0.96 α; unlike
/// correlated, its limit as μ/α → 0 is not 1 but 0.9361.
#[test]
fn a_smooth_separable_ggx_has_its_limits() {
    let rho = |ratio: f64, alpha: f64| SEPARABLE.rho_dh(ratio * alpha, &alpha.into())[0];
    for ratio in [0.2, 0.96, 5.0] {
        let change = rho(ratio, 1e-4) - rho(ratio, 1e-6);
        assert!(change.abs() < 1e-6, "ratio {ratio}: {change:e}");
    }
    let least = rho(0.96, 1e-6);
    assert!((least - 0.8815).abs() < 1e-4, "{least}");
    assert!(least < rho(0.85, 1e-6) && least < rho(1.07, 1e-6), "{least} is not the least");
    let grazing = rho(1e-3, 1e-4);
    assert!((grazing - 0.9361).abs() < 2e-3, "{grazing}");
    assert!(rho(1e3, 1e-4) > 0.999);
}

/// Shadowing and masking of the same facet go together, so to take them as independent loses light; none at
/// all gains it without bound: ρ grows as α/μ.
#[test]
fn maskings_are_in_order() {
    for alpha in [0.1, 0.5, 1.0] {
        for mu in [0.05, 0.3, 0.8] {
            let [none, correlated, separable] =
                [UNMASKED, CORRELATED, SEPARABLE].map(|model| model.rho_dh(mu, &alpha.into())[0]);
            assert!(none > correlated && correlated > separable, "{none}, {correlated}, {separable}");
        }
    }
    let [near, nearer] = [1e-3, 1e-4].map(|mu| UNMASKED.rho_dh(mu, &0.5.into())[0]);
    assert!(near > 1.0 && (nearer / near / 10.0 - 1.0).abs() < 0.05, "{near}, {nearer}");
}

/// As α → 0, ρ of GGX depends on μ/α alone: 1 at both ends, 0.8915 where it is least, near μ = 1.11 α.
#[test]
fn a_smooth_ggx_depends_on_the_ratio_alone() {
    let rho = |ratio: f64, alpha: f64| GGX.rho_dh(ratio * alpha, &alpha.into()).iter().sum::<f64>();
    for ratio in [0.2, 1.11, 5.0] {
        let change = rho(ratio, 1e-4) - rho(ratio, 1e-6);
        assert!(change.abs() < 1e-6, "ratio {ratio}: {change:e}");
    }
    let least = rho(1.11, 1e-6);
    assert!((least - 0.8915).abs() < 1e-4, "{least}");
    assert!(least < rho(1.0, 1e-6) && least < rho(1.25, 1e-6), "{least} is not the least");
    assert!(rho(1e-3, 1e-4) > 0.999 && rho(1e3, 1e-4) > 0.999);
}

/// Values to 1e-12, against the formulas evaluated with 120 digits (mpmath) at the same f64 angles.
#[test]
fn ggx_values_hold_to_twelve_digits() {
    for (alpha, [theta_i, theta_e, delta_phi], expected) in GGX_VALUES {
        let angles = Angles { theta_i, theta_e, delta_phi, phi_i: 0.0 };
        let error = GGX.brdf(&angles, &alpha.into()).map_or(f64::NAN, |value| relative(value, expected));
        assert!(error < 1e-12, "{angles:?}, α = {alpha}: off by {error:e}");
    }
}

/// α, [θi, θe, δφ], [A, B].
#[rustfmt::skip]
const GGX_VALUES: [(f64, [f64; 3], [f64; 2]); 12] = [
    (1.0, [0.3, 1.1, 2.0], [0.11295834788495637, 3.01158675953719e-06]),
    (0.5, [1.2, 1.2, 0.0], [1.3312171402701816, 0.15685945377397992]),
    (0.1, [0.7, 0.7000001, 1e-06], [13.545622613545765, 0.0097478480022092]),
    (0.001, [1e-07, 0.001, 3.0], [50925.59576734516, 1.552587799562958e-30]),
    (0.001, [1.5697963267948967, 1.5697963267948967, 0.001], [0.00784632341325709, 1.3988890581358606]),
    (1e-06, [0.7, 0.7, 0.0], [135935862549.13736, 97823574.13993122]),
    (1e-06, [1.0, 1.000001, 1e-06], [77477320446.76427, 1623852344.1451616]),
    (1e-06, [FRAC_PI_2, FRAC_PI_2, 0.0], [3.9718239816106554e+17, 1.3327227387598105e+24]),
    (1e-06, [FRAC_PI_2, 1.5707962657948966, 1e-09], [84.04323531372876, 278729998.9420672]),
    (0.0001, [FRAC_PI_2, 1e-07, 1.5], [6.348690912104347e-05, 1.371411411767288e-07]),
    (0.3, [1.5, 1.5, 3.1415925535897933], [0.33228461981199386, 9.889344800875653e-76]),
    (1.0, [FRAC_PI_2, FRAC_PI_2, 3.0], [1335088.4288600862, 1.3169227349075445e-07]),
];

#[test]
fn values_are_reciprocal() {
    let thetas = [0.0, 1e-7, 1e-3, 0.5, 1.2, FRAC_PI_2 - 1e-3, FRAC_PI_2 - 1e-6, FRAC_PI_2];
    for alpha in ALPHAS {
        for (theta_i, theta_e) in thetas.iter().flat_map(|&i| thetas.map(|e| (i, e))) {
            for delta_phi in [0.0, 1e-6, 0.3, 1.5, PI] {
                let there = Angles { theta_i, theta_e, delta_phi, phi_i: 0.0 };
                let back = Angles { theta_i: theta_e, theta_e: theta_i, delta_phi: -delta_phi, phi_i: 0.0 };
                let [f, g] = [there, back].map(|a| GGX.brdf(&a, &alpha.into()).unwrap_or([f64::NAN; 2]));
                let same = |k: usize| f[k] >= 0.0 && (f[k] - g[k]).abs() <= 1e-13 * f[k] + f64::MIN_POSITIVE;
                assert!(same(0) && same(1), "{there:?}, α = {alpha}: {f:?}, {g:?}");
            }
        }
    }
}

#[test]
fn ggx_creates_no_energy() {
    for alpha in ALPHAS {
        for mu in MUS {
            let [a, b] = GGX.rho_dh(mu, &alpha.into());
            assert!(a >= 0.0 && b >= 0.0 && a + b <= 1.0 + 1e-9, "μ = {mu}, α = {alpha}: {a} + {b}");
        }
    }
}

/// The mean has tolerances and breaks of its own; plain halving over μ knows neither.
#[test]
fn the_mean_is_the_mean() {
    for alpha in [1e-2, 0.3] {
        let weighted = |mu: f64| GGX.rho_dh(mu, &alpha.into()).map(|rho| 2.0 * mu * rho);
        let plain = integrate(weighted, &[0.0, 0.02, 1.0], 1e-9).value_or_nan();
        let error = difference(GGX.rho_hh(&alpha.into()), plain);
        assert!(error < 1e-9, "α = {alpha}: off by {error:e}");
    }
    let mirror = definition::rho_hh(&0.0.into(), 0.0, |mu, _| MIRROR.rho_dh(mu, &0.0.into()));
    assert!(difference(MIRROR.rho_hh(&0.0.into()), mirror) < 1e-12, "{mirror:?}");
}

#[test]
fn zero_roughness_is_the_mirror() {
    let angles = Angles { theta_i: 0.5, theta_e: 0.5, delta_phi: 0.0, phi_i: 0.0 };
    assert_eq!(GGX.brdf(&angles, &0.0.into()), None);
    assert_eq!(GGX.factors(&angles, &0.0.into()), None);
    assert_eq!(GGX.rho_dh(0.3, &0.0.into()), MIRROR.rho_dh(0.3, &0.0.into()));
    assert_eq!(GGX.rho_hh(&0.0.into()), MIRROR.rho_hh(&0.0.into()));
    assert!(difference(GGX.rho_dh(0.3, &1e-6.into()), MIRROR.rho_dh(0.3, &0.0.into())) < 1e-9);
    assert!(difference(GGX.rho_hh(&1e-6.into()), MIRROR.rho_hh(&0.0.into())) < 1e-9);
}

#[test]
fn the_factors_make_the_value() {
    let angles = Angles { theta_i: 0.4, theta_e: 1.1, delta_phi: 0.3, phi_i: 0.0 };
    let made = GGX.factors(&angles, &0.2.into()).map(|f| f.d * f.g2 / (4.0 * 0.4_f64.cos() * 1.1_f64.cos()));
    let value = GGX.brdf(&angles, &0.2.into()).map(|f| f[0] + f[1]);
    assert!(made.zip(value).is_some_and(|(a, b)| (a / b - 1.0).abs() < 1e-14), "{made:?}, {value:?}");
}

/// Input out of the domain ends in NaN or in the nearest value, never in a panic or in a number made up.
#[test]
fn bad_input_is_not_a_number() {
    for model in [GGX, GLTF_DIFFUSE] {
        assert!(model.rho_dh(f64::NAN, &0.5.into())[0].is_nan());
    }
    assert!(GGX.rho_dh(0.5, &f64::NAN.into())[0].is_nan());
    assert!(GGX.rho_hh(&f64::NAN.into())[0].is_nan());
    assert_eq!(GGX.rho_dh(-1.0, &0.5.into()), GGX.rho_dh(MIN_MU, &0.5.into()));
    assert_eq!(GGX.rho_dh(2.0, &0.5.into()), GGX.rho_dh(1.0, &0.5.into()));
}

/// An integral to few digits is the one to all of them, to within those few: peaks, grazing directions, grooves and films
/// are not missed by a rule that is asked for little.
#[test]
fn integrals_keep_the_error_that_they_are_asked_for() {
    let parts = [
        ("ggx", "smith-correlated", "schlick"),
        ("beckmann", "v-cavity", "none"),
        ("charlie", "smith-correlated", "none"),
        ("gtr", "smith-separable", "thin-film"),
        ("ggx-anisotropic", "smith-correlated", "schlick"),
        ("beckmann-anisotropic", "smith-separable", "none"),
    ];
    for (ndf, masking, fresnel) in parts {
        let model = microfacet(ndf, masking, fresnel).unwrap();
        for (aspect, strength) in [(1.0, 0.0), (100.0, 0.0), (0.01, 0.0), (1.0, 1.0), (1.0, 0.3)] {
            if (aspect, strength) != (1.0, 0.0) && !ndf.ends_with("anisotropic") {
                continue;
            }
            let values = [("aspect", aspect), ("strength", strength), ("thickness", 500.0)];
            let parameters = Parameters::named(values).unwrap();
            for alpha in [1e-6, 0.05, 1.0] {
                // GTR and Charlie begin later.
                let Ok(setting) = Setting::measured(model.measure(), alpha, &parameters) else { continue };
                for mu in [0.0, 1e-3, 0.5, 1.0] {
                    for phi in [0.0, 0.4, FRAC_PI_2] {
                        if phi > 0.0 && !ndf.ends_with("anisotropic") {
                            continue;
                        }
                        let exact = model.rho_dh_at(mu, phi, &setting);
                        for error in [1e-3, 1e-5, 1e-7] {
                            let found = model.rho_dh_at(mu, phi, &setting.within(error));
                            let off = difference(found, exact);
                            let case = format!("{ndf}-{masking}-{fresnel} {aspect} {strength} α = {alpha}");
                            assert!(off <= error, "{case}, μ = {mu}, φ = {phi}: off by {off:e} of {error:e}");
                        }
                    }
                }
            }
        }
    }
}

/// A surface whose slopes are the same along both axes is the isotropic one.
#[test]
fn equal_slopes_are_isotropic() {
    for ndf in ["ggx", "beckmann"] {
        let round = microfacet(ndf, "smith-correlated", "schlick").unwrap();
        let stretched = microfacet(&format!("{ndf}-anisotropic"), "smith-correlated", "schlick").unwrap();
        for (alpha, mu) in [(1e-6, 0.3), (0.01, 1e-6), (0.1, 0.05), (0.6, 0.7), (1.0, 1.0)] {
            let setting = alpha.into();
            let error = difference(round.rho_dh(mu, &setting), stretched.rho_dh_at(mu, 0.7, &setting));
            assert!(error < 1e-9, "{ndf}: ρ(μ = {mu}, α = {alpha}) is off by {error:e}");
            if alpha > 0.05 {
                let error = difference(round.rho_hh(&setting), stretched.rho_hh(&setting));
                assert!(error < 1e-7, "{ndf}: the mean at α = {alpha} is off by {error:e}");
            }
        }
    }
}
