// Hemispherical integrals by sampling: one invocation takes one direction, four α and one chunk of the
// samples, which it sums in blocks; the outer sum adds the chunks.

@group(0) @binding(2) var<storage, read> alphas: array<real4>; // padded to whole fours
@group(0) @binding(3) var<storage, read> mus: array<real>;

/// Two numbers that make a microfacet normal, for each α.
struct Draw {
    a: real4,
    b: real4,
}

const BLOCK = 32u;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    // What is beyond the end does the last one's work again, as for slopes.
    let invocation = min(job.first + id.x, job.end - 1u);
    let chunks = job.columns / arrayLength(&mus);
    let k = invocation % job.columns;
    let row = invocation / job.columns;
    let column = k / chunks;
    let chunk = k % chunks;
    let alpha = alphas[row];
    let mu = mus[column];
    let s = sqrt((1.0 - mu) * (1.0 + mu));
    let e = masked(mu, alpha);
    seed((4u * row + vec4u(0u, 1u, 2u, 3u)) * arrayLength(&mus) + column, chunk);
    var sum = Estimate();
    let first = chunk * job.azimuths;
    for (var block = first; block < first + job.azimuths; block += BLOCK) {
        var inner = Estimate();
        for (var j = block; j < min(block + BLOCK, first + job.azimuths); j++) {
            let drawn = draw(j);
            let value = facet_estimate(facet(drawn.a, drawn.b, e, s, alpha), e, s / mu);
            inner.all += value.all;
            inner.grazing += value.grazing;
        }
        sum.all += inner.all;
        sum.grazing += inner.grazing;
    }
    let rest = sum.all - sum.grazing;
    for (var j = 0u; j < min(4u, job.nodes - 4u * row); j++) {
        let mirror = real(job.azimuths) * mirror_limit(mu);
        let result = select(real2(rest[j], sum.grazing[j]), mirror, alpha[j] == 0.0);
        write((4u * row + j) * job.columns + k - job.base, result);
    }
}
