// Irradiance of a map of piecewise-constant radiance: one invocation a row and a normal, neighbours having the same row, as
// neighbouring normals have much the same to do there. The twin, `src/light/irradiance.rs`, says why it is done so. What is
// above the surface comes from sums that the host keeps, each as two f32 whose sum is good to 48 bits, as a sun's are
// subtracted from one another.

struct Job {
    first: u32,   // normal of this dispatch
    count: u32,   // of its normals
    rows: u32,
    width: u32,
    split: u32,
    block: u32,   // columns between sums
    kept: u32,    // sums of a row
    skip: u32,    // crossed columns of a row that earlier dispatches took
    most: u32,    // and those that this one takes
    step: f32,    // Δψ
    half: f32,    // Δθ/2
    margin: f32,
}

struct Row {
    edges: vec4f,  // (cos, sin) of θ at the upper and the lower border
    middle: vec2f, // and in the middle
    across: f32,   // ∫ sin² θ dθ
    along: f32,    // ∫ cos θ sin θ dθ
}

struct Normal {
    n: vec3f,
    sin: f32,
    column: f32,   // its azimuth: a column,
    fraction: f32, // and from there to the next
    pad0: f32,
    pad1: f32,
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
@group(0) @binding(4) var<storage, read> columns: array<vec4f>; // (cos, sin) of ψ in the middle; ∫ (cos ψ, sin ψ) dψ
@group(0) @binding(5) var<storage, read> texels: array<f32>;
@group(0) @binding(6) var<storage, read> sums: array<vec2f>;

const TINY = 1e-30;
const PI = 3.14159265;
const NODE = 0.57735027;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let invocation = min(id.x, job.count * job.rows - 1u);
    let e = of_row(normals[job.first + invocation % job.count], invocation / job.count);
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
    let inner = min(a, b);
    let outer = max(a, b);
    // Columns first..last, from that of the normal, are above. The others have at most one piece each side of its azimuth.
    let sure = max(inner - job.margin, 0.0);
    let first = i32(ceil(n.fraction - sure));
    let last = i32(floor(n.fraction + sure));
    let begin = i32(floor(n.fraction - outer - job.margin));
    let end = i32(ceil(n.fraction + outer + job.margin));
    let own = i32(n.column);

