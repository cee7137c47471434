// Conductor-like GGX with height-correlated Smith masking (Walter et al. 2007; Heitz 2014), Schlick's
// Fresnel, in forms that keep their digits in f32 and hold at the horizon.
const PI = 3.14159265;

fn brdf(wi: vec3f, wo: vec3f, alpha: f32, f0: f32) -> vec3f {
    let h = wi + wo;
    let h2 = dot(h, h);
    // tan²θm from the components of h: no 1 − cos².
    let t = dot(h.xy, h.xy) / alpha + alpha * h.z * h.z;
    let d = (h2 / t) * (h2 / t) / PI;
    let a2 = alpha * alpha;
    let lambda_i = wo.z * sqrt(a2 + (1.0 - a2) * wi.z * wi.z);
    let lambda_o = wi.z * sqrt(a2 + (1.0 - a2) * wo.z * wo.z);
    let c = 1.0 - clamp(0.5 * sqrt(h2), 0.0, 1.0);
    let c2 = c * c;
    let f = f0 + (1.0 - f0) * c2 * c2 * c;
    return vec3f(f * d * 0.5 / (lambda_i + lambda_o));
}
