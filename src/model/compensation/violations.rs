//! What factors are known to break, for the verifier.

use super::{Factor, RESTORED_BOUND};
use crate::model::Violation;

impl Factor {
    /// What it is known to break: a factor of the view alone is not reciprocal.
    pub(crate) fn violations(&self) -> Vec<Violation> {
        let reciprocity = |bound, source| Violation { property: "reciprocity", bound, source };
        match self {
            Self::Missing { .. } | Self::BelowSheen { .. } => Vec::new(),
            Self::Restored { f0, .. } if *f0 == 0.0 => Vec::new(),
            Self::Restored { .. } => vec![
                reciprocity(RESTORED_DIFFERENCE, "Turquin 2019: its factor is of the view direction alone"),
                Violation {
                    property: "energy",
                    bound: RESTORED_BOUND,
                    source: "Turquin 2019: it balances what reaches a view, not what leaves a direction of incidence",
                },
            ],
            Self::Coat { weight } | Self::BelowCoat { weight } if *weight == 0.0 => Vec::new(),
            Self::Coat { .. } | Self::BelowCoat { .. } => {
                vec![reciprocity(
                    1.0,
                    "KHR_materials_clearcoat: its Fresnel term is of the view direction alone",
                )]
            }
        }
    }
}

/// f of a restored lobe against f of the exchanged directions, relative to the larger, at most: E of GGX with F = 1 is
/// 1 − ln 2 or more, and 1 or less.
const RESTORED_DIFFERENCE: f64 = 0.7;
