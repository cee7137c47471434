// D = (α / (1 − NoH² + (α NoH)²))² / π: Filament, surface_brdf.fs, D_GGX on desktops; Bevy, pbr_lighting.wgsl.
fn ndf(h: vec3f, alpha: f32) -> f32 {
    let noh = saturate(h.z);
    let a = noh * alpha;
    let k = alpha / (1.0 - noh * noh + a * a);
    return k * k / PI;
}
