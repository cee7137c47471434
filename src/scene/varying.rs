//! What varies in a material, and the material at one setting of it.

use super::{Distribution, Material, Weights, metallic_roughness};
use crate::error::{Error, Result};
use crate::models::Violation;

impl Material {
    /// The parameters that vary, and their ranges: `roughness` (`lobes[0].roughness` where several lobes have
    /// their own), and where textures weigh the lobes `metallic` and `base_color`.
    pub fn varying(&self) -> Vec<(String, [f64; 2])> {
        let mut varying: Vec<_> = self
            .roughness_names()
            .into_iter()
            .zip(&self.lobes)
            .filter_map(|(name, lobe)| Some((name, lobe.roughness.as_ref()?)))
            .filter(|(_, roughness)| !roughness.is_constant())
            .map(|(name, roughness)| (name, [roughness.min(), roughness.max()]))
            .collect();
        if self.lobes.iter().any(|lobe| matches!(lobe.weights, Weights::Textured(_))) {
            let textured = [("metallic", self.metallic), ("base_color", self.base_color)];
            let ranges = textured.into_iter().filter_map(|(name, range)| Some((name.into(), range?)));
            varying.extend(ranges.filter(|(_, [low, high])| low < high));
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
        let [metallic, base_color] = [("metallic", self.metallic), ("base_color", self.base_color)]
            .map(|(name, range)| get(name).or(range.map(|[low, _]| low)).unwrap_or(0.0));
        let mut material = self.clone();
        for (lobe, name) in material.lobes.iter_mut().zip(self.roughness_names()) {
            if let Some(roughness) = get(&name) {
                lobe.roughness = Some(Distribution::constant(roughness));
            }
            if let Weights::Textured(_) = lobe.weights {
                let weights = metallic_roughness::weights(&lobe.model, base_color, metallic);
                lobe.weights = Weights::Constant(weights.map(|weight| [weight; 3]));
            }
        }
        Ok(material)
    }

    /// What its format is known to break, whatever its models keep.
    pub fn violation(&self) -> Option<Violation> {
        self.metallic.map(|_| metallic_roughness::ENERGY)
    }

    /// What the roughness of each lobe is called.
    fn roughness_names(&self) -> Vec<String> {
        let several = self.lobes.iter().filter(|lobe| lobe.roughness.is_some()).count() > 1;
        let name = |k| if several { format!("lobes[{k}].roughness") } else { "roughness".to_owned() };
        (0..self.lobes.len()).map(name).collect()
    }
}
