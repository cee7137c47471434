// Draws that all texels share, from the host, in f64 before they were rounded.

@group(0) @binding(4) var<storage, read> draws: array<real2>;

fn seed(texels: vec4u, chunk: u32) {}

fn draw(k: u32) -> Draw {
    return Draw(real4(draws[k].x), real4(draws[k].y));
}
