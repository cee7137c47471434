// An inner integral that an outer sum goes on with.

@group(0) @binding(1) var<storage, read_write> results: array<real2>;

fn write(at: u32, ab: real2) {
    results[at] = ab;
}
