//! The models and the parts that they are made of.
//!
//! A part is one WGSL file and one Rust file of the same name: the Rust file is its twin, the same
//! evaluation in f64, which bakes where there is no device. The *reference* of a part is not here:
//! the crate `gonio-reference` has it, written from the paper and sharing nothing with this module.

mod builder;
mod classic;
pub mod compensation;
mod diffuse;
pub mod directions;
mod fresnel;
mod half_vector;
pub mod lobe;
mod masking;
mod microfacet;
mod mirror;
pub(crate) mod ndf;
pub(crate) mod panels;
pub mod parameters;
mod roughness;
pub(crate) mod slope_azimuths;
#[cfg(test)]
pub(crate) mod truth;

#[cfg(feature = "light")]
pub(crate) use diffuse::lambert::MODEL as LAMBERT;
pub(crate) use half_vector::stretched::Facet;
pub(crate) use microfacet::FacetSum;
#[cfg(feature = "lab")]
pub(crate) use microfacet::GGX;

pub use builder::{ModelBuilder, Twin};
pub use fresnel::metals::{METALS, Metal};
pub use microfacet::{FRESNELS, MASKINGS, MICROFACETS, MIRRORS, Microfacet};
pub use roughness::{Parameter, Roughness, Shape};

use crate::base::error::{Error, Result};
use crate::base::half_angle::{Azimuth, Pair};
use crate::base::precision::INTEGRAL_F32;
use crate::base::tolerance::decade;
#[cfg(any(test, feature = "lab"))]
use crate::base::tolerance::is_fine;
use crate::model::directions::Map;
use crate::model::parameters::{Parameters, Setting};
#[cfg(feature = "lab")]
use crate::table::{axis::Variable, quantity::Quantity};
use std::sync::{PoisonError, RwLock};

/// A reflection model: f = a·A + b·B with weights that a material gives and components that the
/// model evaluates, so that colours never enter a basis.
#[non_exhaustive]
pub struct Model {
    /// The name in recipes, files and manifests.
    pub name: &'static str,
    /// One line for people.
    pub summary: &'static str,
    /// Author, year, equation.
    pub source: &'static str,
    /// What it is made of, if it is made of terms: then it has siblings of others.
    pub microfacet: Option<&'static Microfacet>,
    /// Its components: `A` alone, or `A` and `B` where Fresnel splits it.
    pub components: &'static [Component],
    /// What its roughness is, if it takes one.
    pub shape: Option<Shape>,
    /// The rest of its parameters.
    pub parameters: &'static [Parameter],
    /// What shaders get of them: each in its place, and what the host derives in f64 beside it.
    pub derive: fn(&mut Parameters),
    /// The bound on ρ_dh = ∫ (A + B) cos θ dω that the model promises; 1 conserves energy, more is a
    /// [`Violation`] that it declares, and infinity is no promise.
    pub rho_bound: f64,
    /// Its shader, part by part, in order.
    pub parts: &'static [Part],
    /// How its hemispherical integrals are done.
    pub integral: Integral,
    /// The relative error of its values in f32, for each value above 1e-30 sr⁻¹.
    pub value_f32: f64,
    /// (A, B) in f64, in the shader's own formulas: the evaluation of the CPU path. Of a delta, its
    /// mean over a cell.
    pub lobe: fn(&Pair, &Azimuth, &Setting) -> [f64; 2],
}

/// A promise of a BRDF that a model, or a format's way to add models up, is known to break: reported as such,
/// and held to its bound.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Violation {
    /// The promise, by its name in [`verify`](crate::verify).
    pub property: &'static str,
    /// What the worst value may be.
    pub bound: f64,
    /// Who says so.
    pub source: &'static str,
}

/// A component of a model, and what a material weighs it with.
#[derive(Debug)]
#[non_exhaustive]
pub struct Component {
    /// Its channel's name.
    pub name: &'static str,
    /// What recipes call its weight.
    pub weight: &'static str,
    /// The weight where a recipe gives none; `None`: it must.
    pub default: Option<f64>,
}

/// A part that recipes choose by its name.
#[derive(Debug)]
#[non_exhaustive]
pub struct Term {
    /// The name in recipes.
    pub name: &'static str,
    /// A few words for people.
    pub summary: &'static str,
    /// Author, year, equation.
    pub source: &'static str,
    /// Its shader.
    pub part: Part,
}

