// D of tan θm with θm = acos(n·h): the half angle of Rusinkiewicz 1998, as readers of measured tables (MERL's
// BRDFRead.cpp, std_coords_to_half_diff_coords) have it.
fn ndf(h: vec3f, alpha: f32) -> f32 {
    let theta = acos(saturate(h.z));
    let cosine = cos(theta);
    let t = tan(theta) / alpha;
    let e = alpha * cosine * cosine * (1.0 + t * t);
    return 1.0 / (PI * e * e);
}
