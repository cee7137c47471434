// D = α² / (π (NoH² (α² − 1) + 1)²): Karis 2013, "Specular BRDF Reference"; three.js, lights_physical, D_GGX.
// At NoH = 1 and α < 2.4e-4 the denominator is 0 as written. Mesa reads mix(1, α², NoH²) into it and computes
// 1 − NoH² + α² NoH², which is not.
fn ndf(h: vec3f, alpha: f32) -> f32 {
    let noh = saturate(h.z);
    let a2 = alpha * alpha;
    let denominator = noh * noh * (a2 - 1.0) + 1.0;
    return a2 / (PI * denominator * denominator);
}
