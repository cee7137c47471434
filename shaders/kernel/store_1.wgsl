// One channel: four texels are one vector.

fn store(at: u32, w: Weights, a0: real2, a1: real2, a2: real2, a3: real2) {
    put(at, vec4f(vec4<real>(channel(w.r, a0), channel(w.r, a1), channel(w.r, a2), channel(w.r, a3))));
}
