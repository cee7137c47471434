//! Schlick's approximation of the Fresnel reflectance.

/// Schlick 1994, eq. 15: F = F0 + (1 − F0) Fc with Fc = (1 − ωi·ωm)⁵; `one_minus_cos_d` is 1 − ωi·ωm.
pub(in crate::reference) fn fc(one_minus_cos_d: f64) -> f64 {
    one_minus_cos_d.powi(5)
}

/// What F0 and F90 weigh: [1 − Fc, Fc].
///
/// With c = ωi·ωm and x = 1 − c, both given: 1 − x⁵ = c (1 + x + x² + x³ + x⁴), which keeps its digits where
/// the half vector grazes.
pub(in crate::reference) fn weights(cos_d: f64, one_minus_cos_d: f64) -> [f64; 2] {
    let x = one_minus_cos_d;
    [cos_d * (1.0 + x * (1.0 + x * (1.0 + x * (1.0 + x)))), fc(x)]
}
