//! `disney = { base_color = [..], metallic = .., … }`: Burley 2012, *Physically-Based Shading at Disney*, as a sum of lobes.
//!
//! Names, ranges and defaults are those of BRDF Explorer's `disney.brdf`, whose formulas these are; but colours are linear as
//! everywhere in recipes, and what it takes of the monitor's colours is not. With C the base colour, m the metalness and
//! T = C / (0.3 R + 0.6 G + 0.1 B) its tint:
//!
//! ```text
//! f = (1 − m) (C ((1 − subsurface) burley + subsurface disney-subsurface) + sheen mix(1, T, sheen_tint) disney-sheen)
//!   + ggx-anisotropic, smith-separable, F0 = mix(0.08 specular mix(1, T, specular_tint), C, m), F90 = 1
//!   + clearcoat/4 gtr, disney-clearcoat, γ = 1, F0 = 0.04, F90 = 1, α = mix(0.1, 0.001, clearcoat_gloss)
//! αx = max(0.001, roughness²/aspect),  αy = max(0.001, roughness² aspect),  aspect = √(1 − 0.9 anisotropic)
//! ```
//!
//! Masking is of these α, as `disney.brdf` has it today; the notes of 2012 took it of α = (1/2 + roughness/2)². The
//! clearcoat's is of α = 1/4.

use crate::base::error::Result;
use crate::model;
use crate::model::compensation::Compensation;
use crate::scene::recipe::{Item, channels};
use crate::scene::{Distribution, MaterialLobe, Weights};

const KEYS: [&str; 11] = [
    "base_color",
    "metallic",
    "subsurface",
    "specular",
    "roughness",
    "specular_tint",
    "anisotropic",
    "sheen",
    "sheen_tint",
    "clearcoat",
    "clearcoat_gloss",
];

/// The least α.
const LEAST: f64 = 0.001;

pub(super) fn lobes(item: Item) -> Result<Vec<MaterialLobe>> {
    let fields = item.table(&KEYS)?;
    let number = |key: &str, default: f64| -> Result<f64> {
        fields.get(key).map_or(Ok(default), |item| item.number_in([0.0, 1.0]))
    };
    let base = channels(fields.require("base_color")?, [0.0, 1.0])?;
    let [metallic, subsurface, specular] =
        [number("metallic", 0.0)?, number("subsurface", 0.0)?, number("specular", 0.5)?];
    let [roughness, anisotropic] = [number("roughness", 0.5)?, number("anisotropic", 0.0)?];
    let [specular_tint, sheen, sheen_tint] =
        [number("specular_tint", 0.0)?, number("sheen", 0.0)?, number("sheen_tint", 0.5)?];
    let [clearcoat, gloss] = [number("clearcoat", 0.0)?, number("clearcoat_gloss", 1.0)?];

    let luminance = 0.3 * base[0] + 0.6 * base[1] + 0.1 * base[2];
    let tint = base.map(|c| if luminance > 0.0 { c / luminance } else { 1.0 });
    let tinted = |share: f64| tint.map(|tint| mix(1.0, tint, share));
    let diffuse = |share: f64| base.map(|c| (1.0 - metallic) * share * c);
    let sheen = tinted(sheen_tint).map(|tint| (1.0 - metallic) * sheen * tint);
    let [tinted, plain] = [tinted(specular_tint), [1.0; 3]];
    let f0 = std::array::from_fn(|k| mix(0.08 * specular * tinted[k], base[k], metallic));

    let rough = Some(Distribution::constant(roughness));
    let lobe = |model: &str, roughness, weights| MaterialLobe {
        model: model.into(),
        roughness,
        parameters: Vec::new(),
        weights: Weights::Constant(weights),
        compensation: Compensation::None,
        factors: Vec::new(),
    };
    let mut lobes = vec![
        lobe("burley", rough.clone(), [diffuse(1.0 - subsurface), [0.0; 3]]),
        lobe("disney-subsurface", rough, [diffuse(subsurface), [0.0; 3]]),
        lobe("disney-sheen", None, [sheen, [0.0; 3]]),
    ];
    lobes.retain(|lobe| lobe.weights != Weights::Constant([[0.0; 3]; 2]));

    let aspect = (1.0 - 0.9 * anisotropic).sqrt();
    let [x, y] =
        [roughness * roughness / aspect, roughness * roughness * aspect].map(|alpha| alpha.max(LEAST));
    let ndf = if x == y { "ggx" } else { "ggx-anisotropic" };
    let model = model::find(ndf)?.with_terms(Some("smith-separable"), Some("schlick"))?;
    // α = √(αx αy) = roughness².
    let specular = lobe(model.name, Some(Distribution::constant((x * y).powf(0.25))), [f0, plain]);
    let parameters = if x == y { Vec::new() } else { vec![("aspect".into(), [x / y; 3])] };
    lobes.push(MaterialLobe { parameters, ..specular });

    if clearcoat > 0.0 {
        let model = model::find("gtr")?.with_terms(Some("disney-clearcoat"), Some("schlick"))?;
        let rough = Some(Distribution::constant(mix(0.1, LEAST, gloss).sqrt()));
        let coat = lobe(model.name, rough, [0.04, 1.0].map(|f| [0.25 * clearcoat * f; 3]));
        lobes.push(MaterialLobe { parameters: vec![("gamma".into(), [1.0; 3])], ..coat });
    }
    Ok(lobes)
}

fn mix(a: f64, b: f64, t: f64) -> f64 {
    a * (1.0 - t) + b * t
}
