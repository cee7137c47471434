// Values of a BRDF over (roughness, θi, θe, δφ): no trigonometry, wide stores. Rows are padded to whole quads
// of azimuths. An invocation takes four rows and of their quads every eighth. It reads rows, weights and
// counts once and first: after a store, software drivers read whatever it was again. The quads of a dispatch
// are a window that fits a uniform buffer, which they read at half the price of storage.

struct Quad {
    sin2: real4, // sin²(δ/2)
    cos2: real4, // cos²(δ/2)
    back: real4, // max(0, −cos δ)
    cp: real4,   // (cos φi ± cos φe)/2, (sin φi ± sin φe)/2
    cm: real4,
    sp: real4,
    sm: real4,
}

struct Azimuths {
    a: Azimuth,
    b: Azimuth,
    c: Azimuth,
    d: Azimuth,
}

/// A row as the host gives it: its place in the output, and what its values are multiplied with.
struct Given {
    pair: Pair,
    place: real,
    scale: real,
}

/// A row, and where it is stored.
struct Row {
    pair: Pair,
    scale: real,
    lobe: real,
    first: u32,
    is_there: bool,
}

@group(0) @binding(1) var<storage, read_write> values: array<vec4f>;
@group(0) @binding(2) var<storage, read> rows: array<Given>;
@group(0) @binding(3) var<uniform> quads: array<Quad, WINDOW>;

const LANES = 8u;

@compute @workgroup_size(LANES, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let first = job.first + 4u * id.y;
    let row0 = row_at(first);
    let row1 = row_at(first + 1u);
    let row2 = row_at(first + 2u);
    let row3 = row_at(first + 3u);
    let w = weights();
    let columns = job.columns;
    for (var quad = id.x; quad < columns; quad += LANES) {
        let z = quads[quad];
        evaluate(row0, quad, z, w);
        evaluate(row1, quad, z, w);
        evaluate(row2, quad, z, w);
        evaluate(row3, quad, z, w);
    }
}

/// What is beyond the end does the last one over again: cheaper than a mask on every store.
fn row_at(row: u32) -> Row {
    let there = min(row, job.end - 1u);
    let given = rows[there];
    let pair = given.pair;
    let first = (u32(given.place) * job.azimuths + job.nodes) * CHANNELS;
    return Row(pair, given.scale, lobe_row(pair, pair.own), first, there == row);
}

fn evaluate(row: Row, quad: u32, z: Quad, w: Weights) {
    if ADD && !row.is_there {
        return;
    }
    let z4 = azimuths_of(z);
    let a0 = lobe(row.pair, z4.a, row.pair.own, row.lobe);
    let a1 = lobe(row.pair, z4.b, row.pair.own, row.lobe);
    let a2 = lobe(row.pair, z4.c, row.pair.own, row.lobe);
    let a3 = lobe(row.pair, z4.d, row.pair.own, row.lobe);
    // What the row is multiplied with is the weights' to bear: 1 changes no bit.
    let s = row.scale;
    store(row.first + quad * CHANNELS, Weights(s * w.r, s * w.g, s * w.b), a0, a1, a2, a3);
}

fn azimuths_of(z: Quad) -> Azimuths {
    return Azimuths(
        Azimuth(z.sin2.x, z.cos2.x, z.back.x, 0.0, 0.0, z.cp.x, z.cm.x, z.sp.x, z.sm.x),
        Azimuth(z.sin2.y, z.cos2.y, z.back.y, 0.0, 0.0, z.cp.y, z.cm.y, z.sp.y, z.sm.y),
        Azimuth(z.sin2.z, z.cos2.z, z.back.z, 0.0, 0.0, z.cp.z, z.cm.z, z.sp.z, z.sm.z),
        Azimuth(z.sin2.w, z.cos2.w, z.back.w, 0.0, 0.0, z.cp.w, z.cm.w, z.sp.w, z.sm.w),
    );
}

fn put(at: u32, v: vec4f) {
    if ADD {
        values[at] += v;
    } else {
        values[at] = v;
    }
}
