// The same in two multiply-adds: Karis 2013, "Real Shading in Unreal Engine 4"; Unreal Engine, BRDF.ush, D_GGX.
fn ndf(h: vec3f, alpha: f32) -> f32 {
    let noh = saturate(h.z);
    let a2 = alpha * alpha;
    let denominator = (noh * a2 - noh) * noh + 1.0;
    return a2 / (PI * denominator * denominator);
}
