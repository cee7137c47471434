// A vector is returned as a scalar.
fn brdf(wi: vec3f, wo: vec3f) -> f32 {
    return wi * wo;
}
