//! Microfacet models: any NDF with any masking and any Fresnel term. Twin of
//! `shaders/lobe/microfacet.wgsl`.
//!
//! A model is put together at compile time, so that the CPU path calls nothing by pointer within an
//! integrand; what is put together at run time is names.

use crate::base::error::{Error, Result};
use crate::base::half_angle::{Azimuth, Half, HalfSums, MU_MIN, Pair, sine};
use crate::model::directions;
use crate::model::fresnel::conductor::Conductor;
use crate::model::fresnel::dielectric::Dielectric;
use crate::model::fresnel::f82::F82;
use crate::model::fresnel::generalized_schlick::GeneralizedSchlick;
use crate::model::fresnel::none::Constant;
use crate::model::fresnel::schlick::Schlick;
use crate::model::fresnel::thin_film::ThinFilm;
use crate::model::fresnel::{self, Fresnel, MEAN_NODES_UNKNOWN};
use crate::model::half_vector::stretched::Facet;
use crate::model::half_vector::{self, Kinks, adaptive, stretched};
use crate::model::masking::ashikhmin_neubelt::AshikhminNeubelt;
use crate::model::masking::disney_clearcoat::DisneyClearcoat;
use crate::model::masking::kelemen::Kelemen;
use crate::model::masking::none::Unmasked;
use crate::model::masking::schlick_ggx::SchlickGgx;
use crate::model::masking::schlick_ggx_direct::SchlickGgxDirect;
use crate::model::masking::smith_correlated::SmithCorrelated;
use crate::model::masking::smith_joint_approx::SmithJointApprox;
use crate::model::masking::smith_separable::SmithSeparable;
use crate::model::masking::v_cavity::VCavity;
use crate::model::masking::{self, Masking, Toward};
use crate::model::ndf::beckmann::Beckmann;
use crate::model::ndf::blinn_phong::BlinnPhong;
use crate::model::ndf::charlie::Charlie;
use crate::model::ndf::ggx::Ggx;
use crate::model::ndf::gtr::Gtr;
use crate::model::ndf::stretched::Stretched;
use crate::model::ndf::student_t::StudentT;
use crate::model::ndf::{CountRule, Directions, Draw, MappedSlope, Maps, Ndf};
use crate::model::parameters::{Parameters, Setting};
use crate::model::{
    Branches, Integral, Metal, Model, Parameter, Part, Sampling, SlopeCounts, SlopeMap, Slopes, Term, mirror,
    part,
};
use std::marker::PhantomData;
use std::sync::LazyLock;

/// What a model with terms is made of.
#[derive(Debug)]
pub struct Microfacet {
    /// The distribution of normals; the mirror's are all n.
    pub ndf: Term,
    /// Masking and shadowing; of a mirror there is none.
    pub masking: Option<Term>,
    /// The Fresnel term.
    pub fresnel: Term,
    /// Names that stand for its parameters.
    pub(crate) metals: &'static [Metal],
    /// Why its parameters are refused, if they are.
    pub(crate) refused: fn(&Parameters) -> Option<&'static str>,
    /// Whether node counts of its integrals are known; without them, they are found by adaptive quadrature.
    pub(crate) is_counted: bool,
    /// The relative error of its values in f32.
    pub(crate) value_f32: fn(&Setting) -> f64,
    /// What ρ_dh reaches at most at a setting, where that is less than with the worst.
    pub(crate) rho_most: fn(&Setting) -> f64,
    /// The error of its integrals in f32, relative to the most they reach.
    pub(crate) integral_f32: f64,
    /// f below which f32 has lost digits to underflow, sr⁻¹, where that is earlier than of most.
    pub(crate) faint: Option<f64>,
    /// cos θ at which ρ(μ) is not analytic, where there is such a place between grazing and the normal; then it is not
    /// at the normal either.
    pub(crate) seam: Option<f64>,
    /// How many more nodes in μ its mean over directions takes than Schlick's, at a tolerance.
    pub(crate) mean_nodes: fn(&Setting, f64) -> usize,
    /// Its integrals as sums over facets, where that is quicker than over directions.
    pub(crate) facets: Option<FacetSum>,
}

type VisitFacets =
    fn(&directions::Fixed, &Setting, tolerance: f64, degree: Option<usize>, &mut dyn FnMut(Facet));

/// Integrals of a lobe as sums over its facets, each F times the rest of the lobe.
#[derive(Debug)]
pub(crate) struct FacetSum {
    /// Visits the facets that meet a tolerance; or those that integrate polynomials of a degree in F's place.
    pub visit: VisitFacets,
    /// F for c and 1 − c.
    pub fresnel: fn(c: f64, x: f64, &Setting) -> [f64; 2],
    /// The degree of the polynomial of c that F is within a tolerance, where F costs much.
    pub degree: Option<fn(&Setting, tolerance: f64) -> usize>,
}

