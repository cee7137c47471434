// Perfect mirrors, F = 1: what weighs A is then a Fresnel reflectance that is the same at every angle.

/// (1, 0): nothing is B.
fn fresnel(c: real, x: real) -> real2 {
    return real2(1.0, 0.0);
}

/// For integrals: F …
fn fresnel_whole(c: real4) -> real4 {
    return real4(1.0);
}

/// … and what of it is not A: nothing.
fn fresnel_complement(c: real4) -> real4 {
    return real4();
}
