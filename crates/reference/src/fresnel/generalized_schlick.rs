//! Schlick's approximation with an exponent of choice.

use crate::fresnel::Fresnel;
use crate::setting::Parameters;

/// MaterialX's generalized_schlick_bsdf: F = mix(color0, color90, (1 − ωi·ωm)^exponent).
pub(crate) struct GeneralizedSchlick;

impl Fresnel for GeneralizedSchlick {
    fn weights(&self, cos_d: f64, one_minus_cos_d: f64, p: &Parameters) -> [f64; 2] {
        // From the one that is not lost in 1.
        let log = if cos_d < 0.5 { (-cos_d).ln_1p() } else { one_minus_cos_d.ln() };
        let power = p.exponent * log;
        [-power.exp_m1(), power.exp()]
    }

    /// 2 ∫ (1 − μ)ᵖ μ dμ = 2/((p + 1)(p + 2)).
    fn mean(&self, p: &Parameters) -> [f64; 2] {
        let grazing = 2.0 / ((p.exponent + 1.0) * (p.exponent + 2.0));
        [1.0 - grazing, grazing]
    }
}
