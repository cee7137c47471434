// D·V of GGX with F = 1 and V = G2 / (4 μi μe), height-correlated Smith (Heitz 2014, eq. 99), as engines
// write it. One function `ndf` of this folder comes before it: the study compares these. The normal is
// +z exactly, so that n·h is a component: an arbitrary normal costs a rounding more.

const PI = 3.14159265;

fn brdf(wi: vec3f, wo: vec3f, alpha: f32) -> f32 {
    let a2 = alpha * alpha;
    let lambda_i = wo.z * sqrt(wi.z * wi.z * (1.0 - a2) + a2);
    let lambda_o = wi.z * sqrt(wo.z * wo.z * (1.0 - a2) + a2);
    return ndf(normalize(wi + wo), alpha) * 0.5 / (lambda_i + lambda_o);
}
