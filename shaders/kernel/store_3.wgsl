// Three channels, packed: four texels are three vectors.

fn store(at: u32, w: Weights, a0: real2, a1: real2, a2: real2, a3: real2) {
    put(at, vec4f(vec4<real>(channel(w.r, a0), channel(w.g, a0), channel(w.b, a0), channel(w.r, a1))));
    put(at + 1u, vec4f(vec4<real>(channel(w.g, a1), channel(w.b, a1), channel(w.r, a2), channel(w.g, a2))));
    put(at + 2u, vec4f(vec4<real>(channel(w.b, a2), channel(w.r, a3), channel(w.g, a3), channel(w.b, a3))));
}
