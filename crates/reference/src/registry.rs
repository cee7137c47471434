//! Every part and every model by its name: a new one is its file and a line here.

use crate::anisotropic::Anisotropic;
use crate::classic::ashikhmin_shirley::{ASHIKHMIN_SHIRLEY, ASHIKHMIN_SHIRLEY_DIFFUSE};
use crate::classic::blinn::BLINN;
use crate::classic::lafortune::LAFORTUNE;
use crate::classic::phong::PHONG;
use crate::classic::ward::WARD;
use crate::classic::ward_dur::WARD_DUR;
use crate::diffuse::burley::BURLEY;
use crate::diffuse::disney::{DISNEY_SHEEN, DISNEY_SUBSURFACE};
use crate::diffuse::eon::EON;
use crate::diffuse::frostbite::FROSTBITE;
use crate::diffuse::fujii::FUJII;
use crate::diffuse::gltf::GLTF_DIFFUSE;
use crate::diffuse::gltf_oren_nayar::GLTF_OREN_NAYAR;
use crate::diffuse::lambert::LAMBERT;
use crate::diffuse::oren_nayar::OREN_NAYAR;
use crate::fresnel::conductor::Conductor;
use crate::fresnel::dielectric::Dielectric;
use crate::fresnel::f82::F82;
use crate::fresnel::generalized_schlick::GeneralizedSchlick;
use crate::fresnel::none::Constant;
use crate::fresnel::schlick::Schlick;
use crate::fresnel::thin_film::ThinFilm;
use crate::masking::ashikhmin_neubelt::AshikhminNeubelt;
use crate::masking::disney_clearcoat::DisneyClearcoat;
use crate::masking::kelemen::Kelemen;
use crate::masking::none::Unmasked;
use crate::masking::schlick_ggx::{SchlickGgx, SchlickGgxDirect};
use crate::masking::smith_correlated::SmithCorrelated;
use crate::masking::smith_joint_approx::SmithJointApprox;
use crate::masking::smith_separable::SmithSeparable;
use crate::masking::v_cavity::VCavity;
use crate::microfacet::Microfacet;
use crate::mirror::Mirror;
use crate::ndf::beckmann::Beckmann;
use crate::ndf::blinn_phong::BlinnPhong;
use crate::ndf::charlie::Charlie;
use crate::ndf::ggx::Ggx;
use crate::ndf::gtr::Gtr;
use crate::ndf::student_t::StudentT;
use crate::{Fresnel, Masking, Ndf, Reference};
use std::sync::LazyLock;

/// Parts of a kind by their names.
type Named<T> = &'static [(&'static str, T)];

const NDFS: Named<Distribution> = &[
    ("ggx", Distribution::Round(&Ggx)),
    ("beckmann", Distribution::Round(&Beckmann)),
    ("gtr", Distribution::Round(&Gtr)),
    ("student-t", Distribution::Round(&StudentT)),
    ("blinn-phong", Distribution::Round(&BlinnPhong)),
    ("charlie", Distribution::Round(&Charlie)),
    ("ggx-anisotropic", Distribution::Stretched(&Ggx)),
    ("beckmann-anisotropic", Distribution::Stretched(&Beckmann)),
];

const MASKINGS: Named<&dyn Masking> = &[
    ("smith-correlated", &SmithCorrelated),
    ("smith-separable", &SmithSeparable),
    ("schlick-ggx", &SchlickGgx),
    ("schlick-ggx-direct", &SchlickGgxDirect),
    ("v-cavity", &VCavity),
    ("kelemen", &Kelemen),
    ("ashikhmin-neubelt", &AshikhminNeubelt),
    ("disney-clearcoat", &DisneyClearcoat),
    ("smith-joint-approx", &SmithJointApprox),
    ("none", &Unmasked),
];

const FRESNELS: Named<&dyn Fresnel> = &[
    ("schlick", &Schlick),
    ("generalized-schlick", &GeneralizedSchlick),
    ("none", &Constant),
    ("dielectric", &Dielectric),
    ("conductor", &Conductor),
    ("f82", &F82),
    ("thin-film", &ThinFilm),
];

const MODELS: Named<&dyn Reference> = &[
    ("lambert", LAMBERT),
    ("gltf_diffuse", GLTF_DIFFUSE),
    ("gltf_oren_nayar", GLTF_OREN_NAYAR),
    ("oren-nayar", OREN_NAYAR),
    ("fujii", FUJII),
    ("eon", EON),
    ("burley", BURLEY),
    ("frostbite", FROSTBITE),
    ("disney-subsurface", DISNEY_SUBSURFACE),
    ("disney-sheen", DISNEY_SHEEN),
    ("ward", WARD),
    ("ward-dur", WARD_DUR),
    ("blinn", BLINN),
    ("phong", PHONG),
    ("lafortune", LAFORTUNE),
    ("ashikhmin-shirley", ASHIKHMIN_SHIRLEY),
    ("ashikhmin-shirley-diffuse", ASHIKHMIN_SHIRLEY_DIFFUSE),
];

