// D = 1 / (π α² cos⁴θm (1 + tan²θm/α²)²), tan² = (1 − cos²)/cos²: Walter et al. 2007, eq. 33, as in pbrt-v4,
// util/scattering.h, TrowbridgeReitzDistribution::D.
fn ndf(h: vec3f, alpha: f32) -> f32 {
    let cos2 = h.z * h.z;
    let tan2 = max(0.0, 1.0 - cos2) / cos2;
    let e = 1.0 + tan2 / (alpha * alpha);
    return 1.0 / (PI * alpha * alpha * cos2 * cos2 * e * e);
}
