// F82-tint: Schlick with a dip where metals have theirs, at 81.8° (c̄ = 1/7), Kutz, Hašan & Edmondson 2021. With
// S = F0 (1 − x⁵) + F90 x⁵ and M = c x⁶ / (c̄ x̄⁶), which is 1 at c̄ and largest there,
//     F = S − (1 − f82) S(c̄) M = F0·A + F90·B
//     A = 1 − x⁵ − w c x⁶,  w = (1 − f82) (1 − x̄⁵)/(c̄ x̄⁶)
//     B = x⁵ − q c x⁶,      q = (1 − f82)/(c̄ x̄)
// Without a difference, by c + x = 1, and with 5 − w and 4 − q from the host:
//     A = c ((5 − w) x⁶ + c (1 + 2x + 3x² + 4x³ + 5x⁴ + 5x⁵))
//     B = x⁵ ((c − x)² + (4 − q) c x)

/// (A, B) for c = ωi·ωm and x = 1 − c.
fn fresnel(c: real, x: real) -> real2 {
    // The smaller of c and x has the more digits, and 1 − it is the other.
    let small = min(c, x);
    let large = 1.0 - small;
    let y = select(small, large, c < x);
    let y2 = y * y;
    let a = c * (parameter(4u) * (y2 * y2 * y2) + c * (1.0 + y * (2.0 + y * (3.0 + y * (4.0 + 5.0 * (y + y2))))));
    let difference = large - small;
    return real2(a, y2 * y2 * y * (difference * difference + parameter(5u) * small * large));
}

/// For integrals: A + B, which is never below B, however it is rounded …
fn fresnel_whole(c: real4) -> real4 {
    let x = 1.0 - c;
    let x2 = x * x;
    let a = c * (parameter(4u) * (x2 * x2 * x2) + c * (1.0 + x * (2.0 + x * (3.0 + x * (4.0 + 5.0 * (x + x2))))));
    return a + fresnel_complement(c);
}

/// … and what of it is not A, which is B.
fn fresnel_complement(c: real4) -> real4 {
    let x = 1.0 - c;
    let x2 = x * x;
    let difference = c - x;
    return x2 * x2 * x * (difference * difference + parameter(5u) * c * x);
}
