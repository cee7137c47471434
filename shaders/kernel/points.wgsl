// Values of a BRDF at a list of pairs of directions, all of one α: one invocation a point.

@group(0) @binding(2) var<storage, read> points: array<Point>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if ADD && id.x >= job.end {
        return;
    }
    // What is beyond the end does the last one over again: cheaper than a mask on every store.
    let point = min(id.x, job.end - 1u);
    let p = points[point];
    let pair = pair_of(p);
    write(job.base + point, p.weight * lobe(pair, azimuth_of(p), job.alpha_or_bound, lobe_row(pair, job.alpha_or_bound)));
}
