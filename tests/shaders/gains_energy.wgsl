// A Lambertian surface of albedo 1.001.
fn brdf(wi: vec3f, wo: vec3f) -> f32 {
    return 1.001 * 0.31830987;
}