/// The parts there are: the default is the first of its kind, and an entry here is all that a new one takes.
/// Every combination of them is a model, and the mirror with each Fresnel term.
macro_rules! parts {
    (ndfs: $($ndf:ty),*; maskings: $($masking:ty),*; fresnels: $($fresnel:ty),*;) => {
        /// The masking terms, the default first.
        pub static MASKINGS: [Term; [$(<$masking>::TERM.name),*].len()] = [$(<$masking>::TERM),*];

        /// The Fresnel terms, the default first.
        pub static FRESNELS: [Term; [$(<$fresnel>::TERM.name),*].len()] = [$(<$fresnel>::TERM),*];

        fn with_fresnels<N: Ndf, M: Masking>() -> Vec<Model> {
            vec![$(named(Made::<N, M, $fresnel>::MODEL, N::PARAMETERS)),*]
        }

        fn with_maskings<N: Ndf>() -> Vec<Model> {
            [$(with_fresnels::<N, $masking>()),*].into_iter().flatten().collect()
        }

        /// All microfacet models: every NDF with every masking and every Fresnel term.
        pub static MICROFACETS: LazyLock<Vec<Model>> =
            LazyLock::new(|| [$(with_maskings::<$ndf>()),*].into_iter().flatten().collect());

        /// The ideal mirror with every Fresnel term.
        pub static MIRRORS: LazyLock<Vec<Model>> = LazyLock::new(|| vec![$(named(mirror::MirrorOf::<$fresnel>::MODEL, &[])),*]);
    };
}

parts! {
    ndfs: Ggx, Beckmann, Stretched<Ggx>, Stretched<Beckmann>, Gtr, StudentT, BlinnPhong, Charlie;
    maskings: SmithCorrelated, SmithSeparable, SchlickGgx, SchlickGgxDirect, VCavity, Kelemen, AshikhminNeubelt, DisneyClearcoat,
        SmithJointApprox, Unmasked;
    fresnels: Schlick, GeneralizedSchlick, Constant, Dielectric, Conductor, F82, ThinFilm;
}

/// GGX with the defaults.
pub(crate) static GGX: Model = Model {
    summary: "GGX microfacets, height-correlated Smith, Schlick: f = F0·A + F90·B",
    source: "Walter et al. 2007, eq. 20 and 33; Heitz 2014, eq. 99; Schlick 1994, eq. 15",
    ..Made::<Ggx, SmithCorrelated, Schlick>::MODEL
};

/// Beckmann with the defaults.
pub(super) static BECKMANN: Model = Model {
    summary: "Beckmann microfacets, height-correlated Smith, Schlick: f = F0·A + F90·B",
    source: "Walter et al. 2007, eq. 20 and 25; Heitz 2014, eq. 99; Schlick 1994, eq. 15",
    ..Made::<Beckmann, SmithCorrelated, Schlick>::MODEL
};

/// GTR with the defaults.
pub(super) static GTR: Model = Model {
    summary: "generalised Trowbridge–Reitz microfacets, gamma = 1 Disney's clearcoat: f = F0·A + F90·B",
    source: "Burley 2012, appendix B; Heitz 2014, eq. 99; Schlick 1994, eq. 15",
    parameters: Gtr::PARAMETERS,
    ..Made::<Gtr, SmithCorrelated, Schlick>::MODEL
};

/// Student's t with the defaults.
pub(super) static STUDENT_T: Model = Model {
    summary: "Student's t-distribution of slopes, height-correlated Smith of its own, Schlick: f = F0·A + F90·B",
    source: "Ribardière et al. 2017; Heitz 2014, eq. 99; Schlick 1994, eq. 15",
    parameters: StudentT::PARAMETERS,
    ..Made::<StudentT, SmithCorrelated, Schlick>::MODEL
};

/// Blinn–Phong with the defaults.
pub(super) static BLINN_PHONG: Model = Model {
    summary: "Blinn–Phong microfacets, height-correlated Smith, Schlick: f = F0·A + F90·B",
    source: "Walter et al. 2007, eq. 20 and 30; Heitz 2014, eq. 99; Schlick 1994, eq. 15",
    ..Made::<BlinnPhong, SmithCorrelated, Schlick>::MODEL
};

/// Charlie with the defaults.
pub(super) static CHARLIE: Model = Model {
    summary: "Charlie's fibres for cloth, masked by their fit, Schlick: f = F0·A + F90·B",
    source: "Estevez & Kulla 2017, eq. 2 to 4; Heitz 2014, eq. 99; Schlick 1994, eq. 15",
    ..Made::<Charlie, SmithCorrelated, Schlick>::MODEL
};

