// The same where a device has words of 64 bits: a software driver stores word by word, and of these there are half as many.

@group(0) @binding(1) var<storage, read_write> values: array<vec2<u64>>;

fn put(at: u32, v: vec4f) {
    let bits = vec4<u64>(bitcast<vec4u>(v));
    values[at] = vec2<u64>(bits.x | (bits.y << 32u), bits.z | (bits.w << 32u));
}
