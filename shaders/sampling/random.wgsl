// Draws from a generator, each texel's own: PCG-RXS-M-XS 32 (O'Neill 2014), seeded by its hash
// (Jarzynski & Olano 2020).

var<private> state: vec4u;

fn seed(texels: vec4u, chunk: u32) {
    state = permuted(stepped(permuted(stepped(texels)) + chunk));
}

fn stepped(x: vec4u) -> vec4u {
    return x * 747796405u + 2891336453u;
}

fn permuted(x: vec4u) -> vec4u {
    let word = ((x >> ((x >> vec4u(28u)) + 4u)) ^ x) * 277803737u;
    return (word >> vec4u(22u)) ^ word;
}

/// In (0, 1), of 24 bits: what f32 holds.
fn uniform_real() -> real4 {
    state = stepped(state);
    return (real4(permuted(state) >> vec4u(8u)) + 0.5) * real(5.9604644775390625e-8);
}

/// φ is uniform in [0, π], whose cosine is sin y of y = π/2 − φ: Taylor's series to y¹¹, good to 6e-8.
fn draw(k: u32) -> Draw {
    let u = uniform_real();
    let y = real(3.141592653589793) * (0.5 - uniform_real());
    let y2 = y * y;
    let sin = y * (1.0 - y2 / 6.0 * (1.0 - y2 / 20.0 * (1.0 - y2 / 42.0 * (1.0 - y2 / 72.0 * (1.0 - y2 / 110.0)))));
    return Draw(u, sin);
}
