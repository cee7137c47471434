//! No masking. Twin of `shaders/masking/none.wgsl`.

use crate::model::masking::{Masking, Toward};
use crate::model::ndf::Ndf;
use crate::model::parameters::Setting;
use crate::model::{Term, part};

pub(crate) struct Unmasked;

impl Masking for Unmasked {
    const TERM: Term = Term {
        name: "none",
        summary: "no masking, unbounded at grazing",
        source: "Torrance & Sparrow 1967 with G = 1",
        part: part!("masking/none"),
    };
    const UNBOUNDED: Option<&'static str> =
        Some("without masking ρ grows as α/μ at grazing, beyond any bound, and no tolerance holds there");

    fn visibility<N: Ndf>(i: &Toward, e: &Toward) -> f64 {
        0.25 / (i.mu * e.mu)
    }

    fn masking<N: Ndf>(x: f64, _y: f64, mu_e: f64, _s: &Setting) -> f64 {
        2.0 * mu_e * x
    }
}
