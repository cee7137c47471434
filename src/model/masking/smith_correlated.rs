//! Smith's masking-shadowing at correlated heights: Heitz 2014, eq. 99. Twin of
//! `shaders/masking/smith_correlated.wgsl`.

use crate::model::masking::{Masking, MaskingCounts, Toward};
use crate::model::ndf::Ndf;
use crate::model::parameters::Setting;
use crate::model::{Term, part};

pub(crate) struct SmithCorrelated;

impl Masking for SmithCorrelated {
    const TERM: Term = Term {
        name: "smith-correlated",
        summary: "height-correlated Smith",
        source: "Heitz 2014, eq. 99",
        part: part!("masking/smith_correlated"),
    };
    const COUNTS: Option<MaskingCounts> = Some(|correlated, _| correlated);
    const SPREADS: bool = true;

    fn visibility<N: Ndf>(i: &Toward, e: &Toward) -> f64 {
        0.5 / (i.mu * N::smith_root(e.mu, &e.setting) + e.mu * N::smith_root(i.mu, &i.setting))
    }

    fn masking<N: Ndf>(x: f64, y: f64, mu_e: f64, s: &Setting) -> f64 {
        x * N::smith_root(mu_e, s) + N::smith_root_at(x, y, mu_e, s)
    }
}
