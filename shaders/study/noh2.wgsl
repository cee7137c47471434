// D = α² / (π (NoH² (α² − 1) + 1)²): Karis 2013, "Specular BRDF Reference"; three.js, lights_physical, D_GGX.
// As written the denominator is 0 at NoH = 1 and α < 2.4e-4. On lavapipe it is that of 1 − NoH² + α² NoH², so that
// the driver seems to take it for mix(1, α², NoH²); do not count on that.
fn ndf(h: vec3f, alpha: f32) -> f32 {
    let noh = saturate(h.z);
    let a2 = alpha * alpha;
    let denominator = noh * noh * (a2 - 1.0) + 1.0;
    return a2 / (PI * denominator * denominator);
}
