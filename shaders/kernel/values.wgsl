// Values of a BRDF over (roughness, θi, θe, δφ): no trigonometry, wide stores. Rows are padded to whole quads
// of azimuths. An invocation takes four rows and of their quads every eighth. It reads rows, weights and
// counts once and first: after a store, software drivers read whatever it was again. The quads of a dispatch
// are a window that fits a uniform buffer, which they read at half the price of storage; each factor lies by itself,
// so that what a lobe does not take is not read.

struct Quads {
    sin2: array<real4, WINDOW>, // sin²(δ/2)
    cos2: array<real4, WINDOW>, // cos²(δ/2)
    back: array<real4, WINDOW>, // max(0, −cos δ)
    cp: array<real4, WINDOW>,   // (cos φi ± cos φe)/2, (sin φi ± sin φe)/2
    cm: array<real4, WINDOW>,
    sp: array<real4, WINDOW>,
    sm: array<real4, WINDOW>,
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

@group(0) @binding(2) var<storage, read> rows: array<Given>;
@group(0) @binding(3) var<uniform> quads: Quads;

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
        let z = azimuths_of(quad);
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
    return Row(pair, given.scale, lobe_row(pair, pair.alpha_or_weight), first, there == row);
}

fn evaluate(row: Row, quad: u32, z: Azimuths, w: Weights) {
    if ADD && !row.is_there {
        return;
    }
    let a0 = lobe(row.pair, z.a, row.pair.alpha_or_weight, row.lobe);
    let a1 = lobe(row.pair, z.b, row.pair.alpha_or_weight, row.lobe);
    let a2 = lobe(row.pair, z.c, row.pair.alpha_or_weight, row.lobe);
    let a3 = lobe(row.pair, z.d, row.pair.alpha_or_weight, row.lobe);
    let at = row.first + quad * CHANNELS;
    if SCALED {
        // What the row is multiplied with is the weights' to bear: 1 changes no bit.
        let s = row.scale;
        store(at, Weights(s * w.r, s * w.g, s * w.b), a0, a1, a2, a3);
    } else {
        store(at, w, a0, a1, a2, a3);
    }
}

fn azimuths_of(quad: u32) -> Azimuths {
    let sin2 = quads.sin2[quad];
    let cos2 = quads.cos2[quad];
    let back = quads.back[quad];
    let cp = quads.cp[quad];
    let cm = quads.cm[quad];
    let sp = quads.sp[quad];
    let sm = quads.sm[quad];
    return Azimuths(
        Azimuth(sin2.x, cos2.x, back.x, 0.0, 0.0, cp.x, cm.x, sp.x, sm.x),
        Azimuth(sin2.y, cos2.y, back.y, 0.0, 0.0, cp.y, cm.y, sp.y, sm.y),
        Azimuth(sin2.z, cos2.z, back.z, 0.0, 0.0, cp.z, cm.z, sp.z, sm.z),
        Azimuth(sin2.w, cos2.w, back.w, 0.0, 0.0, cp.w, cm.w, sp.w, sm.w),
    );
}
