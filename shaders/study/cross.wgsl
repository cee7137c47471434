// The same with 1 − NoH² = |n × h|², Lagrange's identity: Filament, surface_brdf.fs, D_GGX on mobiles.
fn ndf(h: vec3f, alpha: f32) -> f32 {
    let n_cross_h = cross(vec3f(0.0, 0.0, 1.0), h);
    let a = saturate(h.z) * alpha;
    let k = alpha / (dot(n_cross_h, n_cross_h) + a * a);
    return k * k / PI;
}
