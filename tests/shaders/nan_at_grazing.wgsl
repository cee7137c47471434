// NaN at θi = 90° and at θe = 90°, and nowhere else: the normal of a vector of length 0.
fn brdf(wi: vec3f, wo: vec3f) -> f32 {
    return 0.2 + 0.01 * normalize(vec2f(wi.z, 0.0)).x * normalize(vec2f(wo.z, 0.0)).x;
}
