// Schlick's masking with k = α/2, which resembles Smith's of GGX: Schlick 1994, eq. 19; Karis 2013, of
// image-based lighting: G2 = G1(ωi) G1(ωe), G1 = μ / (μ (1 − k) + k).

fn schlick_k(alpha: real) -> real {
    return 0.5 * alpha;
}

/// The same for four α, of which the NDF keeps the squares.
fn schlick_ks(a2: real4) -> real4 {
    return 0.5 * sqrt(a2);
}
