// The outer sums of integrals: a matrix times raw results, transposed,
//     out[c, u] = Σ M[c, n] raw[u, n].
// One row of weights makes each texel the sum of its own results. Two matrices, one after the other, spread
// results at the sources of both axes over a table. One invocation makes 4 × 4 of them, in blocks.
// Some drivers stop long loops: `src/backend/gpu/loop_limit.rs` counts these before they are run.

@group(0) @binding(2) var<storage, read> matrix: array<real4>; // of each four rows, column after column; padded by 0
@group(0) @binding(3) var<storage, read> raw: array<real2>;

const BLOCK = 32u;

/// Four rows of M times four of raw: the components A and B.
struct Sums {
    a: mat4x4<real>,
    b: mat4x4<real>,
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let invocation = job.first + id.x;
    if invocation >= job.end {
        return;
    }
    // 0 is added, so that drivers do not know that all invocations take as many turns: lavapipe 22.3 would run such a
    // loop on to its limit of 65,535, masked, for a millisecond.
    let n = job.nodes + (invocation >> 31u);
    let fours = invocation / job.tiles;
    let c = 4u * fours;
    let u = 4u * (invocation - fours * job.tiles);
    let last = job.columns - 1u;
    // Rows beyond the last are the last again, and kept by nobody.
    let row = n * min(vec4u(u, u + 1u, u + 2u, u + 3u), vec4u(last));
    var sums = Sums();
    for (var block = 0u; block < n; block += BLOCK) {
        var inner = Sums();
        for (var k = block; k < min(block + BLOCK, n); k++) {
            let m = matrix[fours * n + k];
            let x = raw[row.x + k];
            let y = raw[row.y + k];
            let z = raw[row.z + k];
            let w = raw[row.w + k];
            inner.a[0] += m * x.x;
            inner.b[0] += m * x.y;
            inner.a[1] += m * y.x;
            inner.b[1] += m * y.y;
            inner.a[2] += m * z.x;
            inner.b[2] += m * z.y;
            inner.a[3] += m * w.x;
            inner.b[3] += m * w.y;
        }
        sums.a += inner.a;
        sums.b += inner.b;
    }
    keep(c, u, sums.a[0], sums.b[0]);
    keep(c, u + 1u, sums.a[1], sums.b[1]);
    keep(c, u + 2u, sums.a[2], sums.b[2]);
    keep(c, u + 3u, sums.a[3], sums.b[3]);
}

/// Four rows of a column, as many as there are.
fn keep(c: u32, u: u32, a: real4, b: real4) {
    if u >= job.columns {
        return;
    }
    let at = c * job.columns + u - job.base;
    write(at, raised(real2(a.x, b.x)));
    if c + 1u < job.azimuths {
        write(at + job.columns, raised(real2(a.y, b.y)));
    }
    if c + 2u < job.azimuths {
        write(at + 2u * job.columns, raised(real2(a.z, b.z)));
    }
    if c + 3u < job.azimuths {
        write(at + 3u * job.columns, raised(real2(a.w, b.w)));
    }
}

/// Integrals are not negative; what polynomials leave below 0, within the tolerance, is 0. Not by max, which swallows NaN.
fn raised(ab: real2) -> real2 {
    let zero = real2();
    return select(ab, zero, (ab < zero) & (ab >= zero - real2(real(job.alpha_or_bound))));
}