/// A file of WGSL.
#[derive(Debug)]
#[non_exhaustive]
pub struct Part {
    /// Its path below `shaders/`, without the extension.
    pub name: &'static str,
    /// Its text.
    pub wgsl: &'static str,
    /// Files that it shares with other parts, of which a module has one copy: path and text.
    pub shared: &'static [(&'static str, &'static str)],
}

/// How a model's hemispherical integrals are done by the `warped` rule.
#[derive(Clone, Copy)]
pub enum Integral {
    /// In slopes of the microfacet normal, for lobes of any width.
    Slopes(&'static Slopes),
    /// Gauss–Legendre in θe and in δφ ∈ [0, π]: for lobes as wide as the hemisphere. How many of each
    /// meet a tolerance.
    Smooth(fn(tolerance: f64) -> [usize; 2]),
    /// The same where f is smooth but for kinks at θe = θi, and where ωi and ωe are perpendicular in azimuth:
    /// panels end there. How many of each in each of the two panels of θe, and of δφ ∈ [0, π].
    Kinked(fn(tolerance: f64) -> [usize; 2]),
    /// By directions that the host finds, each texel its own: for any lobe, wherever it lives.
    Listed(Map),
    /// In closed form: (A, B) of ρ(μ). Such a model is a delta and has no values.
    Delta(fn(mu: f64, &Setting) -> [f64; 2]),
    /// Not at all, and why: ρ has no bound, so that no absolute tolerance holds. Such a model has values
    /// alone.
    Unbounded(&'static str),
}

/// How a lobe is integrated in slopes.
pub struct Slopes {
    /// The map of tolerances that f32 can meet.
    pub(crate) coarse: SlopeMap,
    /// That of finer ones.
    pub(crate) fine: SlopeMap,
    /// What a texel takes to meet a tolerance, where cos φ > 0 and where it is < 0.
    pub(crate) counts: fn(mu: f64, &Setting, tolerance: f64) -> [SlopeCounts; 2],
    /// Where ρ(μ, α) is not analytic, if that is known.
    pub(crate) branches: Option<Branches>,
    /// What α → 0 tends to.
    pub(crate) mirror_limit: fn(mu_e: f64, &Setting) -> [f64; 2],
    /// The same by directions, for what is no lobe alone.
    pub(crate) map: Map,
    /// What peers do in place of all that, if they can.
    pub(crate) sampling: Option<Sampling>,
}

/// ρ(μ, α) is analytic but for branch points near μ = ±iα, so that tables of it need few integrals.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Branches {
    /// What e^(−n q) takes to bound the error of n Chebyshev points: measured.
    pub strength: f64,
}

/// How much work one side of a texel is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct SlopeCounts {
    pub azimuths: usize,
    /// Nodes in r, for each azimuth.
    pub nodes: usize,
}

/// A map of slopes, and the f64 twin of the integrand in it.
pub(crate) struct SlopeMap {
    /// Its shader.
    pub part: Part,
    /// The end of the map at a horizon tan θm = t_max.
    pub end: fn(t_max: f64, &Setting) -> f64,
    /// The integrand at r, for an azimuth (μe c, t_max, 1/t_max).
    pub integrand: fn(r: f64, azimuth: [f64; 3], mu_e: f64, &Setting) -> [f64; 2],
}

/// Importance sampling of a microfacet lobe: (A, B) of f μi / p for a draw of two numbers, the second
/// the cosine of an azimuth.
pub(crate) struct Sampling {
    /// The functions that the sampling kernels call.
    pub part: Part,
    /// Of the normals' distribution.
    pub ndf: fn(draw: [f64; 2], mu_e: f64, &Setting) -> [f64; 2],
    /// Of the normals that ωe sees.
    pub vndf: fn(draw: [f64; 2], mu_e: f64, &Setting) -> [f64; 2],
}

/// The smallest α > 0 that has values: below it, f of both directions at grazing would leave f32.
pub const ALPHA_MIN_VALUE: f64 = 1e-6;

/// The smallest α whose integrals differ from the mirror's: at μ = 2⁻²⁴, the smallest there is,
/// (α/μ)² = 2e-10.
pub const ALPHA_MIN_INTEGRAL: f64 = 1e-12;

