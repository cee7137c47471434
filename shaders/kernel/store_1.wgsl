// One channel: four texels are one vector.

fn store(at: u32, a0: real2, a1: real2, a2: real2, a3: real2) {
    put(at, vec4f(vec4<real>(channel(0u, a0), channel(0u, a1), channel(0u, a2), channel(0u, a3))));
}