impl Model {
    /// The kinds of terms that recipes choose: what they call the kind, what there is of it, and which one this
    /// model has. None of a model that is not made of terms.
    pub fn terms(&self) -> Vec<(&'static str, &'static [Term], &'static Term)> {
        let Some(made) = self.microfacet else { return Vec::new() };
        let masking = made.masking.as_ref().map(|masking| ("masking", &MASKINGS[..], masking));
        masking.into_iter().chain([("fresnel", &FRESNELS[..], &made.fresnel)]).collect()
    }

    /// The same with α that differs along the tangent and the bitangent, if its distribution can be stretched.
    pub fn anisotropic(&self) -> Option<&'static Self> {
        let made = self.microfacet?;
        let stretched = crate::model::find(&format!("{}-anisotropic", made.ndf.name)).ok()?;
        let masking = made.masking.as_ref().map(|masking| masking.name);
        stretched.with_terms(masking, Some(made.fresnel.name)).ok()
    }

    /// This model with other terms.
    ///
    /// # Errors
    /// When it has no such terms, or there is none of this name.
    pub fn with_terms(&self, masking: Option<&str>, fresnel: Option<&str>) -> Result<&'static Self> {
        let terms = self.terms();
        let choose = |kind: &str, name: Option<&str>| {
            let own = terms.iter().find(|(name, ..)| *name == kind);
            match (own, name) {
                (Some((_, there, own)), name) => Ok(Some(term(kind, there, name.unwrap_or(own.name))?.name)),
                (None, None) => Ok(None),
                (None, Some(_)) if terms.is_empty() => Err(Error::input(format!(
                    "{} is no microfacet model; it has no masking and no fresnel to choose",
                    self.name
                ))),
                (None, Some(_)) => Err(Error::input(format!("{} has no {kind} to choose", self.name))),
            }
        };
        let (masking, fresnel) = (choose("masking", masking)?, choose("fresnel", fresnel)?);
        let it = self.microfacet.map(|made| (made.ndf.name, masking, fresnel));
        let names = |of: &Microfacet| {
            (of.ndf.name, of.masking.as_ref().map(|masking| masking.name), Some(of.fresnel.name))
        };
        let mut made = MICROFACETS.iter().chain(MIRRORS.iter());
        made.find(|model| model.microfacet.map(names) == it).ok_or_else(|| {
            Error::Internal(format!("{} with {masking:?} and {fresnel:?} is not made", self.name))
        })
    }
}