/// [`MODELS`] from the list of them.
macro_rules! models {
    ($($model:path),* $(,)?) => {
        /// The models by the names that recipes begin from; [`MICROFACETS`] and [`MIRRORS`] have the
        /// siblings of those that are made of terms.
        pub static MODELS: [&Model; [$(stringify!($model)),*].len()] = [$(&$model),*];
    };
}
models! {
    diffuse::lambert::MODEL,
    diffuse::gltf_diffuse::MODEL,
    diffuse::gltf_oren_nayar::MODEL,
    diffuse::oren_nayar::MODEL,
    diffuse::fujii::MODEL,
    diffuse::eon::MODEL,
    diffuse::burley::MODEL,
    diffuse::frostbite::MODEL,
    diffuse::disney_subsurface::MODEL,
    diffuse::disney_sheen::MODEL,
    microfacet::GGX,
    microfacet::BECKMANN,
    microfacet::GTR,
    microfacet::STUDENT_T,
    microfacet::BLINN_PHONG,
    microfacet::CHARLIE,
    classic::ward::MODEL,
    classic::ward_dur::MODEL,
    classic::blinn::MODEL,
    classic::phong::MODEL,
    classic::lafortune::MODEL,
    classic::ashikhmin_shirley::MODEL,
    classic::ashikhmin_shirley_diffuse::MODEL,
    mirror::MODEL,
}

/// Models of an embedder's own.
static REGISTERED: RwLock<Vec<&'static Model>> = RwLock::new(Vec::new());

/// Makes a model known by its name.
pub(crate) fn add_registered(model: &'static Model) {
    REGISTERED.write().unwrap_or_else(PoisonError::into_inner).push(model);
}

/// The model of this name, a microfacet model's with its terms included: `ggx-smith-separable-none`.
pub fn find(name: &str) -> Result<&'static Model> {
    all().find(|m| m.name == name).ok_or_else(|| {
        let names: Vec<_> = MODELS.iter().map(|m| m.name).collect();
        Error::input(format!("no model \"{name}\"; there are {}", names.join(", ")))
    })
}

/// Every model: [`MODELS`], then their siblings of other terms, then those that were registered at run time.
pub fn all() -> impl Iterator<Item = &'static Model> {
    let siblings = MICROFACETS.iter().chain(MIRRORS.iter()).filter(|model| !MODELS.contains(model));
    let registered = REGISTERED.read().unwrap_or_else(PoisonError::into_inner).clone();
    MODELS.into_iter().chain(siblings).chain(registered)
}

impl SlopeCounts {
    /// A quarter more azimuths, and so many times the nodes: in fours, so that few rules differ.
    fn more(self, times: f64) -> Self {
        Self {
            azimuths: self.azimuths + self.azimuths.div_ceil(4),
            nodes: ((self.nodes as f64 * times).ceil() as usize).next_multiple_of(4),
        }
    }

    /// So many for each decade of the tolerance, or more.
    fn at_least(self, [azimuths, nodes]: [usize; 2], tolerance: f64) -> Self {
        let decades = decade(tolerance) + 1;
        Self {
            azimuths: self.azimuths.max(azimuths * decades + 2),
            nodes: self.nodes.max(nodes * decades + 2),
        }
    }
}

#[cfg(any(test, feature = "lab"))]
impl Slopes {
    /// The map for a tolerance.
    pub(crate) fn map(&self, tolerance: f64) -> &SlopeMap {
        if is_fine(tolerance) { &self.fine } else { &self.coarse }
    }
}

impl Component {
    /// The one component of a diffuse lobe.
    const DIFFUSE: [Self; 1] = [Self { name: "A", weight: "albedo", default: None }];

    /// What of an exact Fresnel term is shown: all of it, unless an artist dims it.
    const SPECULAR: [Self; 1] = [Self { name: "A", weight: "specular", default: Some(1.0) }];

    /// What Schlick's Fresnel splits a lobe into.
    const fn schlick(f0: f64) -> [Self; 2] {
        [
            Self { name: "A", weight: "f0", default: Some(f0) },
            Self { name: "B", weight: "f90", default: Some(1.0) },
        ]
    }
}

impl Model {
    /// Its parameters at their defaults; those that have none at the least that they take.
    pub fn defaults(&self) -> Parameters {
        let mut parameters = [0.0; 8];
        self.parameters.iter().for_each(|p| parameters[p.place] = p.default.unwrap_or(p.range[0]));
        parameters
    }

    /// The same in R, G or B, where a parameter tells them apart: see [`Parameter::CHANNEL`].
    #[cfg(feature = "scene")]
    pub(crate) fn defaults_in(&self, channel: usize) -> Parameters {
        let mut parameters = self.defaults();
        let own = self.parameters.iter().filter(|parameter| parameter.name == Parameter::CHANNEL);
        own.for_each(|parameter| parameters[parameter.place] = channel as f64);
        parameters
    }

