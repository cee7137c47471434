//! Smith's masking and shadowing as if independent: Walter et al. 2007, eq. 23. Twin of
//! `shaders/masking/smith_separable.wgsl`.

use crate::base::tolerance::is_fine;
use crate::model::masking::{Masking, MaskingCounts, Toward};
use crate::model::ndf::Ndf;
use crate::model::parameters::Setting;
use crate::model::{Term, part};

pub(crate) struct SmithSeparable;

impl Masking for SmithSeparable {
    const TERM: Term = Term {
        name: "smith-separable",
        summary: "separable Smith",
        source: "Walter et al. 2007, eq. 23",
        part: part!("masking/smith_separable"),
    };

    /// More on the near side: for μ ≪ α its G2 bends where G1(ωi) does, which correlated heights wash out by
    /// Λ(ωe). Measured: an eighth more leaves 1.1 times 1e-6.
    const COUNTS: Option<MaskingCounts> =
        Some(|[near, far], tolerance| [if is_fine(tolerance) { near } else { near.more(1.25) }, far]);
    const SPREADS: bool = true;

    fn visibility<N: Ndf>(i: &Toward, e: &Toward) -> f64 {
        1.0 / ((i.mu + N::smith_root(i.mu, &i.setting)) * (e.mu + N::smith_root(e.mu, &e.setting)))
    }

    fn masking<N: Ndf>(x: f64, y: f64, mu_e: f64, s: &Setting) -> f64 {
        let inverse_g1 = 0.5 + 0.5 * N::smith_root(mu_e, s) / mu_e;
        inverse_g1 * (x * mu_e + N::smith_root_at(x, y, mu_e, s))
    }
}