fn term(kind: &str, terms: &'static [Term], name: &str) -> Result<&'static Term> {
    terms.iter().find(|term| term.name == name).ok_or_else(|| {
        let names: Vec<_> = terms.iter().map(|term| term.name).collect();
        Error::input(format!("no {kind} \"{name}\"; there are {}", names.join(", ")))
    })
}

/// The model with a name that tells its terms: the NDF's alone with the defaults, else all of them. It is made
/// once and lives as long as the process. `more` are parameters beside its Fresnel term's.
fn named(model: Model, more: &'static [Parameter]) -> Model {
    let Some(Microfacet { ndf, masking, fresnel, .. }) = model.microfacet else { return model };
    let terms: Vec<_> = [ndf].into_iter().chain(masking).chain([fresnel]).collect();
    let keep = |text: fn(&Term) -> &'static str, between: &str| -> &'static str {
        terms.iter().map(|&term| text(term)).collect::<Vec<_>>().join(between).leak()
    };
    let is_default =
        masking.as_ref().is_none_or(|m| m.name == MASKINGS[0].name) && fresnel.name == FRESNELS[0].name;
    Model {
        name: if is_default { ndf.name } else { keep(|term| term.name, "-") },
        summary: keep(|term| term.summary, ", "),
        source: keep(|term| term.source, "; "),
        parameters: match more {
            [] => model.parameters,
            _ => [more, model.parameters].concat().leak(),
        },
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
        shape: Some(N::SHAPE),
        parameters: F::PARAMETERS,
        derive: |parameters| {
            N::derive(parameters);
            F::derive(parameters);
        },
        rho_bound: Self::RHO_BOUND,
        parts: &Self::PARTS,
        integral: match Self::UNBOUNDED {
            Some(why) => Integral::Unbounded(why),
            None => match &Self::SLOPES {
                Some(slopes) => Integral::Slopes(slopes),
                None => Integral::Listed(Self::MAP),
            },
        },
        value_f32: N::F32.value + F::VALUE_F32,
        lobe: Self::lobe,
    };

    const UNBOUNDED: Option<&'static str> = match M::UNBOUNDED {
        None if !N::ALBEDO.is_mirror_at_0 => M::UNBOUNDED_OFF_PEAK,
        why => why,
    };

    const RHO_BOUND: f64 = match Self::UNBOUNDED {
        Some(_) => f64::INFINITY,
        None => of_masking(N::ALBEDO.bounds, M::TERM.name) * F::BOUND,
    };

    const TERMS: Microfacet = Microfacet {
        ndf: N::TERM,
        masking: Some(M::TERM),
        fresnel: F::TERM,
        metals: F::METALS,
        refused: F::refused,
        is_counted: Self::COUNTS.is_some(),
        value_f32: |s| N::F32.value_at.map_or(N::F32.value, |value_at| value_at(s)) + F::VALUE_F32,
        rho_most: |s| M::bound((N::ALBEDO.bound_at)(s), s.alpha) * F::BOUND,
        integral_f32: N::F32.integral,
        faint: N::F32.faint,
        seam: N::ALBEDO.seam,
        mean_nodes: match F::COUNTS {
            Some(counts) => counts.mean_nodes,
            None => |_, _| MEAN_NODES_UNKNOWN,
        },
        facets: match (Self::COUNTS, F::AS_POLYNOMIAL) {
            (Some(_), polynomial) if N::AXES.is_some() && M::OF_NORMAL.is_none() => Some(FacetSum {
                visit: Self::visit,
                fresnel: F::fresnel,
                degree: match polynomial {
                    Some(polynomial) => Some(polynomial.degree),
                    None => None,
                },
            }),
            _ => None,
        },
    };

    const PARTS: [Part; 4] = [
        F::TERM.part,
        N::TERM.part,
        M::TERM.part,
        if N::AXES.is_some() { part!("lobe/anisotropic") } else { part!("lobe/microfacet") },
    ];

    /// The node counts of all three, if all have them.
    const COUNTS: Option<(CountRule, masking::MaskingCounts, fresnel::FresnelCounts)> =
        match (N::RULE, M::COUNTS, F::COUNTS) {
            (Some(ndf), Some(masking), Some(fresnel)) if N::RULE_HOLDS_TURNS || !M::TURNS => {
                Some((ndf, masking, fresnel))
            }
            _ => None,
        };

    const SLOPES: Option<Slopes> = match (N::MAPS, Self::COUNTS) {
        (Some(maps), Some((CountRule { kernels: Some(kernels), branches, .. }, ..)))
            if M::OF_NORMAL.is_none() =>
        {
            Some(Self::slopes(maps, kernels, branches))
        }
        _ => None,
    };

    const MAP: directions::Map = match Self::COUNTS {
        Some((rule, ..)) => directions::Map {
            samples: |fixed, s, tolerance| {
                let counts = Self::counts(fixed.mu, s, tolerance);
                match Self::DIRECTIONS {
                    _ if N::AXES.is_some() => stretched::samples::<N, M>(fixed, s, counts, tolerance),
                    Some(directions) => (directions.samples)(fixed, s, counts, tolerance, M::OF_NORMAL),
                    None => half_vector::samples::<N, M>(fixed, s, counts, tolerance),
                }
            },
            most: |s, tolerance| {
                let panels = if N::AXES.is_some() { stretched::PANELS } else { 1 };
                let cost = |mu| {
                    let counts = Self::counts(mu, s, tolerance);
                    panels
                        * match Self::DIRECTIONS {
                            Some(directions) => (directions.most)(counts, M::OF_NORMAL),
                            None => half_vector::most(&kinks::<M>(), counts),
                        }
                };
                [1.0, 0.3, 0.1, 0.03, 1e-2, 1e-3, 1e-4, MU_MIN].map(cost).into_iter().max().unwrap_or(1)
            },
            mean: match (rule.means, kinks::<M>().most > 0) {
                (Some([smooth, _]), false) => Some(smooth),
                (Some([_, kinked]), true) => Some(kinked),
                (None, false) => None,
                (None, true) => Some(half_vector::mean),
            },
            limit: Self::limit,
        },
        None => directions::Map {
            samples: |fixed, s, tolerance| {
                adaptive::samples::<N>(fixed, s, tolerance, &kinks::<M>(), &|p, a| Self::lobe(p, a, s))
            },
            most: |_, tolerance| adaptive::most(tolerance),
            mean: Some(adaptive::mean),
            limit: Self::limit,
        },
    };

    const DIRECTIONS: Option<Directions> = match N::RULE {
        Some(rule) => rule.directions,
        None => None,
    };

    const fn slopes(maps: Maps, [coarse, fine]: [Part; 2], branches: Option<Branches>) -> Slopes {
        Slopes {
            coarse: SlopeMap {
                part: coarse,
                end: maps.coarse.end,
                integrand: |r, azimuth, mu_e, s| Self::integrand(MapAt::Coarse(r), azimuth, mu_e, s),
            },
            fine: SlopeMap {
                part: fine,
                end: maps.fine.end,
                integrand: |r, azimuth, mu_e, s| Self::integrand(MapAt::Fine(r), azimuth, mu_e, s),
            },
            counts: Self::counts,
            branches: if F::POLYNOMIAL && M::SPREADS { branches } else { None },
            mirror_limit: Self::mirror_limit,
            map: Self::MAP,
            sampling: match N::DRAWS {
                Some(draws) => Some(Sampling {
                    part: draws.part,
                    ndf: |draw, mu, s| {
                        Self::estimate(N::DRAWS.map(|draws| (draws.by_ndf)(draw, mu, s)), mu, s)
                    },
                    vndf: |draw, mu, s| {
                        Self::estimate(N::DRAWS.map(|draws| (draws.by_vndf)(draw, mu, s)), mu, s)
                    },
                }),
                None => None,
            },
        }
    }

    fn visit(
        fixed: &directions::Fixed,
        s: &Setting,
        tolerance: f64,
        degree: Option<usize>,
        visit: &mut dyn FnMut(Facet),
    ) {
        let Some((rule, of_masking, _)) = Self::COUNTS else { return };
        let counts = match (degree, F::AS_POLYNOMIAL) {
            (Some(degree), Some(polynomial)) => {
                (polynomial.counts)(of_masking((rule.counts)(fixed.mu, s, tolerance), tolerance), degree)
            }
            _ => Self::counts(fixed.mu, s, tolerance),
        };
        stretched::facets::<N, M>(fixed, s, counts, tolerance, visit);
    }

    /// f μi / p of a normal that was drawn.
    fn estimate(draw: Option<Draw>, mu: f64, s: &Setting) -> [f64; 2] {
        let Some(Draw { x, t2, m, weight: [of_q, rest] }) = draw else { return [f64::NAN; 2] };
        let q = sine(mu) / mu * x + m;
        let y = m * m + t2;
        let z = (2.0 * q * m - y).max(0.0);
        let all = z * (of_q * q + rest) / M::masking::<N>(z, y, mu, s);
        let c = (mu * q / y.sqrt()).min(1.0);
        if z == 0.0 { [0.0; 2] } else { F::fresnel(c, 1.0 - c, s).map(|f| f * all) }
    }

    /// α → 0, where that is the mirror.
    fn limit(mu: f64, s: &Setting) -> Option<[f64; 2]> {
        let axes = N::AXES.map_or([s.alpha; 2], |axes| axes(s));
        (N::ALBEDO.is_mirror_at_0 && axes == [0.0; 2]).then(|| Self::mirror_limit(mu, s))
    }

    fn mirror_limit(mu: f64, s: &Setting) -> [f64; 2] {
        times(F::fresnel(mu, 1.0 - mu, s), M::mirror(mu))
    }

    /// The NDF's error model is for correlated Smith and Schlick.
    fn counts(mu: f64, s: &Setting, tolerance: f64) -> [SlopeCounts; 2] {
        let Some((rule, of_masking, of_fresnel)) = Self::COUNTS else {
            return [SlopeCounts { azimuths: 0, nodes: 0 }; 2];
        };
        let [near, far] = of_masking((rule.counts)(mu, s, tolerance), tolerance);
        [(of_fresnel.near)(near, s, tolerance), (of_fresnel.far)(far, s, tolerance)]
    }

    fn lobe(p: &Pair, a: &Azimuth, setting: &Setting) -> [f64; 2] {
        let h = Half::new(p, a);
        let s = Facets::<N, M>::lobe(p, a, &h, setting);
        times(F::fresnel(h.c, h.one_minus_c, setting), s)
    }

    fn integrand(map: MapAt, azimuth: [f64; 3], mu_e: f64, s: &Setting) -> [f64; 2] {
        let [c, all] = Facets::<N, M>::integrand(map, azimuth, mu_e, s);
        times(F::fresnel(c, 1.0 - c, s), all)
    }
}

