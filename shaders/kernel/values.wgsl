// Values of a BRDF over (roughness, θi, θe, δφ): four azimuths an invocation, no trigonometry, wide
// stores. Rows are padded to whole quads.

@group(0) @binding(1) var<storage, read> alphas: array<real>;
@group(0) @binding(2) var<storage, read> pairs: array<Pair>;
@group(0) @binding(3) var<storage, read> azimuths: array<Azimuth>;
@group(0) @binding(4) var<storage, read_write> values: array<vec4f>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let invocation = job.first + id.x;
    if invocation >= job.end {
        return;
    }
    let quads = (job.azimuths + 3u) / 4u;
    let row = invocation / quads;
    let quad = invocation % quads;
    let pair = pairs[row % job.columns];
    let alpha = alphas[row / job.columns];
    let last = job.azimuths - 1u;
    let a0 = lobe(pair, azimuths[4u * quad], alpha);
    let a1 = lobe(pair, azimuths[min(4u * quad + 1u, last)], alpha);
    let a2 = lobe(pair, azimuths[min(4u * quad + 2u, last)], alpha);
    let a3 = lobe(pair, azimuths[min(4u * quad + 3u, last)], alpha);
    store((invocation - job.base) * CHANNELS, a0, a1, a2, a3);
}

fn put(at: u32, v: vec4f) {
    if job.accumulate == 1u {
        values[at] += v;
    } else {
        values[at] = v;
    }
}
