// The outer sum of an integral: each texel is a weighted sum of job.nodes raw results, in blocks,
// turned into channels. Of job.columns texels each may have weights of its own.

@group(0) @binding(2) var<storage, read> outer: array<real>;
@group(0) @binding(3) var<storage, read> raw: array<real2>;

const BLOCK = 32u;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let texel = job.first + id.x;
    if texel >= job.end {
        return;
    }
    let weights = texel % job.columns * job.nodes;
    var sum = real2();
    for (var block = 0u; block < job.nodes; block += BLOCK) {
        var inner = real2();
        for (var k = block; k < min(block + BLOCK, job.nodes); k++) {
            inner += outer[weights + k] * raw[(texel - job.base) * job.nodes + k];
        }
        sum += inner;
    }
    write(texel - job.base, sum);
}
