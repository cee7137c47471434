// Below zero where both directions graze.
fn brdf(wi: vec3f, wo: vec3f) -> vec3f {
    let lobe = 0.2 * wi.z * wo.z - 0.0001;
    return vec3f(0.1, lobe, 0.2);
}
