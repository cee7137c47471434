//! What a function's vectors and cosines mean, by the names that engines give them.

use crate::base::error::{Error, Result};
use std::fmt;
use std::str::FromStr;

/// A vector of the local frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum FrameVector {
    /// ωi, towards the light.
    Light,
    /// ωo, towards the eye.
    View,
    /// The shading normal.
    Normal,
    /// The direction half-way between light and view.
    Half,
    Tangent,
    Bitangent,
    /// The view reflected by the normal.
    Reflection,
}

use FrameVector::*;

/// What an argument is, if it is no parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Role {
    pub kind: RoleKind,
    /// Whether it has the opposite sign, such as a direction from the light.
    pub negative: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RoleKind {
    Vector(FrameVector),
    /// The cosine of the angle between two of them.
    Cosine(FrameVector, FrameVector),
}

const LETTERS: [(FrameVector, &str); 7] = [
    (Light, "l"),
    (View, "v"),
    (Normal, "n"),
    (Half, "h"),
    (Tangent, "t"),
    (Bitangent, "b"),
    (Reflection, "r"),
];

/// Names of vectors, in lower case without underscores.
const NAMES: [(FrameVector, &[&str]); 7] = [
    (
        Light,
        &[
            "l",
            "wi",
            "light",
            "lightdir",
            "lightdirection",
            "lightvec",
            "lightvector",
            "tolight",
            "ldir",
            "dirtolight",
            "directiontolight",
            "surfacetolight",
            "omegai",
            "wl",
            "incoming",
            "incident",
            "indir",
            "wip",
            "wilocal",
        ],
    ),
    (
        View,
        &[
            "v",
            "wo",
            "view",
            "viewdir",
            "viewdirection",
            "viewvec",
            "viewvector",
            "toview",
            "toeye",
            "tocamera",
            "eye",
            "eyedir",
            "eyevec",
            "vdir",
            "omegao",
            "wv",
            "outgoing",
            "outdir",
            "geometryviewdir",
            "surfacetoview",
            "wop",
            "surfacetocamera",
            "wolocal",
        ],
    ),
    (
        Normal,
        &[
            "n",
            "normal",
            "nrm",
            "norm",
            "ns",
            "ng",
            "geometrynormal",
            "shadingnormal",
            "surfacenormal",
            "worldnormal",
            "normaldir",
            "normaldirection",
            "normalws",
            "nws",
            "ndir",
        ],
    ),
    (
        Half,
        &[
            "h",
            "half",
            "halfvec",
            "halfvector",
            "halfdir",
            "halfway",
            "halfwaydir",
            "halfwayvector",
            "halfwayvec",
            "wh",
            "wm",
            "hdir",
            "microfacetnormal",
            "halfdirection",
            "hv",
        ],
    ),
    (Tangent, &["t", "x", "tangent", "tangentdir", "tangentws", "anisotropict", "anisotropytangent", "wx"]),
    (
        Bitangent,
        &["b", "y", "bitangent", "binormal", "bitangentdir", "anisotropicb", "anisotropybitangent", "wy"],
    ),
    (Reflection, &["r", "refl", "reflected", "reflection", "reflectdir", "refldir", "reflectiondir"]),
];

/// Names of cosines that do not spell both vectors.
const COSINES: [(FrameVector, FrameVector, &[&str]); 4] = [
    (Normal, Light, &["costhetai", "cosi", "costhetal", "mui", "costhetain", "cosnl", "cosl"]),
    (Normal, View, &["costhetao", "coso", "costhetav", "muo", "costhetaout", "cosnv", "cosv"]),
    (Normal, Half, &["costhetah", "cosh", "costhetam", "cosnh", "cosm"]),
    (Light, Half, &["costhetad", "cosd", "coslh", "cosvh", "costhetalh"]),
];

/// Names of directions from the light to the surface, which PlayCanvas has.
const FROM_LIGHT: [&str; 4] = ["lightdirnorm", "lightdirnormw", "fromlight", "lighttosurface"];

/// The role of a vector, by its name.
pub(super) fn vector(name: &str) -> Option<Role> {
    // Lower-case x, y, and r are numbers more often than axes.
    if matches!(name, "x" | "y") {
        return None;
    }
    let name = plain(name);
    if FROM_LIGHT.contains(&name.as_str()) {
        return Some(Role { kind: RoleKind::Vector(Light), negative: true });
    }
    let found = NAMES.iter().find(|(_, names)| names.contains(&name.as_str()));
    found.map(|&(vector, _)| RoleKind::Vector(vector).into())
}

