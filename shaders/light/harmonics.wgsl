// Nine spherical-harmonic coefficients of a map of piecewise-constant radiance: one invocation a row and a share of its
// columns, every so manieth. The twin, `src/light/harmonics.rs`, has the factors of rows and columns, whose products are the
// basis's integrals over cells.

struct Job {
    rows: u32,
    width: u32,
    shares: u32,
    step: f32,    // Δφ
}

/// Σ L ∫(1, cos φ, sin φ, cos 2φ, sin 2φ) dφ, R, G and B each.
struct Sums {
    one: vec3f,
    cos: vec3f,
    sin: vec3f,
    cos2: vec3f,
    sin2: vec3f,
}

@group(0) @binding(0) var<uniform> job: Job;
@group(0) @binding(1) var<storage, read_write> values: array<f32>;
@group(0) @binding(2) var<storage, read> rows: array<f32>;      // nine factors each
@group(0) @binding(3) var<storage, read> columns: array<vec4f>; // ∫ (cos φ, sin φ, cos 2φ, sin 2φ) dφ
@group(0) @binding(4) var<storage, read> texels: array<f32>;

/// Terms that are added up before they are added to the others, so that roundings grow with their root's number.
const BLOCK = 16u;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let invocation = min(id.x, job.rows * job.shares - 1u);
    let row = invocation / job.shares;
    var s = Sums();
    for (var first = invocation % job.shares; first < job.width; first += BLOCK * job.shares) {
        let t = block(row, first, min(first + BLOCK * job.shares, job.width));
        s = Sums(s.one + t.one, s.cos + t.cos, s.sin + t.sin, s.cos2 + t.cos2, s.sin2 + t.sin2);
    }
    // In the order l(l+1) + m.
    write(invocation, row, 0u, s.one);
    write(invocation, row, 1u, s.sin);
    write(invocation, row, 2u, s.one);
    write(invocation, row, 3u, s.cos);
    write(invocation, row, 4u, s.sin2);
    write(invocation, row, 5u, s.sin);
    write(invocation, row, 6u, s.one);
    write(invocation, row, 7u, s.cos);
    write(invocation, row, 8u, s.cos2);
}

fn block(row: u32, first: u32, end: u32) -> Sums {
    var s = Sums();
    for (var column = first; column < end; column += job.shares) {
        let at = 3u * (row * job.width + column);
        let light = vec3f(texels[at], texels[at + 1u], texels[at + 2u]);
        let arc = columns[column];
        s.one += light * job.step;
        s.cos += light * arc.x;
        s.sin += light * arc.y;
        s.cos2 += light * arc.z;
        s.sin2 += light * arc.w;
    }
    return s;
}

fn write(invocation: u32, row: u32, k: u32, sum: vec3f) {
    let value = rows[9u * row + k] * sum;
    let at = 27u * invocation + 3u * k;
    values[at] = value.x;
    values[at + 1u] = value.y;
    values[at + 2u] = value.z;
}
