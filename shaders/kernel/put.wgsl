// Four numbers of values at a place.

@group(0) @binding(1) var<storage, read_write> values: array<vec4f>;

fn put(at: u32, v: vec4f) {
    if ADD {
        values[at] += v;
    } else {
        values[at] = v;
    }
}
