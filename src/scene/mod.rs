//! What a scene or a recipe asks for: materials, the ranges that their parameters really take, and
//! tables asked for by name. Knows nothing of GPUs, rules or resolutions.

mod distribution;
mod formula;
mod gltf;
mod metallic_roughness;
pub mod planner;
mod recipe;
mod varying;

pub use distribution::Distribution;
pub use formula::{Formula, FormulaInput};
pub use recipe::parse as parse_recipe;

use crate::base::error::{Error, Result};
use crate::model;
use crate::model::Model;
use crate::model::compensation::{Compensation, Factor};
use crate::table::axis::{Axis, Variable};
use crate::table::rule::Rule;
use crate::table::storage::Storage;
use std::path::{Path, PathBuf};

/// Everything that a scene file or recipe says about reflection.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scene {
    /// The file it came from.
    pub file: PathBuf,
    /// The materials that the scene uses, in the order of the file.
    pub materials: Vec<Material>,
    /// Tables that a recipe asks for by name; a scene asks for none and gets the default set.
    pub tables: Vec<TableRequest>,
    /// The recipe's tolerance, if it names one.
    pub tolerance: Option<f64>,
    /// What is in the file and was not used, and why.
    pub left_out: Vec<LeftOut>,
    /// What the user should know before trusting the tables.
    pub warnings: Vec<String>,
}

impl Material {
    /// Whether a lobe of it tells azimuths from each other.
    pub fn is_anisotropic(&self) -> bool {
        self.lobes.iter().any(|lobe| model::find(&lobe.model).is_ok_and(Model::is_anisotropic))
    }
}

impl Scene {
    /// The material of this name.
    ///
    /// # Errors
    /// When there is none, with the names that there are.
    pub fn material(&self, name: &str) -> Result<&Material> {
        self.materials.iter().find(|material| material.name == name).ok_or_else(|| {
            let what = LeftOut::material(name, "").what;
            if let Some(left) = self.left_out.iter().find(|left| left.what == what) {
                let (file, why) = (self.file.display(), &left.why);
                return Error::input(format!("{file}: {what} is not baked: {why}"));
            }
            let names: Vec<_> = self.materials.iter().map(|material| material.name.as_str()).collect();
            let file = self.file.display();
            Error::input(format!("{file}: no material \"{name}\"; there are {}", names.join(", ")))
        })
    }
}

/// Something that was not baked, and the reason.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct LeftOut {
    /// What.
    pub what: String,
    /// Why.
    pub why: String,
}

impl LeftOut {
    /// A material of a scene.
    fn material(name: &str, why: impl Into<String>) -> Self {
        Self { what: format!("material {name}"), why: why.into() }
    }
}

/// A material: a sum of weighted lobes.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Unique in its scene.
    pub name: String,
    /// f = Σ of these.
    pub lobes: Vec<MaterialLobe>,
    /// The metalness that the material takes, [min, max], where the scene's format has one.
    pub metallic: Option<[f64; 2]>,
    /// [min, max] over the channels of the base colour, where the scene's format has one.
    pub base_color: Option<[f64; 2]>,
}

/// One lobe of a material: a model and the weights of its components.
#[derive(Debug, Clone, PartialEq)]
pub struct MaterialLobe {
    /// The model's name in the registry: `lambert`, `ggx`, …
    pub model: String,
    /// Perceptual roughness (α = roughness²); `None` for a model without roughness.
    pub roughness: Option<Distribution>,
    /// What the scene gives of the model's other parameters, by name, for R, G and B; the rest has defaults.
    pub parameters: Vec<(String, [f64; 3])>,
    /// The weights of the model's components.
    pub weights: Weights,
    /// How it gets back what single scattering loses.
    pub compensation: Compensation,
    /// What it is multiplied with beside, of the two cosines alone.
    pub factors: Vec<Factor>,
}

/// How a material weighs the components (A, B) of a model.
#[derive(Debug, Clone, PartialEq)]
pub enum Weights {
    /// f = a·A + b·B with RGB weights [a, b].
    Constant([[f64; 3]; 2]),
    /// The weights come from textures: the formulas of a and b, in the words of the scene's format.
    Textured([Formula; 2]),
}

/// A table that a recipe asks for.
#[derive(Debug, Clone, PartialEq)]
pub struct TableRequest {
    /// The table's name; `None`: made of the subject and the quantity.
    pub name: Option<String>,
    /// The quantity's name in the registry: `brdf`, `rho_dh`, …
    pub quantity: String,
    /// Of what.
    pub subject: SubjectRequest,
    /// The axes that the recipe names; the plan adds the natural ones that are missing.
    pub axes: Vec<Axis>,
    /// The axes among them whose samples the plan chooses: these count for their range alone.
    pub auto: Vec<Variable>,
    /// The format of the values; `None`: f32, or the plan's choice where it chooses axes.
    pub storage: Option<Storage>,
    /// The integration rule; `None`: the plan's choice.
    pub rule: Option<Rule>,
    /// This table's tolerance, in place of the recipe's.
    pub tolerance: Option<f64>,
    /// Where the request stands: "recipe.toml: line 7", for messages about it.
    pub place: String,
}

/// The subject of a requested table.
#[derive(Debug, Clone, PartialEq)]
pub enum SubjectRequest {
    /// A material of this recipe, by name.
    Material(String),
    /// A basis: one model with unit weights, at this roughness, or over a roughness axis.
    Basis {
        /// The model's name.
        model: String,
        /// Perceptual roughness, where the table has no roughness axis.
        roughness: Option<f64>,
        /// What the recipe gives of its other parameters.
        parameters: Vec<(String, f64)>,
        /// How it gets back what single scattering loses.
        compensation: Compensation,
    },
}

/// Reads a scene (`.gltf`, `.glb`) or a recipe (`.toml`).
///
/// # Errors
/// When the file cannot be read or is not what its name says.
pub fn read(path: &Path) -> Result<Scene> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
    match extension.as_str() {
        "gltf" | "glb" => gltf::read(path),
        "toml" => recipe::read(path),
        _ => Err(Error::input(format!(
            "{}: not a scene that gonio reads; give a .gltf, a .glb or a recipe .toml",
            path.display()
        ))),
    }
}
