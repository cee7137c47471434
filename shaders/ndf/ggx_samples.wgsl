// Importance sampling of GGX. A microfacet's normal is kept as ωm ∝ (x, ·, m), with |its tangential
// part|² = t2: neither is its length divided out nor its second tangential component needed, as the
// integrand does not tell left from right.
//
// With ωi the mirror image of ωe = (s, 0, μ), its density is p(ωi) = p(ωm) / (4 ωe·ωm) (Walter et al.
// 2007, eq. 38 f.), so that the mean of f μi / p estimates ρ = ∫ f cos θi dωi:
//     ndf:  p(ωm) = D cos θm            (Walter et al. 2007, eq. 24)
//           f μi / p = F G2 (ωe·ωm) / (μ cos θm)
//     vndf: p(ωm) = G1 D ωe·ωm / μ      (Heitz 2018, eq. 3)
//           f μi / p = F G2 / G1
// where with q = ωe·(x, ·, m)/μ, y = m² + t2 and z = 2qm − y
//     μi = μz/y,  cos θm = m/√y,  ωe·ωm = μq/√y,  G2 = 2μ z / masking(z, y),  G1 = 2μ / (μ + root).
// ωi below the horizon, z < 0, counts as 0.

/// An estimate: of A + B, and what of that is not A.
struct Estimate {
    all: real4,
    grazing: real4,
}

struct Facet {
    x: real4,
    t2: real4,
    m: real4,
}

/// A draw (t, cos φ), t = √(u/(1 − u)): tan θm = α t (Walter et al. 2007, eq. 35).
fn ndf_facet(t: real4, cos_phi: real4, e: Masked, s: real, alpha: real4) -> Facet {
    let tan = alpha * t;
    return Facet(tan * cos_phi, tan * tan, real4(1.0));
}

/// A draw (u, cos φ): Dupuy & Benyoub 2023, algorithm 3. On the sphere that α squeezes, ωe becomes
/// w = (α s, 0, μ)/root, and ωm is c + w with c uniform on the cap c.z > −w.z, of height c.z + w.z = u (1 + w.z).
fn vndf_facet(u: real4, cos_phi: real4, e: Masked, s: real, alpha: real4) -> Facet {
    let w_x = alpha * s / e.root;
    let w_z = 1.0 + e.mu / e.root;
    let m = u * w_z;
    // 1 − c.z² without cancellation, as 1 − w.z² = w.x²
    let sin2 = (1.0 - u) * (m * w_z + w_x * w_x);
    let x = sqrt(sin2) * cos_phi + w_x;
    let t2 = x * x + sin2 * max(1.0 - cos_phi * cos_phi, real4());
    return Facet(alpha * x, alpha * alpha * t2, m);
}

/// f μi / p; `tan` is that of θe.
fn facet_estimate(facet: Facet, e: Masked, tan: real) -> Estimate {
    let q = tan * facet.x + facet.m;
    let y = facet.m * facet.m + facet.t2;
    let z = max(2.0 * q * facet.m - y, real4());
    let all = z * facet_weight(q, facet.m, e) / masking(z, y, e);
    let c = clamp(e.mu * q * inverseSqrt(y), real4(), real4(1.0));
    return Estimate(all * fresnel_whole(c), all * fresnel_complement(c));
}
