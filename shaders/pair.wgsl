// Factors of a pair of directions (DESIGN: evaluate from angles, not from vectors). The host makes
// them in f64; everything below is a product or a sum of non-negative terms, so nothing cancels and
// no rewrite that a driver may do can lose the specular peak.

struct Pair {
    hz2: real,    // ((cos θi + cos θe)/2)²
    dt2: real,    // ((sin θi − sin θe)/2)²
    ss: real,     // sin θi sin θe
    sd: real,     // sin²((θi − θe)/2)
    mu_i: real,   // cos θi
    mu_e: real,   // cos θe
    bin: real,    // 1 / weight of this θe cell where it holds the mirror direction, else 0
    alpha_or_weight: real, // α of a row of values; of an integral, the weight of this θe
    st: real,     // (sin θi + sin θe)/2
    dt: real,     // (sin θi − sin θe)/2
}

struct Azimuth {
    sin2: real,   // sin²(δ/2)
    cos2: real,   // cos²(δ/2)
    back: real,   // max(0, −cos δ) = max(0, cos(φi − φe)): 0 unless ωe is on the side of ωi
    weight: real, // of this δφ in an integral
    bin: real,    // 1 / weight of this δφ cell where it holds δφ = 0, else 0
    cp: real,     // (cos φi + cos φe)/2: these four are for what tells azimuths from each other
    cm: real,     // (cos φi − cos φe)/2
    sp: real,     // (sin φi + sin φe)/2
    sm: real,     // (sin φi − sin φe)/2
}

/// A direction: its cosine, and the α that is seen from it.
struct Toward {
    mu: real,
    alpha: real,
}

/// h = (ωi + ωe)/2, whose length is ωi·ωm.
struct Half {
    ht2: real,         // |h|², tangential part
    h2: real,          // |h|²
    c: real,           // ωi·ωm
    one_minus_c: real, // 1 − ωi·ωm
}

fn half_vector(p: Pair, a: Azimuth) -> Half {
    let ht2 = p.dt2 + p.ss * a.sin2;
    let h2 = ht2 + p.hz2;
    // |ωi − ωe|²/4 = 1 − (ωi·ωm)² = sin²((θi − θe)/2) + sin θi sin θe cos²(δ/2)
    let c = sqrt(h2);
    return Half(ht2, h2, c, (p.sd + p.ss * a.cos2) / (1.0 + c));
}
