// Irradiance of a map of piecewise-constant radiance: one invocation a normal and a row. The twin,
// `src/light/irradiance.rs`, says why it is done so. What is above the surface comes from sums that the host
// keeps, each as two f32 whose sum is good to 48 bits, as a sun's are subtracted from one another.

struct Job {
    first: u32,   // normal of this dispatch
    count: u32,   // of its normals
    rows: u32,
    width: u32,
    split: u32,
    kept: u32,    // sums of a row
    step: f32,    // Δψ
    half: f32,    // Δθ/2
}

struct Row {
    edges: vec4f,  // (cos, sin) of θ at the upper and the lower border
    middle: vec2f, // and in the middle
    across: f32,   // ∫ sin² θ dθ
    along: f32,    // ∫ cos θ sin θ dθ
}

struct Column {
    edge: vec2f,   // (cos, sin) of ψ at the left border
    middle: vec2f, // and in the middle
    arc: vec2f,    // ∫ (cos ψ, sin ψ) dψ
    pad: vec2f,
}

struct Normal {
    n: vec3f,
    sin: f32,
    place: f32,    // its azimuth, in columns
    pad0: f32,
    pad1: f32,
    pad2: f32,
}

/// Σ L ∫(cos ψ, sin ψ, 1) dψ, R, G and B each.
struct Sums {
    x: vec3f,
    y: vec3f,
    z: vec3f,
}

@group(0) @binding(0) var<uniform> job: Job;
@group(0) @binding(1) var<storage, read_write> values: array<f32>;
@group(0) @binding(2) var<storage, read> normals: array<Normal>;
@group(0) @binding(3) var<storage, read> rows: array<Row>;
@group(0) @binding(4) var<storage, read> columns: array<Column>;
@group(0) @binding(5) var<storage, read> texels: array<f32>;
@group(0) @binding(6) var<storage, read> sums: array<vec2f>;

const BLOCK = 16u;
const MARGIN = 1.5;
const TINY = 1e-30;
const PI = 3.14159265;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let invocation = min(id.x, job.count * job.rows - 1u);
    let n = normals[job.first + invocation / job.rows];
    let row = invocation % job.rows;
    let e = of_row(n, row);
    values[3u * invocation] = e.x;
    values[3u * invocation + 1u] = e.y;
    values[3u * invocation + 2u] = e.z;
}

fn texel(row: u32, column: u32) -> vec3f {
    let at = 3u * (row * job.width + column);
    return vec3f(texels[at], texels[at + 1u], texels[at + 2u]);
}

/// What a row sends.
fn of_row(n: Normal, row: u32) -> vec3f {
    let at = rows[row];
    let a = reach(n, at.edges.xy);
    let b = reach(n, at.edges.zw);
    let inner = min(a, b) - MARGIN;
    let outer = max(a, b) + MARGIN;
    let width = i32(job.width);
    // Columns first..last are above, and beside them begin..first and last..end may be crossed.
    let centre = i32(floor(n.place + 0.5));
    var begin = i32(floor(n.place - outer));
    var end = i32(ceil(n.place + outer));
    if end - begin > width {
        begin = centre - width / 2;
        end = begin + width;
    }
    var first = i32(ceil(n.place - inner));
    var last = i32(floor(n.place + inner));
    if inner <= 0.0 || first > last {
        first = centre;
        last = centre;
    }
    first = clamp(first, begin, end);
    last = clamp(last, begin, end);

    let start = wrap(first);
    let count = u32(last - first);
    let before_the_edge = min(count, job.width - start);
    let s = run(row, start, start + before_the_edge);
    let t = run(row, 0u, count - before_the_edge);
    var sum = at.across * (n.n.x * (s.x + t.x) + n.n.y * (s.y + t.y)) + n.n.z * at.along * (s.z + t.z);
    for (var k = begin; k < first; k++) {
        let column = wrap(k);
        sum += texel(row, column) * cell(n, at, column);
    }
    for (var k = last; k < end; k++) {
        let column = wrap(k);
        sum += texel(row, column) * cell(n, at, column);
    }
    return sum;
}

fn wrap(column: i32) -> u32 {
    let width = i32(job.width);
    return u32((column + 2 * width) % width);
}

/// Columns from the normal's azimuth to where n·ω = 0.
fn reach(n: Normal, edge: vec2f) -> f32 {
    let x = clamp(-n.n.z * edge.x / max(n.sin * edge.y, TINY), -1.0, 1.0);
    return arc_cosine(x) / job.step;
}

/// Abramowitz & Stegun 1964, 4.4.45: to 7e-5 rad, which the margin covers.
fn arc_cosine(x: f32) -> f32 {
    let a = abs(x);
    let p = sqrt(1.0 - a) * (1.5707288 + a * (-0.2121144 + a * (0.074261 - 0.0187293 * a)));
    return select(p, PI - p, x < 0.0);
}

/// The sums of columns `first` to before `end`.
fn run(row: u32, first: u32, end: u32) -> Sums {
    let a = (first + BLOCK - 1u) / BLOCK;
    let b = end / BLOCK;
    if a >= b {
        return direct(row, first, end);
    }
    let s = direct(row, first, a * BLOCK);
    let t = direct(row, b * BLOCK, end);
    return Sums(s.x + t.x + kept(row, a, b, 0u), s.y + t.y + kept(row, a, b, 3u), s.z + t.z + kept(row, a, b, 6u));
}

