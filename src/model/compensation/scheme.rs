//! Energy compensation: what a lobe of microfacets loses between them, given back.

use crate::base::error::{Error, Result};
use crate::base::quadrature::{Node, gauss_legendre};
use crate::model;
use crate::model::compensation::{Albedo, Factor};
use crate::model::lobe::Lobe;
use crate::model::{Integral, MIRRORS, Model};

/// How a microfacet lobe gets back what single scattering loses.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Compensation {
    /// Not at all.
    #[default]
    None,
    /// As a second, diffuse lobe; reciprocal. See [`Factor::Missing`].
    KullaConty,
    /// In the lobe's own shape; white to every view, not reciprocal. See [`Factor::Restored`]. Filament's is the same:
    /// 1 + F0 (1/dfg.y − 1) (Filament, *Physically Based Rendering in Filament*, section 4.7.2, "Energy loss in specular
    /// reflectance"), where dfg.y = ∫ D V (n·l) dl with F = 1 at the view is the E(μe) of Turquin's 1 + F0 (1 − E)/E.
    Turquin,
}

impl Compensation {
    /// All there are, the default first.
    pub const ALL: [Self; 3] = [Self::None, Self::KullaConty, Self::Turquin];

    /// Its name in recipes.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::KullaConty => "kulla-conty",
            Self::Turquin => "turquin",
        }
    }

    /// What recipes may call them: their names, and `filament` for Turquin's.
    pub fn words<'a>() -> impl Iterator<Item = (&'a str, Self)> {
        let names = Self::ALL.into_iter().map(|kind| (kind.name(), kind));
        names.chain([("filament", Self::Turquin)])
    }

    /// A few words for people.
    pub fn summary(self) -> &'static str {
        match self {
            Self::None => "single scattering alone",
            Self::KullaConty => {
                "a diffuse lobe of what is missing: (1 − E(μi)) (1 − E(μe)) / (π (1 − E_avg)) · F_ms"
            }
            Self::Turquin => "f (1 + F0 (1/E(μe) − 1)): not reciprocal",
        }
    }

    /// Author and year.
    pub fn source(self) -> &'static str {
        match self {
            Self::None => "",
            Self::KullaConty => "Kulla & Conty 2017",
            Self::Turquin => "Turquin 2019; Filament's is the same",
        }
    }

    /// Whether a model has what is to be compensated: microfacets, of a width.
    pub fn is_for(model: &Model) -> bool {
        model.shape.is_some() && model.microfacet.is_some()
    }

    /// The lobes that a lobe becomes. Channels with different F take lobes of their own.
    ///
    /// # Errors
    /// When it is no lobe of microfacets, or has no albedo.
    pub fn lobes(self, lobe: Lobe) -> Result<Vec<Lobe>> {
        if self == Self::None {
            return Ok(vec![lobe]);
        }
        let refuse = |why: &str| Err(Error::input(format!("compensation of {}: {why}", lobe.model().name)));
        let (Some(made), true) = (lobe.model().microfacet, Self::is_for(lobe.model())) else {
            return refuse("it is for lobes of microfacets with a roughness");
        };
        let mut of = Albedo {
            model: lobe.model().with_terms(None, Some("none"))?,
            roughness: None,
            parameters: lobe.parameters(),
        };
        // Those of its own; the Fresnel term's are nothing to it.
        of.parameters = of.model.defaults();
        for parameter in of.model.parameters {
            of.parameters[parameter.place] = lobe.parameters()[parameter.place];
        }
        if let Some(why) = of.refused() {
            return refuse(why);
        }
        let fresnel =
            MIRRORS.iter().find(|m| m.microfacet.is_some_and(|m| m.fresnel.name == made.fresnel.name));
        let Some(Integral::Delta(fresnel)) = fresnel.map(|mirror| mirror.integral) else {
            return Err(Error::Internal(format!("no mirror of {}", made.fresnel.name)));
        };
        let setting = lobe.setting(0.0);
        let fresnel = |mu| fresnel(mu, &setting);
        // F of each channel: weights are part of it where they are F0 and F90, and else dim what there is.
        let splits = lobe.model().components.len() > 1;
        let mixed =
            |[a, b]: [f64; 2], weight: &[f64; 2]| if splits { weight[0] * a + weight[1] * b } else { a };
        let components = match self {
            Self::KullaConty => [0, 1].map(|k| mean(&|mu| fresnel(mu)[k])),
            _ => fresnel(1.0),
        };
        let reflectances: Vec<_> = lobe.weights().iter().map(|weight| mixed(components, weight)).collect();
        let mut lobes = if self == Self::KullaConty { vec![lobe.clone()] } else { Vec::new() };
        let mut taken: Vec<f64> = Vec::new();
        for &f in &reflectances {
            if taken.contains(&f) {
                continue;
            }
            taken.push(f);
            let channels = lobe.weights().iter().zip(&reflectances);
            let kept = |weight: [f64; 2], own: f64| if own == f { weight } else { [0.0; 2] };
            lobes.push(match self {
                Self::KullaConty => {
                    // The lobe's own roughness, which a diffuse lobe has not.
                    let of = Albedo { roughness: lobe.roughness(), ..of.clone() };
                    let weight = |weight: &[f64; 2]| [if splits { 1.0 } else { weight[0] }, 0.0];
                    let weights = channels.map(|(own, &f)| kept(weight(own), f)).collect();
                    let mut factors = lobe.factors().to_vec();
                    factors.push(Factor::Missing { of, f_avg: f });
                    Lobe::new(model::find("lambert")?, None, weights)?.with_factors(factors)
                }
                _ => {
                    let weights = channels.map(|(&own, &f)| kept(own, f)).collect();
                    let mut factors = lobe.factors().to_vec();
                    factors.push(Factor::Restored { of: of.clone(), f0: f });
                    lobe.clone().with_weights(weights)?.with_factors(factors)
                }
            });
        }
        Ok(lobes)
    }
}

/// 2 ∫ F(μ) μ dμ, by halves until both agree: F of a dielectric has kinks, and a scale of its own at grazing.
fn mean(f: &dyn Fn(f64) -> f64) -> f64 {
    fn between(f: &dyn Fn(f64) -> f64, [low, high]: [f64; 2], rule: &[Node], depth: u32) -> f64 {
        let on = |low: f64, high: f64| -> f64 {
            let term = |node: &Node| {
                let mu = low + (high - low) * node.x;
                2.0 * mu * f(mu) * node.weight
            };
            (high - low) * rule.iter().map(term).sum::<f64>()
        };
        let middle = 0.5 * (low + high);
        let (whole, halves) = (on(low, high), on(low, middle) + on(middle, high));
        if depth == 0 || (whole - halves).abs() <= 1e-13 {
            return halves;
        }
        between(f, [low, middle], rule, depth - 1) + between(f, [middle, high], rule, depth - 1)
    }
    between(f, [0.0, 1.0], &gauss_legendre(10), 40)
}