/// Not `map`, of which there would be one for each combination.
fn times([a, b]: [f64; 2], s: f64) -> [f64; 2] {
    [a * s, b * s]
}

/// What of a combination does not depend on its Fresnel term, by itself: it need not be compiled again for each.
struct Facets<N, M>(PhantomData<(N, M)>);

/// Which map, and where.
enum MapAt {
    Coarse(f64),
    Fine(f64),
}

impl<N: Ndf, M: Masking> Facets<N, M> {
    /// D G2 / (4 μi μe)
    #[inline(never)]
    fn lobe(p: &Pair, a: &Azimuth, h: &Half, setting: &Setting) -> f64 {
        let HalfSums { cp, cm, sp, sm } = a.frame;
        let axes = N::AXES.map(|axes| axes(setting));
        let with = |alpha: f64| Setting { alpha, ..*setting };
        let toward = |mu: f64, cos: f64, sin: f64| Toward {
            mu,
            setting: axes.map_or(*setting, |[x, y]| with(((x * cos).powi(2) + (y * sin).powi(2)).sqrt())),
        };
        let shared = M::visibility::<N>(&toward(p.mu_i, cp + cm, sp + sm), &toward(p.mu_e, cp - cm, sp - sm));
        let d = match axes {
            Some(axes) => N::ndf(&h.stretched(p, a, axes), p.hz2, &with((axes[0] * axes[1]).sqrt())),
            None => N::ndf(h, p.hz2, setting),
        };
        d * M::of_normal(shared, p, h)
    }

