// Two channels: four texels are two vectors.

fn store(at: u32, w: Weights, a0: real2, a1: real2, a2: real2, a3: real2) {
    put(at, vec4f(vec4<real>(channel(w.r, a0), channel(w.g, a0), channel(w.r, a1), channel(w.g, a1))));
    put(at + 1u, vec4f(vec4<real>(channel(w.r, a2), channel(w.g, a2), channel(w.r, a3), channel(w.g, a3))));
}