fn direct(row: u32, first: u32, end: u32) -> Sums {
    var s = Sums();
    for (var column = first; column < end; column++) {
        let light = texel(row, column);
        let arc = columns[column].arc;
        s.x += light * arc.x;
        s.y += light * arc.y;
        s.z += light * job.step;
    }
    return s;
}

/// The difference of two kept sums.
fn kept(row: u32, a: u32, b: u32, axis: u32) -> vec3f {
    let left = (row * job.kept + a) * 9u + axis;
    let right = (row * job.kept + b) * 9u + axis;
    var d = vec3f();
    for (var c = 0u; c < 3u; c++) {
        let difference = sums[right + c] - sums[left + c];
        d[c] = difference.x + difference.y;
    }
    return d;
}

/// n·ω.
fn height(n: Normal, theta: vec2f, psi: vec2f) -> f32 {
    return n.n.z * theta.x + theta.y * (n.n.x * psi.x + n.n.y * psi.y);
}

/// ∫ max(0, n·ω) dω over a cell.
fn cell(n: Normal, at: Row, column: u32) -> f32 {
    let own = columns[column];
    let right = columns[column + 1u].edge;
    let corners = vec4f(
        height(n, at.edges.xy, own.edge),
        height(n, at.edges.xy, right),
        height(n, at.edges.zw, own.edge),
        height(n, at.edges.zw, right),
    );
    if max(max(corners.x, corners.y), max(corners.z, corners.w)) <= 0.0 {
        return 0.0;
    }
    if min(min(corners.x, corners.y), min(corners.z, corners.w)) >= 0.0 {
        return at.across * (n.n.x * own.arc.x + n.n.y * own.arc.y) + n.n.z * at.along * job.step;
    }
    var sum = 0.0;
    let size = vec2f(job.half, 0.5 * job.step);
    for (var i = 0u; i < job.split; i++) {
        for (var j = 0u; j < job.split; j++) {
            let low = size * (2.0 * vec2f(f32(i), f32(j)) / f32(job.split) - 1.0);
            let high = size * (2.0 * vec2f(f32(i + 1u), f32(j + 1u)) / f32(job.split) - 1.0);
            let a = corner(n, at.middle, own.middle, low);
            let b = corner(n, at.middle, own.middle, vec2f(high.x, low.y));
            let c = corner(n, at.middle, own.middle, high);
            let d = corner(n, at.middle, own.middle, vec2f(low.x, high.y));
            sum += triangle(n, at.middle, own.middle, a, b, c) + triangle(n, at.middle, own.middle, a, c, d);
        }
    }
    return sum;
}

/// A point of a cell from its middle, and n·ω there.
fn corner(n: Normal, theta: vec2f, psi: vec2f, point: vec2f) -> vec3f {
    return vec3f(point, height(n, turned(theta, point.x), turned(psi, point.y)));
}

/// (cos, sin) of an angle that is larger by `by`, at most π/64: series to their last digits.
fn turned(angle: vec2f, by: f32) -> vec2f {
    let q = by * by;
    let cos = 1.0 - q * (0.5 - q / 24.0);
    let sin = by * (1.0 - q * (1.0 / 6.0 - q / 120.0));
    return vec2f(angle.x * cos - angle.y * sin, angle.y * cos + angle.x * sin);
}

/// What is above the horizon in a triangle: the corner that is alone on its side comes first.
fn triangle(n: Normal, theta: vec2f, psi: vec2f, a: vec3f, b: vec3f, c: vec3f) -> f32 {
    let above = vec3<bool>(a.z > 0.0, b.z > 0.0, c.z > 0.0);
    if all(above) {
        return midpoints(n, theta, psi, a.xy, b.xy, c.xy);
    }
    if !any(above) {
        return 0.0;
    }
    if above.x == above.y {
        return alone(n, theta, psi, c, a, b);
    }
    if above.x == above.z {
        return alone(n, theta, psi, b, c, a);
    }
    return alone(n, theta, psi, a, b, c);
}

fn alone(n: Normal, theta: vec2f, psi: vec2f, a: vec3f, b: vec3f, c: vec3f) -> f32 {
    let p = a.xy + a.z / (a.z - b.z) * (b.xy - a.xy);
    let q = a.xy + a.z / (a.z - c.z) * (c.xy - a.xy);
    if a.z > 0.0 {
        return midpoints(n, theta, psi, a.xy, p, q);
    }
    return midpoints(n, theta, psi, p, b.xy, c.xy) + midpoints(n, theta, psi, p, c.xy, q);
}

/// The rule of the sides' midpoints.
fn midpoints(n: Normal, theta: vec2f, psi: vec2f, a: vec2f, b: vec2f, c: vec2f) -> f32 {
    let u = b - a;
    let v = c - a;
    let area = 0.5 * abs(u.x * v.y - u.y * v.x);
    let sum = node(n, theta, psi, 0.5 * (a + b)) + node(n, theta, psi, 0.5 * (b + c)) + node(n, theta, psi, 0.5 * (c + a));
    return area / 3.0 * sum;
}

/// n·ω sin θ.
fn node(n: Normal, theta: vec2f, psi: vec2f, point: vec2f) -> f32 {
    let t = turned(theta, point.x);
    return t.y * height(n, t, turned(psi, point.y));
}