    /// ωi·ωm, and the integrand without F.
    #[inline(never)]
    fn integrand(at: MapAt, [mu_c, t_max, t_max_inverse]: [f64; 3], mu_e: f64, s: &Setting) -> [f64; 2] {
        let Some(maps) = N::MAPS else { return [f64::NAN; 2] };
        let MappedSlope { p, m, weight } = match at {
            MapAt::Coarse(r) => (maps.coarse.map)(r, s),
            MapAt::Fine(r) => (maps.fine.map)(r, s),
        };
        let projected = mu_e * m + mu_c * p; // ωe·ωm √y
        let y = m * m + p * p;
        let x = (t_max * m - p) * (p + t_max_inverse * m); // cos θi = μe x/y
        let all = 2.0 * x * projected * weight / M::masking::<N>(x, y, mu_e, s);
        [(projected / y.sqrt()).clamp(0.0, 1.0), all]
    }
}

/// Where G2 is not smooth in ωm.
const fn kinks<M: Masking>() -> Kinks {
    match M::OF_NORMAL {
        Some(kinks) => kinks,
        None => Kinks::NONE,
    }
}

/// The bound with a masking, 1 where none is listed. A loop, as the constant of a model is made at compile time.
const fn of_masking(bounds: &[(&str, f64)], masking: &str) -> f64 {
    let mut k = 0;
    while k < bounds.len() {
        if is_same(bounds[k].0, masking) {
            return bounds[k].1;
        }
        k += 1;
    }
    1.0
}

