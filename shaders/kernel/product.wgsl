// Hemispherical integrals over (θe, δφ), whatever the nodes: one invocation a (roughness, θi, θe),
// which sums the azimuths in blocks, so that rounding grows with the root of their number.
// Some drivers stop long loops: `src/backend/gpu/loop_limit.rs` counts these before they are run.

/// A Pair without what tells azimuths from each other: models that do are not integrated so.
struct Plain {
    hz2: real,
    dt2: real,
    ss: real,
    sd: real,
    mu_i: real,
    mu_e: real,
    bin: real,
    alpha_or_weight: real,
}

@group(0) @binding(2) var<storage, read> alphas: array<real>;
@group(0) @binding(3) var<storage, read> pairs: array<Plain>;
@group(0) @binding(4) var<storage, read> azimuths: array<Azimuth>;

const BLOCK = 32u;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    // What is beyond the end does the last one's work again: an early return would make software
    // drivers mask every instruction.
    let invocation = min(job.first + id.x, job.end - 1u);
    let p = pairs[invocation % job.columns];
    let pair = Pair(p.hz2, p.dt2, p.ss, p.sd, p.mu_i, p.mu_e, p.bin, p.alpha_or_weight, 0.0, 0.0);
    let alpha = alphas[invocation / job.columns];
    let row = lobe_row(pair, alpha);
    var sum = real2();
    for (var block = 0u; block < job.azimuths; block += BLOCK) {
        var inner = real2();
        for (var k = block; k < min(block + BLOCK, job.azimuths); k++) {
            let azimuth = azimuths[k];
            inner += azimuth.weight * lobe(pair, azimuth, alpha, row);
        }
        sum += inner;
    }
    write(invocation - job.base, pair.alpha_or_weight * sum);
}
