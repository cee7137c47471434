// An inner integral that an outer sum goes on with.

@group(0) @binding(1) var<storage, read_write> raw: array<real2>;

fn write(at: u32, ab: real2) {
    raw[at] = ab;
}
