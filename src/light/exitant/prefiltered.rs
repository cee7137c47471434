//! What engines make of exitant radiance: pre-filtered radiance times the split sum.

use crate::bake::{Evaluator, Observer};
use crate::base::error::Result;
use crate::light::exitant::{View, irradiance_of, radiance};
use crate::light::{Frame, Light, Radiance, angles};
use crate::model::lobe::Lobe;
use std::f64::consts::PI;

/// LD, the pre-filtered radiance of engines: ∫ L D(ωm) cos θi dωi / ∫ D(ωm) cos θi dωi at n = v = r for each r. Karis 2013,
/// "Real shading in Unreal Engine 4", eq. 8 with his code; Lagarde & de Rousiers 2014, eq. 54. Their weight has neither masking nor
/// Fresnel term, unlike f cos θi. A lobe that is no microfacets' is filtered with its own f cos θi.
///
/// # Errors
/// As [`radiance`]'s.
pub fn prefiltered(
    evaluator: &Evaluator,
    lobe: &Lobe,
    light: &Light,
    directions: &[[f64; 3]],
    tolerance: f64,
    observer: &dyn Observer,
) -> Result<Vec<[f64; 3]>> {
    let plain = distribution(lobe)?.with_weights(vec![[1.0; 2]; 3])?;
    let along = |&r: &[f64; 3]| {
        let (theta, phi) = angles(r);
        View { frame: Frame::new(theta, phi), theta_e: 0.0, phi_e: 0.0 }
    };
    let views: Vec<_> = directions.iter().map(along).collect();
    let lobes = std::slice::from_ref(&plain);
    let lit = radiance(evaluator, lobes, light, &views, tolerance, observer)?;
    let white = Light::Constant(Radiance::WHITE);
    let one = radiance(evaluator, lobes, &white, &views[..1.min(views.len())], tolerance, observer)?;
    let Some(whole) = one.first().map(|one| one.value) else { return Ok(Vec::new()) };
    Ok(lit.iter().map(|lit| std::array::from_fn(|c| lit.value[c] / whole[c])).collect())
}

/// A lobe with the same D and without other terms at θe = 0: Ashikhmin and Neubelt's visibility 1/(4 (μi + μe − μi μe)) is 1/4
/// there, so that f cos θi = D cos θi / 4.
fn distribution(lobe: &Lobe) -> Result<Lobe> {
    if lobe.is_delta() || lobe.model().microfacet.is_none() {
        return Ok(lobe.clone());
    }
    let model = lobe.model().with_terms(Some("ashikhmin-neubelt"), Some("none"))?;
    let plain = Lobe::new(model, lobe.roughness(), lobe.weights().to_vec())?;
    Ok(plain.with_parameters(lobe.parameters()))
}

/// What engines make of a lobe: LD(r) (F0·A + F90·B)(θe), and of a diffuse one, without a roughness, E(n)/π in place
/// of LD.
///
/// # Errors
/// As [`radiance`]'s.
pub fn split_sum(
    evaluator: &Evaluator,
    lobes: &[Lobe],
    light: &Light,
    views: &[View],
    tolerance: f64,
    observer: &dyn Observer,
) -> Result<Vec<[f64; 3]>> {
    let mut all = vec![[0.0; 3]; views.len()];
    let white = Light::Constant(Radiance::WHITE);
    for lobe in lobes {
        // A and B hang on θe alone (and on φe where azimuths tell): each is integrated once.
        let mut distinct: Vec<View> = Vec::new();
        let at_zenith = |view: &View| View { frame: Frame::new(0.0, 0.0), ..*view };
        let same = |a: &View, b: &View| {
            a.theta_e == b.theta_e && (a.phi_e == b.phi_e || !lobe.model().is_anisotropic())
        };
        for view in views.iter().map(at_zenith) {
            if !distinct.iter().any(|known| same(known, &view)) {
                distinct.push(view);
            }
        }
        let terms = radiance(evaluator, std::slice::from_ref(lobe), &white, &distinct, tolerance, observer)?;
        let incident = if lobe.model().shape.is_some() || lobe.model().is_delta() {
            let mirrors: Vec<_> = views.iter().map(View::mirror).collect();
            prefiltered(evaluator, lobe, light, &mirrors, tolerance, observer)?
        } else {
            let normals: Vec<_> = views.iter().map(|view| view.frame.normal()).collect();
            irradiance_of(evaluator, light, &normals)?.into_iter().map(|e| e.map(|e| e / PI)).collect()
        };
        for ((sum, view), incident) in all.iter_mut().zip(views).zip(incident) {
            let found = distinct.iter().position(|known| same(known, &at_zenith(view)));
            let Some(term) = found.and_then(|k| terms.get(k)) else { continue };
            (0..3).for_each(|c| sum[c] += incident[c] * term.value[c]);
        }
    }
    Ok(all)
}
