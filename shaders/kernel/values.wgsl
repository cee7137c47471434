// Values of a BRDF over (roughness, θi, θe, δφ): four azimuths an invocation, no trigonometry, wide
// stores. Rows are padded to whole quads. A workgroup stays in one row, which software drivers then read once
// for all their lanes; the quads of a dispatch are a window that fits a uniform buffer, which they read at
// half the price of storage.

struct Quad {
    sin2: real4, // sin²(δ/2)
    cos2: real4, // cos²(δ/2)
}

@group(0) @binding(1) var<storage, read_write> values: array<vec4f>;
@group(0) @binding(2) var<storage, read> rows: array<Pair>;
@group(0) @binding(3) var<uniform> quads: array<Quad, WINDOW>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if ADD && id.x >= job.columns {
        return;
    }
    // What is beyond the end does the last one over again: cheaper than a mask on every store.
    let quad = min(id.x, job.columns - 1u);
    let row = job.first + id.y;
    let pair = rows[row];
    let z = quads[quad];
    let a0 = lobe(pair, Azimuth(z.sin2.x, z.cos2.x, 0.0, 0.0), pair.alpha);
    let a1 = lobe(pair, Azimuth(z.sin2.y, z.cos2.y, 0.0, 0.0), pair.alpha);
    let a2 = lobe(pair, Azimuth(z.sin2.z, z.cos2.z, 0.0, 0.0), pair.alpha);
    let a3 = lobe(pair, Azimuth(z.sin2.w, z.cos2.w, 0.0, 0.0), pair.alpha);
    store((row * job.azimuths + job.nodes + quad) * CHANNELS, a0, a1, a2, a3);
}

fn put(at: u32, v: vec4f) {
    if ADD {
        values[at] += v;
    } else {
        values[at] = v;
    }
}
