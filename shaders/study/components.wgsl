// D = 1 / (π α² ((h.x² + h.y²)/α² + h.z²)²): Burley 2012, appendix B; Mitsuba 3, microfacet.h, eval.
fn ndf(h: vec3f, alpha: f32) -> f32 {
    let x = h.x / alpha;
    let y = h.y / alpha;
    let e = x * x + y * y + h.z * h.z;
    return 1.0 / (PI * alpha * alpha * e * e);
}
