// Hemispherical integrals by directions that the host found: one invocation a result, which sums its own in
// blocks of blocks, so that rounding grows with the cube root of their number.
// Some drivers stop long loops: `src/backend/gpu/loop_limit.rs` counts these before they are run.

@group(0) @binding(2) var<storage, read> alphas: array<real>;
@group(0) @binding(3) var<storage, read> ranges: array<vec2u>; // of each result's points
@group(0) @binding(4) var<storage, read> limits: array<real2>; // what has none is in closed form
@group(0) @binding(5) var<storage, read> points: array<Point>;

const BLOCK = 32u;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    // What is beyond the end does the last one's work again: an early return would make software
    // drivers mask every instruction.
    let invocation = min(job.first + id.x, job.end - 1u);
    let alpha = alphas[invocation / job.columns];
    let range = ranges[invocation - job.first];
    var sum = limits[invocation - job.first];
    for (var outer = range.x; outer < range.y; outer += BLOCK * BLOCK) {
        var middle = real2();
        let end = min(outer + BLOCK * BLOCK, range.y);
        for (var block = outer; block < end; block += BLOCK) {
            var inner = real2();
            for (var k = block; k < min(block + BLOCK, end); k++) {
                let point = points[k];
                let pair = pair_of(point);
                inner += point.weight * lobe(pair, azimuth_of(point), alpha, lobe_row(pair, alpha));
            }
            middle += inner;
        }
        sum += middle;
    }
    write(invocation - job.base, sum);
}
