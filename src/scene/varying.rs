//! What varies in a material, and the material at one setting of it.

use crate::base::error::{Error, Result};
use crate::model::Violation;
use crate::model::compensation::Factor;
use crate::scene::{Distribution, Formula, Material, Weights, metallic_roughness};

impl Material {
    /// The parameters that vary, and their ranges: `roughness` (`lobes[0].roughness` where several lobes have
    /// their own), and where textures weigh the lobes `metallic`, `base_color` and what else the formulas name.
    pub fn varying(&self) -> Vec<(String, [f64; 2])> {
        let mut varying: Vec<_> = self
            .roughness_names()
            .into_iter()
            .zip(&self.lobes)
            .filter_map(|(name, lobe)| Some((name, lobe.roughness.as_ref()?)))
            .filter(|(_, roughness)| !roughness.is_constant())
            .map(|(name, roughness)| (name, [roughness.min(), roughness.max()]))
            .collect();
        if self.formulas().next().is_some() {
            let textured = [("metallic", self.metallic), ("base_color", self.base_color)];
            let ranges = textured.into_iter().filter_map(|(name, range)| Some((name.into(), range?)));
            varying.extend(ranges.filter(|(_, [low, high])| low < high));
        }
        for input in self.formulas().flat_map(Formula::inputs).filter(|input| input.varies()) {
            if !varying.iter().any(|(known, _)| known == input.name) {
                varying.push((input.name.into(), input.range()));
            }
        }
        varying
    }

    /// The material where these are its parameters: the same everywhere.
    ///
    /// # Errors
    /// When one that varies is missing, is outside its range, or one is given that does not vary.
    pub fn at(&self, setting: &[(String, f64)]) -> Result<Self> {
        let varying = self.varying();
        let refuse = |why: String| Err(Error::input(format!("material \"{}\": {why}", self.name)));
        for (name, value) in setting {
            let Some((_, [low, high])) = varying.iter().find(|(varies, _)| varies == name) else {
                let names: Vec<_> = varying.iter().map(|(name, _)| name.as_str()).collect();
                let there = if names.is_empty() { "nothing does".into() } else { names.join(", ") };
                return refuse(format!("\"{name}\" does not vary in it; what varies: {there}"));
            };
            if !(*low..=*high).contains(value) {
                return refuse(format!("{name} = {value} is outside the [{low}, {high}] that it takes"));
            }
        }
        let get = |name: &str| setting.iter().find(|(given, _)| given == name).map(|&(_, value)| value);
        if let Some((name, [low, high])) = varying.iter().find(|(name, _)| get(name).is_none()) {
            return refuse(format!("its {name} varies from {low} to {high}; give --set {name}=VALUE"));
        }
        let mut material = self.clone();
        for (lobe, name) in material.lobes.iter_mut().zip(self.roughness_names()) {
            if let Some(roughness) = get(&name) {
                lobe.roughness = Some(Distribution::constant(roughness));
            }
            if let Weights::Textured(formulas) = &lobe.weights {
                lobe.weights = Weights::Constant([0, 1].map(|k| formulas[k].at(&get)));
            }
        }
        // E of a sheen whose roughness varies is of what it is here.
        let roughness = material.lobes.iter().map(|lobe| (lobe.model.clone(), lobe.roughness.clone()));
        let roughness: Vec<_> = roughness.collect();
        for factor in material.lobes.iter_mut().flat_map(|lobe| &mut lobe.factors) {
            if let Factor::BelowSheen { of, .. } = factor {
                let own = roughness.iter().find(|(model, _)| model == of.model.name);
                let own = own.and_then(|(_, roughness)| roughness.as_ref());
                of.roughness = of.roughness.or(own.map(Distribution::min));
            }
        }
        Ok(material)
    }

    /// What its format is known to break, whatever its models keep.
    pub fn violation(&self) -> Option<Violation> {
        match self.metallic {
            Some(_) => Some(metallic_roughness::energy(self)),
            None => metallic_roughness::of_models(self),
        }
    }

    /// The formulas of weights that textures decide.
    fn formulas(&self) -> impl Iterator<Item = &Formula> {
        self.lobes.iter().flat_map(|lobe| match &lobe.weights {
            Weights::Textured(formulas) => formulas.as_slice(),
            Weights::Constant(_) => &[],
        })
    }

    /// What the roughness of each lobe is called.
    fn roughness_names(&self) -> Vec<String> {
        let several = self.lobes.iter().filter(|lobe| lobe.roughness.is_some()).count() > 1;
        let name = |k| if several { format!("lobes[{k}].roughness") } else { "roughness".to_owned() };
        (0..self.lobes.len()).map(name).collect()
    }
}