const fn is_same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let mut k = 0;
    while k < a.len() && k < b.len() && a[k] == b[k] {
        k += 1;
    }
    k == a.len() && k == b.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::quadrature::gauss_legendre;
    use crate::base::tolerance::decade;
    use crate::model;
    use crate::model::MODELS;
    use crate::model::slope_azimuths::side;
    use rayon::prelude::*;
    use std::collections::BTreeSet;
    use std::f64::consts::FRAC_PI_2;

    /// Names are keys of pipelines, words of recipes and parts of file names.
    #[test]
    fn every_combination_has_a_name_of_its_own() {
        let defaults = MODELS.iter().filter(|model| model.terms().len() == 2).count();
        // And two that are stretched, which are no defaults.
        assert_eq!(MICROFACETS.len(), (defaults + 2) * MASKINGS.len() * FRESNELS.len());
        let names: Vec<_> = model::all().map(|model| model.name).collect();
        for (k, name) in names.iter().enumerate() {
            assert!(!names[..k].contains(name), "{name}");
            assert_eq!(model::find(name).unwrap().name, *name);
        }
        assert_eq!(names.len(), MODELS.len() + MICROFACETS.len() + MIRRORS.len() - defaults - 1);
        for model in MICROFACETS.iter() {
            let made = model.microfacet.unwrap();
            let masking = made.masking.as_ref().map(|masking| masking.name);
            let default = model::find(made.ndf.name).unwrap();
            assert_eq!(default.with_terms(masking, Some(made.fresnel.name)).unwrap(), model);
            // What recipes call by its NDF's name alone names the sources of all its terms too.
            assert!(model.name != default.name || model.source == default.source, "{}", model.name);
        }
        for model in MIRRORS.iter() {
            let fresnel = model.microfacet.unwrap().fresnel.name;
            assert_eq!(mirror::MODEL.with_terms(None, Some(fresnel)).unwrap(), model);
        }
        assert_eq!(GGX.with_terms(None, None).unwrap(), &GGX);
        assert_eq!(MICROFACETS[0].summary, GGX.summary);
    }

    /// The device keeps the rules of the coarse map in a uniform buffer of so many nodes, whichever a table takes.
    #[test]
    fn the_rules_of_a_table_fit() {
        for model in MICROFACETS.iter() {
            let Integral::Slopes(slopes) = model.integral else { continue };
            for tolerance in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6] {
                let mut rules = BTreeSet::new();
                for parameters in extremes(model) {
                    rules.clear();
                    for (i, j) in (0..60).flat_map(|i| (0..100).map(move |j| (i, j))) {
                        let (mu, alpha) = (2f64.powf(-0.4 * f64::from(i)), 2f64.powf(-0.4 * f64::from(j)));
                        let setting = Setting { alpha, parameters };
                        rules.extend((slopes.counts)(mu, &setting, tolerance).map(|counts| counts.nodes));
                    }
                    let nodes: usize = rules.iter().sum();
                    assert!(nodes <= 2048, "{} at {tolerance}: {nodes} nodes", model.name);
                }
            }
        }
    }

    /// Extremes of a model's parameters, and what is between.
    fn extremes(model: &Model) -> Vec<Parameters> {
        let mut all = vec![model.defaults()];
        for parameter in model.parameters.iter() {
            let values = match parameter.name {
                "eta" => vec![0.05, 1.0, 1.0 + 2f64.powi(-22), 1.0001, 1.01, 1.1, 1.5, 3.0, 1e3],
                "k" => vec![0.0, 1e-3, 0.3, 3.0, 100.0],
                "thickness" => vec![0.0, 250.0, 700.0, 2000.0],
                "film_eta" => vec![1.05, 1.3, 2.0],
                "f0" => vec![0.0, 0.04, 0.5, 1.0],
                "exponent" => vec![2.0, 2.1, 2.5, 2.9, 4.5, 5.0, 7.3, 10.0],
                _ => vec![
                    parameter.range[0],
                    0.5 * (parameter.range[0] + parameter.range[1]),
                    parameter.range[1],
                ],
            };
            let with = |p: &Parameters, value: f64| {
                let mut p = *p;
                p[parameter.place] = value.clamp(parameter.range[0], parameter.range[1]);
                p
            };
            all = all.iter().flat_map(|p| values.iter().map(move |&value| with(p, value))).collect();
        }
        all.retain(|p| model.refused(p).is_none());
        all.dedup();
        all
    }

    /// The largest ρ that a model reaches: over its parameters' extremes, α, μ and azimuths.
    fn largest_rho(model: &Model) -> (f64, String) {
        let map = match model.integral {
            Integral::Slopes(slopes) => slopes.map,
            Integral::Listed(map) => map,
            _ => return (0.0, String::new()),
        };
        let mut cases = Vec::new();
        let shape = model.shape.unwrap();
        for parameters in extremes(model) {
            let (alphas, mus) = match crate::base::is_thorough() {
                true => (
                    &[1.0, 0.9, 0.7, 0.5, 0.3, 0.1, 0.03, 0.01, 1e-3][..],
                    &[MU_MIN, 1e-4, 1e-2, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 0.9, 1.0][..],
                ),
                false => (&[1.0, 0.3][..], &[MU_MIN, 1e-2, 0.3, 1.0][..]),
            };
            for &alpha in alphas {
                let setting = Setting { alpha: shape.measure(f64::sqrt(alpha)), parameters };
                for &mu in mus {
                    let phis: &[f64] = if model.is_anisotropic() {
                        &[0.0, 0.02, 0.1, 0.4, 0.8, 1.2, 1.5, FRAC_PI_2]
                    } else {
                        &[0.0]
                    };
                    cases.extend(phis.iter().map(|&phi| (setting, mu, phi)));
                }
            }
        }
        let rho = |(s, mu, phi): &(Setting, f64, f64)| {
            let fixed = directions::Fixed { mu: *mu, phi: *phi, factored: false, kinks: Vec::new() };
            let rho = (map.limit)(*mu, s).unwrap_or_else(|| {
                (map.samples)(&fixed, s, 1e-3).iter().fold([0.0; 2], |sum, sample| {
                    let f = (model.lobe)(&sample.pair, &sample.azimuth, s);
                    [sum[0] + sample.weight * f[0], sum[1] + sample.weight * f[1]]
                })
            });
            (rho[0] + rho[1], format!("μ = {mu}, φ = {phi}, {s:?}"))
        };
        cases.par_iter().map(rho).reduce(|| (0.0, String::new()), |a, b| if b.0 > a.0 { b } else { a })
    }

    /// No masking makes more light than its model declares.
    #[test]
    #[ignore = "takes minutes"]
    fn declared_bounds_are_true() {
        bounds_are_true(|_| true);
    }

    /// Cloth's visibility masks nothing of what leans far: along grooves of αx = 10, stretched GGX reflects 5.
    #[test]
    fn declared_bounds_of_stretched_cloth_are_true() {
        bounds_are_true(|model| {
            let parts = model.microfacet.unwrap();
            model.is_anisotropic()
                && parts.masking.as_ref().is_some_and(|masking| masking.name == "ashikhmin-neubelt")
        });
    }

    fn bounds_are_true(is_meant: impl Fn(&Model) -> bool) {
        let mut broken = Vec::new();
        let plain = |model: &&Model| model.microfacet.unwrap().fresnel.name == "none";
        for model in MICROFACETS.iter().filter(plain).filter(|model| is_meant(model)) {
            let (rho, place) = largest_rho(model);
            println!("{}: {rho:.4} of {:.4} at {place}", model.name, model.rho_bound);
            if rho > model.rho_bound * (1.0 + 2e-3) {
                broken.push(format!("{}: {rho} of {} at {place}", model.name, model.rho_bound));
            }
        }
        assert!(broken.is_empty(), "{broken:#?}");
    }

    /// The error model was made for correlated heights and Schlick: the others keep the tolerances by what they
    /// add to it. Without `near`, separable Smith is off by 1.3 times 1e-5 and 1.7 times 1e-6.
    #[test]
    fn the_error_model_holds_for_every_combination() {
        let mut failed = Vec::new();
        let thorough = crate::base::is_thorough();
        for (place, model) in MICROFACETS.iter().enumerate() {
            let Integral::Slopes(slopes) = model.integral else { continue };
            let rule = |mu: f64, s: &Setting, tolerance: f64, counts: [SlopeCounts; 2]| {
                let map = slopes.map(tolerance);
                let mut sum = [0.0; 2];
                for (sign, counts) in [1.0, -1.0].into_iter().zip(counts) {
                    let nodes = gauss_legendre(counts.nodes);
                    for [c, t_max, inverse, weight] in
                        side(mu, sign, &gauss_legendre(counts.azimuths), tolerance)
                    {
                        let end = (map.end)(t_max, s);
                        for node in &nodes {
                            let f = (map.integrand)(end * node.x, [c, t_max, inverse], mu, s);
                            let weight = weight * end * node.weight;
                            sum = [sum[0] + weight * f[0], sum[1] + weight * f[1]];
                        }
                    }
                }
                sum
            };
            let extremes = extremes(model);
            // A thin film promises no tolerance finer than 1e-6, and takes more to converge.
            let film = model.microfacet.is_some_and(|made| made.fresnel.name == ThinFilm::TERM.name);
            let promised = if film { 6 } else { 9 };
            let converged = match film {
                true => SlopeCounts { azimuths: 200, nodes: 280 },
                false => SlopeCounts { azimuths: 100, nodes: 160 },
            };
            // Terms do not know of each other: each with the others' defaults tells most.
            let telling =
                model.terms().iter().filter(|(_, there, own)| own.name != there[0].name).count() < 2;
            let count = match (film, telling) {
                _ if !telling && !thorough && place % 8 != 0 => continue,
                (true, true) => 5,
                (true, false) => 1,
                (false, true) => (if thorough { 120 } else { 40 }) / extremes.len().min(6),
                (false, false) => 4,
            };
            let worst: Vec<[f64; 9]> = (0..count * extremes.len())
                .into_par_iter()
                .map(|n| {
                    let (k, parameters) = (n / extremes.len(), extremes[n % extremes.len()]);
                    // Additive recurrences of two irrationals: even over both logarithms.
                    let (u, v) = ((k as f64 * 0.754_877_666).fract(), (k as f64 * 0.569_840_291).fract());
                    let (mu, alpha) = (2f64.powf(-24.0 * u * u), 2f64.powf(-20.0 * v * v));
                    let setting = Setting { alpha, parameters };
                    let exact = rule(mu, &setting, 1e-10, [converged; 2]);
                    std::array::from_fn(|d| {
                        if d >= promised {
                            return 0.0;
                        }
                        let tolerance = 10f64.powi(-1 - d as i32);
                        assert_eq!(decade(tolerance), d);
                        let [a, b] = rule(mu, &setting, tolerance, (slopes.counts)(mu, &setting, tolerance));
                        (a - exact[0]).abs().max((b - exact[1]).abs()) / tolerance
                    })
                })
                .collect();
            for (j, p) in extremes.iter().enumerate() {
                let of = worst.iter().skip(j).step_by(extremes.len());
                let most = of.fold([0.0; 9], |a, b| std::array::from_fn(|d| f64::max(a[d], b[d])));
                println!("{} {:?}: {}", model.name, &p[4..8], most.map(|x| format!("{x:.2}")).join(" "));
            }
            let most = worst.into_iter().reduce(|a, b| std::array::from_fn(|d| a[d].max(b[d]))).unwrap();
            println!("{}: {}", model.name, most.map(|x| format!("{x:.2}")).join(" "));
            if most.iter().any(|&share| share > 1.0) {
                failed.push(format!("{}: {most:?} of the tolerance", model.name));
            }
        }
        assert!(failed.is_empty(), "{failed:#?}");
    }
}
