// Values of a BRDF at a list of pairs of directions, all of one α: one invocation a point.

struct Point {
    hz2: real,  // the factors of a Pair
    dt2: real,
    ss: real,
    sd: real,
    mu_i: real,
    mu_e: real,
    sin2: real, // and of an Azimuth
    cos2: real,
    back: real,
}

@group(0) @binding(2) var<storage, read> points: array<Point>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if ADD && id.x >= job.end {
        return;
    }
    // What is beyond the end does the last one over again: cheaper than a mask on every store.
    let point = min(id.x, job.end - 1u);
    let p = points[point];
    let pair = Pair(p.hz2, p.dt2, p.ss, p.sd, p.mu_i, p.mu_e, 0.0, 0.0);
    let azimuth = Azimuth(p.sin2, p.cos2, p.back, 0.0, 0.0);
    write(job.base + point, lobe(pair, azimuth, job.alpha, lobe_row(pair, job.alpha)));
}
