// A white Lambertian surface.
fn brdf(wi: vec3f, wo: vec3f) -> f32 {
    return 0.31830987;
}
