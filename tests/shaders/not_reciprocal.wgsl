// A factor of one direction alone: f(ωi, ωe) ≠ f(ωe, ωi).
fn brdf(wi: vec3f, wo: vec3f) -> f32 {
    return 0.3 * (0.9 + 0.1 * wi.z);
}
