// A value or an integral that is all of a texel, as channels. Not a loop over them: software drivers take longer to
// start one than the integral takes.

@group(0) @binding(1) var<storage, read_write> values: array<real>;

fn write(texel: u32, ab: real2) {
    let w = weights();
    put(texel * CHANNELS, channel(w.r, ab));
    if CHANNELS > 1u {
        put(texel * CHANNELS + 1u, channel(w.g, ab));
    }
    if CHANNELS > 2u {
        put(texel * CHANNELS + 2u, channel(w.b, ab));
    }
}

fn put(at: u32, value: real) {
    if ADD {
        values[at] += value;
    } else {
        values[at] = value;
    }
}
