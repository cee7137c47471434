//! The lobes of a metallic-roughness material with its extensions. With c the base colour, m the metalness, F0 and s the
//! dielectric's (KHR_materials_ior, KHR_materials_specular) and Fc = (1 − ωi·ωm)⁵:
//!
//! ```text
//! f = (1 − m) (c (1 − max F) / π + F S) + m (c (1 − Fc) + Fc) S,  F = s (F0 (1 − Fc) + Fc)
//! ```
//!
//! S is the specular lobe with F = 1. As max F = s (1 − (1 − max F0) (1 − Fc)), what is left of light below it is
//! `gltf_diffuse` times s (1 − max F0) and `lambert` times 1 − s: no model of their own. Transmission takes its share of
//! that. A rough diffuse surface (KHR_materials_diffuse_roughness) has Oren and Nayar's lobe in place of Lambert's, which is
//! what its text describes, σ = π/2 · roughness: linear in c, so that textures weigh it, as EON, which it mentions, is not.
//!
//! A sheen is Charlie's lobe upon that, which dims it by a factor. A thin film is a lobe of its own, in the mix that its factor says. A coat is a lobe upon all that, which it dims
//! by a factor; where its strength w varies, 1 − w x = (1 − w) + w (1 − x) has formulas for both parts.

use crate::model;
use crate::model::compensation::{Albedo, Compensation, Factor};
use crate::scene::gltf::extensions::Extended;
use crate::scene::{Distribution, Formula, FormulaInput, MaterialLobe, Weights};

/// A material's quantities.
pub struct Layers<'a> {
    pub base_color: &'a FormulaInput,
    pub metallic: &'a FormulaInput,
    pub roughness: Distribution,
    pub coat_roughness: Option<Distribution>,
    pub sheen_roughness: Option<Distribution>,
    pub diffuse_roughness: Option<Distribution>,
    pub extended: &'a Extended,
}

/// A lobe as it is put together.
#[derive(Clone)]
struct LayerLobe {
    model: String,
    roughness: Option<Distribution>,
    parameters: Vec<(String, [f64; 3])>,
    weights: [Formula; 2],
    factors: Vec<Factor>,
}

/// Lobes that are nothing, and why.
type Nothing = Vec<(String, String)>;

