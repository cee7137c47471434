//! Microfacet models: any NDF with any masking and any Fresnel term. Twin of
//! `shaders/lobe/microfacet.wgsl`.
//!
//! A model is put together at compile time, so that the CPU path calls nothing by pointer within an
//! integrand; what is put together at run time is names.

use super::fresnel::{Fresnel, none::Constant, schlick::Schlick};
use super::masking::{
    Masking, none::Unmasked, smith_correlated::SmithCorrelated, smith_separable::SmithSeparable,
};
use super::ndf::{Map, Ndf, ggx::Ggx};
use super::{Integral, Model, Part, Sampling, SlopeCounts, SlopeMap, Slopes, Term, is_fine, part};
use crate::error::{Error, Result};
use crate::pair::{Azimuth, Half, Pair};
use crate::reference;
use std::marker::PhantomData;
use std::sync::LazyLock;

/// What a microfacet model is made of.
#[derive(Debug)]
pub struct Microfacet {
    /// The distribution of normals.
    pub ndf: Term,
    /// Masking and shadowing.
    pub masking: Term,
    /// The Fresnel term.
    pub fresnel: Term,
}

/// The masking terms, the default first.
pub static MASKINGS: [Term; 3] = [SmithCorrelated::TERM, SmithSeparable::TERM, Unmasked::TERM];

/// The Fresnel terms, the default first.
pub static FRESNELS: [Term; 2] = [Schlick::TERM, Constant::TERM];

/// Every NDF …
fn all() -> Vec<Model> {
    [with_ndf::<Ggx>()].into_iter().flatten().collect()
}

/// … with every masking …
fn with_ndf<N: Ndf>() -> Vec<Model> {
    let all = [
        with_masking::<N, SmithCorrelated>(),
        with_masking::<N, SmithSeparable>(),
        with_masking::<N, Unmasked>(),
    ];
    all.into_iter().flatten().collect()
}

/// … and every Fresnel term, in the order of the lists above.
fn with_masking<N: Ndf, M: Masking>() -> [Model; FRESNELS.len()] {
    [named(Made::<N, M, Schlick>::MODEL), named(Made::<N, M, Constant>::MODEL)]
}

/// GGX with the defaults.
pub(super) static GGX: Model = Model {
    summary: "GGX microfacets, height-correlated Smith, Schlick: f = F0·A + F90·B",
    source: "Walter et al. 2007, eq. 20 and 33; Heitz 2014, eq. 99; Schlick 1994, eq. 15",
    ..Made::<Ggx, SmithCorrelated, Schlick>::MODEL
};

/// All microfacet models: every NDF with every masking and every Fresnel term.
pub static MICROFACETS: LazyLock<Vec<Model>> = LazyLock::new(all);

impl Model {
    /// This microfacet model with other terms.
    ///
    /// # Errors
    /// When it has no such terms, or there is none of this name.
    pub fn with_terms(&self, masking: Option<&str>, fresnel: Option<&str>) -> Result<&'static Self> {
        let made = self.microfacet.ok_or_else(|| {
            Error::input(format!(
                "{} is no microfacet model; it has no masking and no fresnel to choose",
                self.name
            ))
        })?;
        let masking = term("masking", &MASKINGS, masking.unwrap_or(made.masking.name))?;
        let fresnel = term("fresnel", &FRESNELS, fresnel.unwrap_or(made.fresnel.name))?;
        let is_it = |of: &Microfacet| {
            [of.ndf.name, of.masking.name, of.fresnel.name] == [made.ndf.name, masking.name, fresnel.name]
        };
        MICROFACETS.iter().find(|model| model.microfacet.is_some_and(is_it)).ok_or_else(|| {
            Error::Internal(format!(
                "{} with {} and {} is not made",
                made.ndf.name, masking.name, fresnel.name
            ))
        })
    }
}

