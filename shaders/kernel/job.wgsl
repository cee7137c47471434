// What every kernel reads: which invocations this dispatch does, and how a lobe's components
// (A, B) become channels. Binding 0 is the job, 1 the result; what a kernel reads follows.

struct Job {
    weights: array<vec4f, 3>, // channel c = dot(weights[c].xy + weights[c].zw, (A, B)): the latter is what f32 drops
    first: u32,               // first invocation of this dispatch
    end: u32,                 // one past its last
    base: u32,                // the result that is the first of the output buffer; of points, where theirs begin
    columns: u32,             // counts, by kernel
    azimuths: u32,
    nodes: u32,
    tiles: u32,
    alpha: f32,               // of a list of points
}

const INV_PI: real = 0.3183098861837907;

@group(0) @binding(0) var<uniform> job: Job;

fn channel(c: u32, ab: real2) -> real {
    let weight = real2(job.weights[c].xy) + real2(job.weights[c].zw);
    return weight.x * ab.x + weight.y * ab.y;
}