    /// The model's own measure of a roughness; 0 where it takes none.
    pub fn measure(&self, roughness: f64) -> f64 {
        self.shape.map_or(0.0, |shape| shape.measure(roughness))
    }

    /// Whether node counts of its integrals are known. Without them integrals are found by adaptive quadrature: slow, and as
    /// right.
    pub fn has_counts(&self) -> bool {
        let has_integrals = !matches!(self.integral, Integral::Unbounded(_));
        self.microfacet.is_none_or(|made| made.is_counted || !has_integrals)
    }

    /// Whether the rules that sample can do its integrals.
    pub fn has_samplers(&self) -> bool {
        matches!(self.integral, Integral::Slopes(slopes) if slopes.sampling.is_some())
    }

    /// The relative error of its values in f32 at a setting.
    pub(crate) fn value_f32_at(&self, s: &Setting) -> f64 {
        self.microfacet.map_or(self.value_f32, |made| (made.value_f32)(s))
    }

    /// The least tolerance of its integrals that f32 meets, with every weight 1: of what reflects more than 1,
    /// roundings are so much more.
    pub fn integral_f32(&self) -> f64 {
        let relative = self.microfacet.map_or(INTEGRAL_F32, |made| made.integral_f32);
        relative * if self.rho_bound.is_finite() { self.rho_bound.max(1.0) } else { 1.0 }
    }

    /// The same of its integrals at a setting.
    pub(crate) fn integral_f32_at(&self, s: &Setting) -> f64 {
        let most = self.microfacet.map_or(f64::INFINITY, |made| (made.rho_most)(s));
        if most < self.rho_bound && self.rho_bound.is_finite() {
            return self.integral_f32() * most.max(1.0) / self.rho_bound.max(1.0);
        }
        self.integral_f32()
    }

    /// f below which f32 has lost digits, to underflow or to a difference, sr⁻¹, where that is earlier than of most.
    pub(crate) fn faint(&self) -> Option<f64> {
        self.microfacet.map_or_else(|| self.shape?.faint, |made| made.faint)
    }

    /// Whether f depends on both azimuths, and not on δφ alone.
    pub fn is_anisotropic(&self) -> bool {
        self.shape.is_some_and(|shape| shape.anisotropic)
    }

    /// The variables of a table of it: its roughness, if it has one, and those of the quantity's directions.
    #[cfg(feature = "lab")]
    pub(crate) fn variables(&self, quantity: &Quantity) -> impl Iterator<Item = Variable> {
        let roughness = self.shape.map(|_| Variable::Roughness);
        roughness.into_iter().chain(quantity.variables(self.is_anisotropic()).iter().copied())
    }

    /// What shaders get of a shape, in the model's own measure.
    pub(crate) fn on_device(&self, alpha: f64) -> f64 {
        self.shape.map_or(alpha, |shape| shape.on_device(alpha))
    }

    /// Names that stand for its index, η and k of each channel, if it has one.
    pub fn metals(&self) -> &'static [Metal] {
        self.microfacet.map_or(&[], |made| made.metals)
    }

    /// Why these parameters are refused, if they are, though each is in its range.
    pub(crate) fn refused(&self, parameters: &Parameters) -> Option<&'static str> {
        (self.microfacet?.refused)(parameters)
    }

    /// Whether a lobe of this roughness is a delta, as far as values go.
    pub fn is_delta_at(&self, roughness: f64) -> bool {
        self.is_delta() || self.shape.is_some_and(|shape| shape.measure(roughness) < shape.least)
    }

    /// Whether this is a delta: no values, only integrals.
    pub fn is_delta(&self) -> bool {
        matches!(self.integral, Integral::Delta(_))
    }

    /// The promise that it is known to break, if there is one.
    pub fn violation(&self) -> Option<Violation> {
        let Self { rho_bound: bound, source, .. } = *self;
        (bound > 1.0).then_some(Violation { property: "energy", bound, source })
    }
}

impl Part {
    /// A part on its own.
    pub const fn new(name: &'static str, wgsl: &'static str) -> Self {
        Self { name, wgsl, shared: &[] }
    }
}

impl PartialEq for Model {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl std::fmt::Debug for Model {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

/// A [`Part`] from its path below `shaders/`, and those of files that it shares with others.
macro_rules! part {
    ($name:literal $(, $shared:literal)*) => {
        $crate::model::Part {
            name: $name,
            wgsl: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/", $name, ".wgsl")),
            shared: &[
                $(($shared, include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/", $shared, ".wgsl")))),*
            ],
        }
    };
}
pub(crate) use part;