fn term(kind: &str, terms: &'static [Term], name: &str) -> Result<&'static Term> {
    terms.iter().find(|term| term.name == name).ok_or_else(|| {
        let names: Vec<_> = terms.iter().map(|term| term.name).collect();
        Error::input(format!("no {kind} \"{name}\"; there are {}", names.join(", ")))
    })
}

/// The model with a name that tells its terms: the NDF's alone with the defaults, else all three. It is made
/// once and lives as long as the process.
fn named(model: Model) -> Model {
    let Some(Microfacet { ndf, masking, fresnel }) = model.microfacet else { return model };
    let keep = |text: String| -> &'static str { text.leak() };
    let is_default = masking.name == MASKINGS[0].name && fresnel.name == FRESNELS[0].name;
    Model {
        name: if is_default { ndf.name } else { keep([ndf.name, masking.name, fresnel.name].join("-")) },
        summary: keep([ndf.summary, masking.summary, fresnel.summary].join(", ")),
        source: keep([ndf.source, masking.source, fresnel.source].join("; ")),
        ..model
    }
}

/// A combination.
struct Made<N, M, F>(PhantomData<(N, M, F)>);

impl<N: Ndf, M: Masking, F: Fresnel> Made<N, M, F> {
    const MODEL: Model = Model {
        name: N::TERM.name,
        summary: N::TERM.summary,
        source: N::TERM.source,
        microfacet: Some(&Self::TERMS),
        components: F::COMPONENTS,
        has_roughness: true,
        rho_bound: if M::UNBOUNDED.is_some() { f64::INFINITY } else { 1.0 },
        parts: &Self::PARTS,
        integral: match M::UNBOUNDED {
            Some(why) => Integral::Unbounded(why),
            None => Integral::Slopes(&Self::SLOPES),
        },
        lobe: Self::lobe,
        reference: Some(&Self::REFERENCE),
    };

    const TERMS: Microfacet = Microfacet { ndf: N::TERM, masking: M::TERM, fresnel: F::TERM };

    const PARTS: [Part; 4] = [F::TERM.part, N::TERM.part, M::TERM.part, part!("lobe/microfacet")];

    const REFERENCE: reference::Microfacet =
        reference::Microfacet { ndf: N::REFERENCE, masking: M::REFERENCE, fresnel: F::REFERENCE };

    const SLOPES: Slopes = Slopes {
        coarse: SlopeMap {
            part: N::COARSE,
            end: N::coarse_end,
            integrand: |r, azimuth, mu_e, alpha| {
                Self::integrand(N::coarse_map(r, alpha), azimuth, mu_e, alpha)
            },
        },
        fine: SlopeMap {
            part: N::FINE,
            end: N::fine_end,
            integrand: |r, azimuth, mu_e, alpha| Self::integrand(N::fine_map(r, alpha), azimuth, mu_e, alpha),
        },
        counts: Self::counts,
        branches: N::BRANCHES,
        mirror_limit: |mu_e| F::fresnel(mu_e, 1.0 - mu_e),
        sampling: Sampling { part: N::SAMPLES, ndf: N::by_ndf::<M, F>, vndf: N::by_vndf::<M, F> },
    };

    /// The NDF's error model is for correlated Smith; its fine map has nodes to spare for the rest.
    fn counts(mu: f64, alpha: f64, tolerance: f64) -> [SlopeCounts; 2] {
        let [near, far] = N::counts(mu, alpha, tolerance);
        [if is_fine(tolerance) { near } else { M::near(near) }, far]
    }

    fn lobe(p: &Pair, a: &Azimuth, alpha: f64) -> [f64; 2] {
        let h = Half::new(p, a);
        let s = N::ndf(&h, p.hz2, alpha) * M::visibility::<N>(p.mu_i, p.mu_e, alpha);
        F::fresnel(h.c, h.one_minus_c).map(|f| f * s)
    }

    fn integrand(map: Map, [mu_c, t_max, t_max_inverse]: [f64; 3], mu_e: f64, alpha: f64) -> [f64; 2] {
        let Map { p, m, weight } = map;
        let projected = mu_e * m + mu_c * p; // ωe·ωm √y
        let y = m * m + p * p;
        let x = (t_max * m - p) * (p + t_max_inverse * m); // cos θi = μe x/y
        let all = 2.0 * x * projected * weight / M::masking::<N>(x, y, mu_e, alpha);
        let c = (projected / y.sqrt()).min(1.0);
        F::fresnel(c, 1.0 - c).map(|f| f * all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::{self, MODELS, decade};
    use crate::quadrature::gauss_legendre;
    use crate::slopes::side;
    use rayon::prelude::*;
    use std::collections::BTreeSet;

    /// Names are keys of pipelines, words of recipes and parts of file names.
    #[test]
    fn every_combination_has_a_name_of_its_own() {
        assert_eq!(MICROFACETS.len(), MASKINGS.len() * FRESNELS.len());
        let names: Vec<_> = models::all().map(|model| model.name).collect();
        for (k, name) in names.iter().enumerate() {
            assert!(!names[..k].contains(name), "{name}");
            assert_eq!(models::find(name).unwrap().name, *name);
        }
        assert_eq!(names.len(), MODELS.len() + MICROFACETS.len() - 1);
        for model in MICROFACETS.iter() {
            let made = model.microfacet.unwrap();
            let again = GGX.with_terms(Some(made.masking.name), Some(made.fresnel.name)).unwrap();
            assert_eq!(again, model);
        }
        assert_eq!(GGX.with_terms(None, None).unwrap(), &GGX);
        assert_eq!(MICROFACETS[0].summary, GGX.summary);
        assert_eq!(MICROFACETS[0].source, GGX.source);
    }

    /// The device keeps the rules of the coarse map in a uniform buffer of so many nodes, whichever a table takes.
    #[test]
    fn the_rules_of_a_table_fit() {
        for model in MICROFACETS.iter() {
            let Integral::Slopes(slopes) = model.integral else { continue };
            for tolerance in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6] {
                let mut rules = BTreeSet::new();
                for (i, j) in (0..240).flat_map(|i| (0..400).map(move |j| (i, j))) {
                    let (mu, alpha) = (2f64.powf(-0.1 * f64::from(i)), 2f64.powf(-0.1 * f64::from(j)));
                    rules.extend((slopes.counts)(mu, alpha, tolerance).map(|counts| counts.nodes));
                }
                let nodes: usize = rules.iter().sum();
                assert!(nodes <= 2048, "{} at {tolerance}: {nodes} nodes", model.name);
            }
        }
    }

    /// The error model was made for correlated heights and Schlick: the others keep the tolerances by what they
    /// add to it. Without `near`, separable Smith is off by 1.3 times 1e-5 and 1.7 times 1e-6.
    #[test]
    fn the_error_model_holds_for_every_combination() {
        for model in MICROFACETS.iter() {
            let Integral::Slopes(slopes) = model.integral else { continue };
            let rule = |mu: f64, alpha: f64, tolerance: f64, counts: [SlopeCounts; 2]| {
                let map = slopes.map(tolerance);
                let mut sum = [0.0; 2];
                for (sign, counts) in [1.0, -1.0].into_iter().zip(counts) {
                    let nodes = gauss_legendre(counts.nodes);
                    for [c, t_max, inverse, weight] in
                        side(mu, sign, &gauss_legendre(counts.azimuths), tolerance)
                    {
                        let end = (map.end)(t_max, alpha);
                        for node in &nodes {
                            let f = (map.integrand)(end * node.x, [c, t_max, inverse], mu, alpha);
                            let weight = weight * end * node.weight;
                            sum = [sum[0] + weight * f[0], sum[1] + weight * f[1]];
                        }
                    }
                }
                sum
            };
            let worst: Vec<[f64; 9]> = (0..300)
                .into_par_iter()
                .map(|k| {
                    // Additive recurrences of two irrationals: even over both logarithms.
                    let (u, v) = ((k as f64 * 0.754_877_666).fract(), (k as f64 * 0.569_840_291).fract());
                    let (mu, alpha) = (2f64.powf(-24.0 * u * u), 2f64.powf(-20.0 * v * v));
                    let exact = rule(mu, alpha, 1e-10, [SlopeCounts { azimuths: 100, nodes: 160 }; 2]);
                    std::array::from_fn(|d| {
                        let tolerance = 10f64.powi(-1 - d as i32);
                        assert_eq!(decade(tolerance), d);
                        let [a, b] = rule(mu, alpha, tolerance, (slopes.counts)(mu, alpha, tolerance));
                        (a - exact[0]).abs().max((b - exact[1]).abs()) / tolerance
                    })
                })
                .collect();
            let most = worst.into_iter().reduce(|a, b| std::array::from_fn(|d| a[d].max(b[d]))).unwrap();
            println!("{}: {}", model.name, most.map(|x| format!("{x:.2}")).join(" "));
            assert!(most.iter().all(|&share| share <= 1.0), "{}: {most:?} of the tolerance", model.name);
        }
    }
}
