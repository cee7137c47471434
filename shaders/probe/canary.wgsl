// What drivers do to shaders and WGSL leaves open, by inputs whose results tell. They come from the host: what a
// compiler knows it computes by itself.

/// `Given` of `src/backend/gpu/driver_probe.rs`.
struct Given {
    turns: u32,
    x: f32,         // x² + minus_x2 is 0 if x² is rounded, …
    minus_x2: f32,  // … and what rounding takes from it if not
    small: f32,     // below half an ULP of `large`
    large: f32,
    denormal: f32,
    scale: f32,     // denormal · scale is normal
    tiny: f32,      // tiny² is denormal
    nan: f32,
}

/// `Found` of `src/backend/gpu/driver_probe.rs`.
struct Found {
    product_and_sum: u32,
    fma: u32,
    sum_and_difference: u32,
    from_denormal: u32,
    to_denormal: u32,
    nan_differs: u32,
    turns: array<vec2u, 64>, // how many, and what they made
}

@group(0) @binding(0) var<storage, read_write> found: Found;
@group(0) @binding(1) var<storage, read> given: Given;

@compute @workgroup_size(64)
fn main(@builtin(local_invocation_index) id: u32) {
    // A generator: turns that nobody can leave out.
    var state = 0u;
    var turns = 0u;
    for (; turns < given.turns; turns++) {
        state = state * 747796405u + 2891336453u;
    }
    found.turns[id] = vec2u(turns, state);
    if id == 0u {
        found.product_and_sum = bitcast<u32>(given.x * given.x + given.minus_x2);
        found.fma = bitcast<u32>(fma(given.x, given.x, given.minus_x2));
        found.sum_and_difference = bitcast<u32>((given.small + given.large) - given.large);
        found.from_denormal = bitcast<u32>(given.denormal * given.scale);
        found.to_denormal = bitcast<u32>(given.tiny * given.tiny);
        found.nan_differs = u32(given.nan != given.nan);
    }
}
