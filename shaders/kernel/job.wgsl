// What every kernel reads: which invocations this dispatch does, and how a lobe's components
// (A, B) become channels. Binding 0 is the job, 1 the result; what a kernel reads follows.

struct Job {
    weights: array<vec4f, 3>, // for each channel two, and what f32 drops of them
    first: u32,               // first invocation of this dispatch
    end: u32,                 // one past its last
    base: u32,                // the result that is the first of the output buffer; of points, where theirs begin
    columns: u32,             // counts, by kernel
    azimuths: u32,
    nodes: u32,
    tiles: u32,
    alpha_or_bound: f32,      // points: α; sums: how far below 0 interpolation may leave an integral
    parameters: array<vec4f, 4>, // of the lobe, by place; then what f32 drops of them
}

const INV_PI: real = 0.3183098861837907;

@group(0) @binding(0) var<uniform> job: Job;

/// What the channels weigh (A, B) with.
struct Weights {
    r: real2,
    g: real2,
    b: real2,
}

fn weights() -> Weights {
    let w = job.weights;
    return Weights(
        real2(w[0].xy) + real2(w[0].zw),
        real2(w[1].xy) + real2(w[1].zw),
        real2(w[2].xy) + real2(w[2].zw),
    );
}

/// A parameter of the lobe beside its shape, by the place that its part has.
fn parameter(place: u32) -> real {
    let p = job.parameters;
    return real(p[place / 4u][place % 4u]) + real(p[2u + place / 4u][place % 4u]);
}

fn channel(weight: real2, ab: real2) -> real {
    return weight.x * ab.x + weight.y * ab.y;
}
