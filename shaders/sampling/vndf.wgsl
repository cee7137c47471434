// Directions in proportion to the microfacets that ωe sees.

fn facet(a: real4, b: real4, e: Masked, s: real, alpha: real4) -> Facet {
    return vndf_facet(a, b, e, s, alpha);
}

/// G2 / G1 = z (μ + root) / masking
fn facet_weight(q: real4, m: real4, e: Masked) -> real4 {
    return e.mu + e.root;
}