    // Integrals of what is not negative: roundings below 0 are taken as 0.
    var sum = vec3f();
    if job.skip == 0u {
        let start = wrap(own + first);
        let count = u32(max(last - first, 0));
        let before_the_edge = min(count, job.width - start);
        let s = run(row, start, start + before_the_edge);
        let t = run(row, 0u, count - before_the_edge);
        let whole = at.across * (n.n.x * (s.x + t.x) + n.n.y * (s.y + t.y)) + n.n.z * at.along * (s.z + t.z);
        sum = max(whole, vec3f());
    }
    let left = u32(first - begin);
    let stop = min(left + u32(end - last), job.skip + job.most);
    for (var t = job.skip; t < stop; t++) {
        let is_left = t < left;
        let k = select(last + i32(t - left), begin + i32(t), is_left);
        let side = select(1, -1, is_left);
        let column = wrap(own + k);
        sum += texel(row, column) * crossed(n, at, k, columns[column].xy, side, inner, outer);
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

/// Abramowitz & Stegun 1964, 4.4.46: to 2e-8 rad, and 4e-4 where x near 1 is rounded, which the margin covers.
fn arc_cosine(x: f32) -> f32 {
    let a = abs(x);
    let low = 1.5707963 + a * (-0.2145988 + a * (0.08897899 + a * -0.0501743));
    let high = 0.030891881 + a * (-0.017088126 + a * (0.00667009 + a * -0.0012624911));
    let p = sqrt(1.0 - a) * (low + a * a * a * a * high);
    return select(p, PI - p, x < 0.0);
}

/// The sums of columns `first` to before `end`.
fn run(row: u32, first: u32, end: u32) -> Sums {
    let a = (first + job.block - 1u) / job.block;
    let b = end / job.block;
    if a >= b {
        return direct(row, first, end);
    }
    let s = direct(row, first, a * job.block);
    let t = direct(row, b * job.block, end);
    return Sums(s.x + t.x + kept(row, a, b, 0u), s.y + t.y + kept(row, a, b, 3u), s.z + t.z + kept(row, a, b, 6u));
}

fn direct(row: u32, first: u32, end: u32) -> Sums {
    var s = Sums();
    for (var column = first; column < end; column++) {
        let light = texel(row, column);
        let arc = columns[column].zw;
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
    let x = sums[right] - sums[left];
    let y = sums[right + 1u] - sums[left + 1u];
    let z = sums[right + 2u] - sums[left + 2u];
    return vec3f(x.x + x.y, y.x + y.y, z.x + z.y);
}

/// ∫ max(0, n·ω) dω over a cell, of what is on one side of the normal's azimuth: up to `inner` the row is above, up to
/// `outer` crossed. These are columns from that azimuth; offsets are columns from the cell's middle, away from it.
fn crossed(n: Normal, at: Row, k: i32, psi: vec2f, side: i32, inner: f32, outer: f32) -> f32 {
    let towards = f32(side);
    let middle = towards * (f32(k) + (0.5 - n.fraction));
    // Half a turn away, in whole numbers first, so that it keeps its digits.
    let turn = 0.5 * f32(i32(job.width) - 2 * side * k) - towards * (0.5 - n.fraction);
    let ends = clamp(vec2f(-middle, turn), vec2f(-0.5), vec2f(0.5));
    let reach = clamp(vec2f(inner, outer) - middle, ends.xx, ends.yy);
    return job.step * (part(n, at, psi, towards, ends.x, reach.x) + part(n, at, psi, towards, reach.x, reach.y));
}

/// The same between two offsets, in pieces.
fn part(n: Normal, at: Row, psi: vec2f, side: f32, low: f32, high: f32) -> f32 {
    var sum = 0.0;
    if low >= high {
        return sum;
    }
    let half = 0.5 * (high - low) / f32(job.split);
    for (var j = 0u; j < job.split; j++) {
        let centre = low + half * f32(2u * j + 1u);
        let b = across(n, psi, side * job.step * centre, NODE * job.step * half);
        sum += half * (meridian(n.n.z, b.x, at.middle) + meridian(n.n.z, b.y, at.middle));
    }
    return sum;
}

/// B of two meridians, `by` from the one at (cos ψ, sin ψ) and as far as `apart` beyond and before that.
fn across(n: Normal, psi: vec2f, by: f32, apart: f32) -> vec2f {
    return vec2f(dot(n.n.xy, turned(psi, by - apart)), dot(n.n.xy, turned(psi, by + apart)));
}

/// ∫ max(0, n·ω) sin θ dθ over a row, n·ω = nz cos θ + B sin θ.
fn meridian(z: f32, b: f32, theta: vec2f) -> f32 {
    let height = (z * theta.x + b * theta.y) / max(sqrt(z * z + b * b), TINY);
    // The horizon from the row's middle: below it where the normal points up.
    let q = height * height;
    let horizon = clamp(height * (1.0 + q * (1.0 / 6.0 + q * 0.075)), -job.half, job.half);
    let ends = select(vec2f(-horizon, job.half), vec2f(-job.half, horizon), z >= 0.0);
    let t = turned(theta, 0.5 * (ends.x + ends.y));
    // sin Δθ, and ½ (Δθ − sin Δθ).
    let span = ends.y - ends.x;
    let r = span * span;
    let tail = 1.0 - r / 20.0 * (1.0 - r / 42.0);
    let chord = span * (1.0 - r / 6.0 * tail);
    return max(z * t.x * t.y * chord + b * (span * r / 12.0 * tail + chord * t.y * t.y), 0.0);
}

/// (cos, sin) of an angle that is larger by `by`, at most π/64: series to their last digits.
fn turned(angle: vec2f, by: f32) -> vec2f {
    let q = by * by;
    let cos = 1.0 - q * (0.5 - q / 24.0);
    let sin = by * (1.0 - q * (1.0 / 6.0 - q / 120.0));
    return vec2f(angle.x * cos - angle.y * sin, angle.y * cos + angle.x * sin);
}
