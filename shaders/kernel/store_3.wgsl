// Three channels, packed: four texels are three vectors. All are computed before the first is stored: after
// a store a driver would read the weights again.

fn store(at: u32, a0: real2, a1: real2, a2: real2, a3: real2) {
    let v0 = vec4f(vec4<real>(channel(0u, a0), channel(1u, a0), channel(2u, a0), channel(0u, a1)));
    let v1 = vec4f(vec4<real>(channel(1u, a1), channel(2u, a1), channel(0u, a2), channel(1u, a2)));
    let v2 = vec4f(vec4<real>(channel(2u, a2), channel(0u, a3), channel(1u, a3), channel(2u, a3)));
    put(at, v0);
    put(at + 1u, v1);
    put(at + 2u, v2);
}
