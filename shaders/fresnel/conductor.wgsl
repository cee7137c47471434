// Fresnel's equations for a conductor of index η + ik, unpolarised (Born & Wolf, section 14.2, for any η and k). With
// e = (η + ik)² − 1 and g = √(e + c²), both complex, and s² = 1 − c²:
//     F = (|r_s|² + |r_p|²)/2,  r_s = −e/(g + c)²,  r_p = r_s (cg − s²)/(cg + s²)
// as for a dielectric. No complex root is taken: |g|² = |e + c²|, (Re g)² = (|g|² + Re g²)/2, and
//     |g + c|² = |g|² + c (c + 2 Re g),  |cg ∓ s²|² = c²|g|² + s⁴ ∓ 2cs² Re g.

/// (F, 0) for c = ωi·ωm and x = 1 − c.
fn fresnel(c: real, x: real) -> real2 {
    let e = real2(parameter(4u), parameter(5u)); // in place of η and k
    let re = e.x + c * c;
    let g2 = sqrt(re * re + e.y * e.y);
    // (|g|² + Re g²)/2 cancels where Re g² < 0: Re g = Im g² / 2 Im g then.
    let root = sqrt(0.5 * (g2 + abs(re)));
    let re_g = select(root, 0.5 * e.y / max(root, NO_SURFACE), re < 0.0);
    let sum = max(g2 + c * (c + 2.0 * re_g), NO_SURFACE);
    let s2 = x * (1.0 + c);
    let even = c * c * g2 + s2 * s2;
    let odd = 2.0 * c * s2 * re_g;
    let q = (even - odd) / (even + odd);
    return real2(0.5 * (dot(e, e) / (sum * sum)) * (1.0 + q), 0.0);
}

/// For integrals: F …
fn fresnel_whole(c: real4) -> real4 {
    let e = real2(parameter(4u), parameter(5u));
    let re = e.x + c * c;
    let g2 = sqrt(re * re + e.y * e.y);
    let root = sqrt(0.5 * (g2 + abs(re)));
    let re_g = select(root, 0.5 * e.y / max(root, real4(NO_SURFACE)), re < real4());
    let sum = max(g2 + c * (c + 2.0 * re_g), real4(NO_SURFACE));
    let s2 = (1.0 - c) * (1.0 + c);
    let even = c * c * g2 + s2 * s2;
    let odd = 2.0 * c * s2 * re_g;
    let q = (even - odd) / (even + odd);
    return 0.5 * (dot(e, e) / (sum * sum)) * (1.0 + q);
}

/// … and what of it is not A: nothing.
fn fresnel_complement(c: real4) -> real4 {
    return real4();
}

/// Far below any |g + c|² but that of η = 1, k = 0 at c = 0, where 0/0 is 0; its square is a normal number.
const NO_SURFACE: real = 1e-18;