/// A distribution of normals whose slopes are the same along the tangent and the bitangent, or one that is stretched.
#[derive(Clone, Copy)]
enum Distribution {
    Round(&'static dyn Ndf),
    Stretched(&'static dyn Ndf),
}

/// Every distribution with every masking and every Fresnel term, in the order of the lists.
static MICROFACETS: LazyLock<Vec<Box<dyn Reference + Send>>> = LazyLock::new(|| {
    let with = |ndf: Distribution, masking, fresnel| -> Box<dyn Reference + Send> {
        match ndf {
            Distribution::Round(ndf) => Box::new(Microfacet { ndf, masking, fresnel }),
            Distribution::Stretched(ndf) => Box::new(Anisotropic { ndf, masking, fresnel }),
        }
    };
    let maskings = |ndf| MASKINGS.iter().map(move |&(_, masking)| (ndf, masking));
    let facets = NDFS.iter().flat_map(|&(_, ndf)| maskings(ndf));
    facets
        .flat_map(|(ndf, masking)| FRESNELS.iter().map(move |&(_, fresnel)| with(ndf, masking, fresnel)))
        .collect()
});

/// The mirror with every Fresnel term.
static MIRRORS: LazyLock<Vec<Mirror>> =
    LazyLock::new(|| FRESNELS.iter().map(|&(_, fresnel)| Mirror { fresnel }).collect());

/// The microfacet model of a distribution of normals, a masking and a Fresnel term; `None` where one is unknown.
pub fn microfacet(ndf: &str, masking: &str, fresnel: &str) -> Option<&'static dyn Reference> {
    let [i, j, k] = [index(NDFS, ndf)?, index(MASKINGS, masking)?, index(FRESNELS, fresnel)?];
    let model = MICROFACETS.get((i * MASKINGS.len() + j) * FRESNELS.len() + k)?;
    Some(&**model)
}

/// The ideal mirror with a Fresnel term; `None` where that is unknown.
pub fn mirror(fresnel: &str) -> Option<&'static dyn Reference> {
    Some(MIRRORS.get(index(FRESNELS, fresnel)?)?)
}

/// The model of a name that is made of no parts; `None` where it is unknown.
pub fn model(name: &str) -> Option<&'static dyn Reference> {
    Some(MODELS.get(index(MODELS, name)?)?.1)
}

fn index<T>(parts: Named<T>, name: &str) -> Option<usize> {
    parts.iter().position(|part| part.0 == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Angles, Parameters, Setting};
    use std::collections::BTreeSet;

    #[test]
    fn names_are_names_of_one_thing() {
        fn names<T>(parts: Named<T>) -> usize {
            parts.iter().map(|part| part.0).collect::<BTreeSet<_>>().len()
        }
        assert_eq!(names(NDFS), NDFS.len());
        assert_eq!(names(MASKINGS), MASKINGS.len());
        assert_eq!(names(FRESNELS), FRESNELS.len());
        assert_eq!(names(MODELS), MODELS.len());
        assert!(microfacet("ggx", "smith", "schlick").is_none());
        assert!(mirror("smith-correlated").is_none() && model("ggx").is_none());
    }

    /// The place in the list of combinations is that of the parts.
    #[test]
    fn a_combination_has_the_parts_it_is_asked_for() {
        let angles = Angles { theta_i: 0.4, theta_e: 1.1, delta_phi: 0.3, phi_i: 0.2 };
        for &(ndf, distribution) in NDFS {
            for &(name, masking) in MASKINGS {
                for &(fresnel, term) in FRESNELS {
                    let found = microfacet(ndf, name, fresnel).unwrap();
                    let setting = Setting::new(found.measure(), Some(0.5), &Parameters::DEFAULT).unwrap();
                    let expected = match distribution {
                        Distribution::Round(ndf) => {
                            Microfacet { ndf, masking, fresnel: term }.brdf(&angles, &setting)
                        }
                        Distribution::Stretched(ndf) => {
                            Anisotropic { ndf, masking, fresnel: term }.brdf(&angles, &setting)
                        }
                    };
                    assert_eq!(found.brdf(&angles, &setting), expected, "{ndf}, {name}, {fresnel}");
                }
            }
        }
    }
}
