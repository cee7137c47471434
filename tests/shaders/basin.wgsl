// Not reciprocal by more than 5e-5 in a region of 1e-3 rad around one triple of angles only, and by less
// the further from it: points that fill the cube miss it, what climbs does not.
fn brdf(wi: vec3f, wo: vec3f) -> f32 {
    let away = vec3f(wi.z, wo.z, dot(wi, wo)) - vec3f(0.7311, 0.4677, 0.6123);
    let width = 1e-6;
    return 0.3 - 3e-3 * width / (width + length(away));
}
