// Spheres in a uniform environment: a white furnace. Left halves scatter once; right halves are given
// back, by the table, what single scattering loses.

@group(0) @binding(0) var dfg: texture_2d<f32>;
@group(0) @binding(1) var bilinear: sampler;

override cell: f32; // pixels on a side of a sphere's cell
override columns: f32; // spheres in a row: roughness 0 … 1
override environment: f32; // radiance from everywhere

const radius = 0.45; // of a sphere, in cells
const samples = 512;
const tau = 6.2831853;

@vertex
fn cover(@builtin(vertex_index) k: u32) -> @builtin(position) vec4f {
    return vec4f(vec2f(vec2u(k & 1, k >> 1)) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn furnace(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    let place = pixel.xy / cell;
    let p = (fract(place) - 0.5) / radius;
    let r = length(p);
    let roughness = floor(place.x) / (columns - 1.0);
    let f0 = array(vec3f(1.0), vec3f(1.0, 0.78, 0.34), vec3f(0.04))[u32(place.y)]; // white, gold, plastic

    // μ of an orthographic view; the rim's last pixel takes the μ of its middle.
    let mu = sqrt(1.0 - pow(min(r, 1.0 - 0.5 / (radius * cell)), 2.0));
    var reflected = single_scattering(mu, roughness * roughness, f0);
    if p.x > 0.0 {
        reflected *= compensation(mu, roughness, f0);
    }
    let coverage = saturate((1.0 - r) * radius * cell + 0.5);
    return vec4f(environment * mix(vec3f(1.0), reflected, coverage), 1.0);
}

/// What multiple scattering adds, as a factor: 1 + F0 (1/E − 1), E = A + B (Turquin 2019).
fn compensation(mu: f32, roughness: f32, f0: vec3f) -> vec3f {
    // An axis on nodes has its first and last sample at u = 0 and u = 1, which are the centres of the first
    // and last texel. Mapping "sqrt" is value = u², so u = √μ.
    let u = vec2f(sqrt(mu), roughness);
    let size = vec2f(textureDimensions(dfg));
    let ab = textureSampleLevel(dfg, bilinear, (u * (size - 1.0) + 0.5) / size, 0.0).xy;
    return 1.0 + f0 * (1.0 / (ab.x + ab.y) - 1.0);
}

/// What GGX (Schlick's F from F0 to 1, height-correlated G2) reflects of a unit environment, without any
/// table: the mean of F G2/G1 over visible normals (Heitz 2018), drawn as Dupuy & Benyoub (2023) do.
fn single_scattering(mu: f32, alpha: f32, f0: vec3f) -> vec3f {
    let wo = vec3f(sqrt(1.0 - mu * mu), 0.0, mu);
    let stretched = normalize(vec3f(alpha * wo.xy, wo.z));
    var sum = vec3f(0.0);
    for (var k = 0; k < samples; k++) {
        let z = 1.0 - (1.0 + stretched.z) * (f32(k) + 0.5) / samples;
        let phi = tau * fract(f32(k) * 0.61803399); // a Fibonacci lattice
        let cap = vec3f(sqrt(1.0 - z * z) * vec2f(cos(phi), sin(phi)), z) + stretched;
        let wm = normalize(vec3f(alpha * cap.xy, cap.z));
        let cos_m = dot(wo, wm);
        let wi = 2.0 * cos_m * wm - wo;
        if wi.z > 0.0 {
            let g = half_smith(mu, alpha) / (half_smith(mu, alpha) + half_smith(wi.z, alpha) - 1.0);
            sum += g * mix(f0, vec3f(1.0), pow(saturate(1.0 - cos_m), 5.0));
        }
    }
    return sum / samples;
}

/// 1 + Λ of Smith's masking: G1 = 1/(1 + Λo), G2 = 1/(1 + Λo + Λi).
fn half_smith(mu: f32, alpha: f32) -> f32 {
    return 0.5 + 0.5 * sqrt(1.0 + alpha * alpha * (1.0 / (mu * mu) - 1.0));
}