impl Layers<'_> {
    /// The lobes, and those that are left out.
    pub fn lobes(&self) -> (Vec<MaterialLobe>, Nothing) {
        let mut parts = self.base();
        self.sheen(&mut parts);
        self.coat(&mut parts);
        let mut nothing = Nothing::new();
        let lobes = parts.into_iter().filter_map(|part| {
            let [a, b] = &part.weights;
            if a.is_zero() && b.is_zero() {
                nothing.push((part.model.clone(), self.why_nothing(&part)));
                return None;
            }
            let weights = match a.varies() || b.varies() {
                true => Weights::Textured(part.weights),
                false => Weights::Constant([a.value(), b.value()]),
            };
            let LayerLobe { model, roughness, parameters, factors, .. } = part;
            let compensation = Compensation::None;
            Some(MaterialLobe { model, roughness, parameters, weights, compensation, factors })
        });
        (lobes.collect(), nothing)
    }

    /// Appendix B with KHR_materials_ior, _specular, _anisotropy, _iridescence, and what transmission takes.
    fn base(&self) -> Vec<LayerLobe> {
        let Extended { f0, specular, transmission, diffuse_transmission, strength, film, .. } = self.extended;
        let (c, m) = (self.base_color, self.metallic);
        let below = |weight: Formula| {
            let weight = weight.times(&m.rest()).times(&c.all());
            weight.times(&transmission.rest()).times(&diffuse_transmission.rest())
        };
        let diffuse = |smooth: &str, rough: &str, weight: Formula| LayerLobe {
            model: (if self.diffuse_roughness.is_some() { rough } else { smooth }).into(),
            roughness: self.diffuse_roughness.clone(),
            parameters: Vec::new(),
            weights: [below(weight), Formula::default()],
            factors: Vec::new(),
        };
        let (ndf, parameters) = match *strength {
            0.0 => ("ggx", Vec::new()),
            strength => ("ggx-anisotropic", vec![("strength".into(), [strength; 3])]),
        };
        let specular_lobe = LayerLobe {
            model: ndf.into(),
            roughness: Some(self.roughness.clone()),
            parameters,
            weights: [
                f0.all().times(&specular.all()).times(&m.rest()).plus(m.all().times(&c.all())),
                // (1 − m) s + m
                Formula::number(1.0).plus(Formula::number(-1.0).times(&specular.rest()).times(&m.rest())),
            ],
            factors: Vec::new(),
        };
        let mut parts =
            vec![diffuse("gltf_diffuse", "gltf_oren_nayar", f0.rest_of_max().times(&specular.all()))];
        if !specular.rest().is_zero() {
            parts.push(diffuse("lambert", "oren-nayar", specular.rest()));
        }
        let Some(film) = film else {
            parts.push(specular_lobe);
            return parts;
        };
        let dielectric = [0, 1, 2].map(|k| f0.value[k] * specular.value[k]);
        for (weight, f0) in [(m.rest(), dielectric), (m.all(), c.value)] {
            let mut part = specular_lobe.clone();
            part.model = with_fresnel(ndf, "thin-film");
            let film_parameters =
                [("thickness", [film.thickness; 3]), ("film_eta", [film.eta; 3]), ("f0", f0)];
            part.parameters.extend(film_parameters.map(|(name, value)| (name.into(), value)));
            part.weights = [film.factor.all().times(&weight), Formula::default()];
            if !part.weights[0].is_zero() {
                parts.push(part);
            }
        }
        if !film.factor.rest().is_zero() {
            let weights = specular_lobe.weights.each_ref().map(|weight| weight.times(&film.factor.rest()));
            parts.push(LayerLobe { weights, ..specular_lobe });
        }
        parts
    }

    /// KHR_materials_sheen: f_sheen + base · min(1 − m E(μi), 1 − m E(μe)), m the largest channel of its colour. As that is
    /// linear in m, a colour that varies has formulas for both parts. A roughness that varies is one that E has too: see
    /// `Material::at`.
    fn sheen(&self, parts: &mut Vec<LayerLobe>) {
        let (Some(sheen), Some(roughness)) = (&self.extended.sheen, &self.sheen_roughness) else { return };
        let model = with_fresnel("charlie", "none");
        let Ok(charlie) = model::find(&model) else { return };
        let constant = roughness.is_constant().then(|| roughness.min());
        let of = Albedo { model: charlie, roughness: constant, parameters: charlie.defaults() };
        let most = sheen.color.range()[1];
        if sheen.color.varies() {
            let factor = Factor::BelowSheen { of, most: 1.0 };
            below(parts, [sheen.color.rest_of_max(), sheen.color.max()], &factor);
        } else {
            parts.iter_mut().for_each(|part| part.factors.push(Factor::BelowSheen { of: of.clone(), most }));
        }
        parts.push(LayerLobe {
            model,
            roughness: Some(roughness.clone()),
            parameters: Vec::new(),
            weights: [sheen.color.all(), Formula::default()],
            factors: Vec::new(),
        });
    }

    /// KHR_materials_clearcoat: mix(base, F = 1 specular lobe, clearcoat · (0.04 + 0.96 (1 − μe)⁵)).
    fn coat(&self, parts: &mut Vec<LayerLobe>) {
        let (Some(coat), Some(roughness)) = (&self.extended.coat, &self.coat_roughness) else { return };
        let own = |weight: f64, formula: Formula| LayerLobe {
            model: with_fresnel("ggx", "none"),
            roughness: Some(roughness.clone()),
            parameters: Vec::new(),
            weights: [formula, Formula::default()],
            factors: vec![Factor::Coat { weight }],
        };
        if coat.factor.varies() {
            below(parts, [coat.factor.rest(), coat.factor.all()], &Factor::BelowCoat { weight: 1.0 });
            parts.push(own(1.0, coat.factor.all()));
        } else {
            let weight = coat.factor.value[0];
            parts.iter_mut().for_each(|part| part.factors.push(Factor::BelowCoat { weight }));
            parts.push(own(weight, Formula::number(1.0)));
        }
    }

    fn why_nothing(&self, part: &LayerLobe) -> String {
        let weight = &part.weights[0];
        let because = if !part.is_diffuse() {
            "it reflects nothing there"
        } else if self.metallic.rest().is_zero() {
            "it is metal everywhere"
        } else if self.base_color.all().is_zero() {
            "its base colour is black"
        } else if self.extended.transmission.rest().is_zero() {
            "what enters it is transmitted"
        } else {
            "nothing enters it"
        };
        format!("{because}, and its weight {} is 0", weight)
    }
}

impl LayerLobe {
    fn is_diffuse(&self) -> bool {
        matches!(self.model.as_str(), "gltf_diffuse" | "lambert" | "gltf_oren_nayar" | "oren-nayar")
    }
}

/// What lies below a layer whose strength w varies: as it is, times 1 − w, and dimmed, times w.
fn below(parts: &mut Vec<LayerLobe>, [rest, strength]: [Formula; 2], factor: &Factor) {
    let times = |part: &LayerLobe, by: &Formula| part.weights.each_ref().map(|weight| weight.times(by));
    let split = parts.iter().flat_map(|part| {
        let mut dimmed = LayerLobe { weights: times(part, &strength), ..part.clone() };
        dimmed.factors.push(factor.clone());
        [LayerLobe { weights: times(part, &rest), ..part.clone() }, dimmed]
    });
    *parts = split.collect();
}

/// The name of a distribution's lobe with another Fresnel term.
fn with_fresnel(ndf: &str, fresnel: &str) -> String {
    let model = model::find(ndf).and_then(|model| model.with_terms(None, Some(fresnel)));
    model.map_or_else(|_| ndf.to_owned(), |model| model.name.to_owned())
}
