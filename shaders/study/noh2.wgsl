// D = α² / (π (NoH² (α² − 1) + 1)²): Karis 2013, "Specular BRDF Reference"; three.js, lights_physical,
// D_GGX; in another order of operations Unreal Engine, BRDF.ush, D_GGX.
fn ndf(h: vec3f, alpha: f32) -> f32 {
    let noh = saturate(h.z);
    let a2 = alpha * alpha;
    let denominator = noh * noh * (a2 - 1.0) + 1.0;
    return a2 / (PI * denominator * denominator);
}
