// Brushed along x.
fn brdf(wi: vec3f, wo: vec3f) -> f32 {
    return 0.2 + 0.02 * wi.x * wo.x;
}
