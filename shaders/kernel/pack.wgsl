// A table as texels: rows padded to what a copy to a texture wants, halves or floats.

struct Packing {
    width: u32,     // texels in a row
    texels: u32,
    channels: u32,  // of the table
    row: u32,       // values in a row of the table, padding included
    words: u32,     // u32 in a texel
    pitch: u32,     // u32 in a row of texels
    half: u32,      // 1: two halves a word; 0: one float
    pad: u32,
}

@group(0) @binding(0) var<uniform> packing: Packing;
@group(0) @binding(1) var<storage, read> values: array<f32>;
@group(0) @binding(2) var<storage, read_write> texels: array<u32>;

/// Channels that the table lacks: 0, and 1 for alpha.
fn value(texel: u32, c: u32) -> f32 {
    if c < packing.channels {
        let at = texel / packing.width * packing.row + texel % packing.width * packing.channels + c;
        return values[at];
    }
    return select(0.0, 1.0, c == 3u);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let texel = id.y * groups.x * 64u + id.x;
    if texel >= packing.texels {
        return;
    }
    let at = texel / packing.width * packing.pitch + texel % packing.width * packing.words;
    for (var w = 0u; w < packing.words; w++) {
        if packing.half == 1u {
            texels[at + w] = pack2x16float(vec2f(value(texel, 2u * w), value(texel, 2u * w + 1u)));
        } else {
            texels[at + w] = bitcast<u32>(value(texel, w));
        }
    }
}