/// The role of a scalar, by its name: `NdotL`, `n_dot_l`, `NoL`, `dotNL`, `cos_theta_i`.
pub(super) fn cosine(name: &str) -> Option<(FrameVector, FrameVector)> {
    let name = plain(name);
    let named = COSINES.iter().find(|(_, _, names)| names.contains(&name.as_str()));
    if let Some(&(a, b, _)) = named {
        return Some((a, b));
    }
    let mut bare = name.as_str();
    for word in ["clamped", "saturated", "abs", "sat", "unclamped", "raw"] {
        bare = bare.strip_suffix(word).or(bare.strip_prefix(word)).unwrap_or(bare);
    }
    // Both letters, around or behind the product.
    let pair = match bare.strip_prefix("dot") {
        Some(pair) => pair.to_owned(),
        None => match bare.split_once("dot").or(bare.split_once('o')) {
            Some((a, b)) => format!("{a}{b}"),
            // `nl`, but not `lt` or `bl`.
            None => Some(bare).filter(|pair| ["nl", "nv", "nh", "lh", "vh", "lv"].contains(pair))?.to_owned(),
        },
    };
    let letter = |c: char| match c {
        'x' => Some(Tangent),
        'y' => Some(Bitangent),
        _ => LETTERS.iter().find(|(_, letter)| letter.starts_with(c)).map(|&(vector, _)| vector),
    };
    let letters: Vec<_> = pair.chars().map(letter).collect::<Option<_>>()?;
    match letters[..] {
        [a, b] if a != b && a != Reflection && b != Reflection => Some((a, b)),
        _ => None,
    }
}

/// Whether a function's name says that it is a term of a BRDF: `V_SmithGGX`, `G1`, `ggxShadowMaskG2`.
pub(super) fn is_term(name: &str) -> bool {
    let letter = ["D_", "F_", "G_", "V_", "G1", "G2"].iter().any(|start| name.starts_with(start));
    let name = plain(name);
    let word =
        ["visibility", "mask", "fresnel", "distribution", "geometry", "schlick", "lambda", "pdf", "sample"];
    letter || word.iter().any(|word| name.contains(word)) || name.ends_with("g1") || name.ends_with("g2")
}

fn plain(name: &str) -> String {
    name.chars().filter(|&c| c != '_').flat_map(char::to_lowercase).collect()
}

/// Parses `L`, `-L`, `N`, `wi`, `NdotL`, …
impl FromStr for Role {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let (negative, name) = match text.strip_prefix('-') {
            Some(name) => (true, name),
            None => (false, text),
        };
        let kind = match name {
            "X" | "x" => Some(RoleKind::Vector(Tangent)),
            "Y" | "y" => Some(RoleKind::Vector(Bitangent)),
            _ => vector(name).map(|role| role.kind).or(cosine(name).map(|(a, b)| RoleKind::Cosine(a, b))),
        };
        let kind = kind.ok_or_else(|| {
            Error::input(format!(
                "\"{text}\" is no role; the vectors are L, V, N, H, T, B and R, the cosines are written as NdotL, and what \
                 points the other way as -L"
            ))
        })?;
        Ok(Self { kind, negative })
    }
}

impl From<RoleKind> for Role {
    fn from(kind: RoleKind) -> Self {
        Self { kind, negative: false }
    }
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let letter = |vector| LETTERS.iter().find(|(v, _)| *v == vector).map_or("", |&(_, letter)| letter);
        let sign = if self.negative { "-" } else { "" };
        match self.kind {
            RoleKind::Vector(vector) => write!(f, "{sign}{}", word(vector)),
            RoleKind::Cosine(a, b) => {
                write!(f, "{sign}{}dot{}", letter(a).to_uppercase(), letter(b).to_uppercase())
            }
        }
    }
}

/// A vector's name in messages.
fn word(vector: FrameVector) -> &'static str {
    match vector {
        Light => "wi",
        View => "wo",
        Normal => "normal",
        Half => "half vector",
        Tangent => "tangent",
        Bitangent => "bitangent",
        Reflection => "reflection of wo",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_engines_are_known() {
        for (name, role) in [
            ("L", Light),
            ("light_dir", Light),
            ("toEye", View),
            ("viewDirection", View),
            ("N", Normal),
            ("half_vector", Half),
            ("X", Tangent),
            ("binormal", Bitangent),
            ("R", Reflection),
        ] {
            assert_eq!(vector(name), Some(RoleKind::Vector(role).into()), "{name}");
        }
        for name in ["x", "base_color", "f0", "direction", "position"] {
            assert_eq!(vector(name), None, "{name}");
        }
        for (name, a, b) in [
            ("NdotL", Normal, Light),
            ("NoV", Normal, View),
            ("n_dot_h", Normal, Half),
            ("dotNL", Normal, Light),
            ("cos_theta_i", Normal, Light),
            ("VdotH", View, Half),
            ("LoH", Light, Half),
            ("nl", Normal, Light),
            ("NdotLClamped", Normal, Light),
            ("XdotH", Tangent, Half),
            ("dot_n_v", Normal, View),
        ] {
            assert_eq!(cosine(name), Some((a, b)), "{name}");
        }
        for name in
            ["roughness", "alpha", "f0", "ior", "lt", "at", "ax", "ay", "no", "o", "dot", "tot", "cosine"]
        {
            assert_eq!(cosine(name), None, "{name}");
        }
        for (text, said) in [("-L", "-wi"), ("VdotN", "VdotN"), ("x", "tangent")] {
            assert_eq!(text.parse::<Role>().unwrap().to_string(), said);
        }
        assert!("sideways".parse::<Role>().is_err());
    }
}
