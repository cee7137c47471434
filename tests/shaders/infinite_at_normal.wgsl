// Infinite where both directions are the normal.
fn brdf(wi: vec3f, wo: vec3f) -> f32 {
    return 0.001 / (1.0 - wi.z * wo.z);
}
