// The fourth line does not end.
fn brdf(wi: vec3f, wo: vec3f) -> f32 {
    let cosine = dot(wi, wo);
    return cosine +;
}
