// Schlick's masking with k = (r + 1)²/8, r = √α: Karis 2013, of lights: Disney's remapping of the roughness,
// which reduces what he calls its hotness. α → 0 leaves k = 1/8: even a mirror is masked.

fn schlick_k(alpha: real) -> real {
    let r = sqrt(alpha) + 1.0;
    return 0.125 * r * r;
}

/// The same for four α, of which the NDF keeps the squares.
fn schlick_ks(a2: real4) -> real4 {
    let r = sqrt(sqrt(a2)) + 1.0;
    return 0.125 * r * r;
}
