"""ρ_dh = ∫ f cos θe dωe over the hemisphere, of a fixed ωi, by four ways.

Each takes n, how fine it is, and returns a tuple of components. ωi has azimuth 0; isotropic models are even in φ, which goes
from 0 to π here, once for both sides.
"""

from mpmath import mp, mpf

from geometry import Pair, direction, dot
from quadrature import graded, panels, tanh_sinh


def total(terms):
    """Σ weight · components."""
    result = None
    for weight, components in terms:
        part = [weight * x for x in components]
        result = part if result is None else [a + b for a, b in zip(result, part)]
    return tuple(result)


def by_definition(lobe, theta_i, n, opposite=False):
    """∫∫ f cos θe sin θe dθe dφ, with panels that end where a diffuse lobe has its kinks, θe = θi and φ = π/2; and, of what
    is singular where both directions are opposite, with more of them towards there."""
    wi = direction(theta_i, mpf(0))
    half = +mp.pi / 2
    thetas, phis = {mpf(0), theta_i, half}, {mpf(0), half, 2 * half}
    if opposite:
        thetas |= {half - (half - theta_i) * mpf(share) for share in ("0.5", "0.2")}
        phis |= {half * mpf(share) for share in ("1.5", "1.75", "1.9")}
    # But for those, f is a polynomial of few powers of cos φ.
    phis = panels(sorted(phis), n if opposite else n - 4)
    if theta_i == 0:
        phis = [(half, 2 * half)]
    return total(
        (2 * mp.cos(theta) * mp.sin(theta) * w * v, lobe(Pair(wi, direction(theta, phi))))
        for theta, w in panels(sorted(thetas), n)
        for phi, v in phis
    )


def by_normals(lobe, theta_i, alpha, n, reach=None, flat=False):
    """∫∫ f cos θe 4 (ωi·ωm) dωm, over the normals whose mirror images of ωi are above the horizon.

    With t = tan θm and φ the azimuth of ωm, dωm = t/(1 + t²)^(3/2) dt dφ, and t ends where cos θe = 0, which is μ t² −
    2 s t cos φ − μ = 0, or at `reach` α, beyond which nothing is left. t = α sinh v; and φ = π/2 ± μ sinh u, as the horizon
    turns there on that scale. Beckmann's Λ is not analytic, but flat, where ωe is the normal, t = tan(θi/2) and φ = 0:
    panels crowd there.
    """
    wi = direction(theta_i, mpf(0))
    s, mu = wi[0], wi[2]
    most, widest = (mpf("0.75"), mpf(1)) if reach else (mpf(1), mpf("1.7"))
    near = [mpf(k) / 10 for k in (1, 2, 4, 8)] if flat else []
    middle = mp.asinh(mp.tan(theta_i / 2) / alpha)

    def inner(cos_phi, sin_phi):
        root = mp.sqrt((s * cos_phi) ** 2 + mu**2)
        end = ((s * cos_phi + root) / mu if cos_phi > 0 else mu / (root - s * cos_phi)) / alpha
        first = min(most, max(alpha / mu / 2, mpf("0.1")))  # Λ(ωe) turns at cos θe ~ α
        if reach and end > reach:
            end, first = mpf(reach), most
        more = [middle + k for x in near for k in (-x, x)] if cos_phi > 0 else []
        for v, weight in panels(_merged(graded(mp.asinh(end), first, most), more), n):
            t = alpha * mp.sinh(v)
            cos_m = 1 / mp.sqrt(1 + t * t)
            wm = (t * cos_m * cos_phi, t * cos_m * sin_phi, cos_m)
            projected = dot(wi, wm)
            we = tuple(2 * projected * m - i for m, i in zip(wm, wi))
            if we[2] > 0:  # or 0, by rounding at the horizon
                solid_angle = t * cos_m**3 * alpha * mp.cosh(v)
                yield weight * we[2] * 4 * projected * solid_angle, lobe(Pair(wi, we, wm))

    if s == 0:
        return tuple(2 * mp.pi * x for x in total(inner(mpf(1), mpf(0))))
    far = mp.asinh(mp.pi / (2 * mu))
    count = max(1, int(mp.ceil(far / widest)))
    even = [far * k / count for k in range(count + 1)]
    terms = []
    for sign, breaks in ((1, _merged(even, [mp.asinh((mp.pi / 2 - x) / mu) for x in near])), (-1, even)):
        for u, weight in panels(breaks, n):
            turn, scale = mu * mp.sinh(u), 2 * mu * mp.cosh(u) * weight
            terms.append((scale, total(inner(sign * mp.sin(turn), mp.cos(turn)))))
    return total(terms)


def _merged(breaks, more):
    """The breaks and those of `more` within that are not all but there."""
    inside = [x for x in more if breaks[0] < x < breaks[-1] and all(abs(x - y) > 0.03 for y in breaks)]
    return sorted([*breaks, *inside])


def by_rings(unmasked, g2, theta_i, n):
    """Charlie's: G2 is singular where θe is 0 or π/2, and has a seam at cos θe = 1/2, but is the same for all φ."""
    wi = direction(theta_i, mpf(0))
    half = +mp.pi / 2
    phis = panels([mpf(0), half, half * mpf("1.5"), half * mpf("1.8"), 2 * half], n)
    if theta_i == 0:
        phis = [(half, 2 * half)]

    def ring(theta):
        return total((2 * v, unmasked(Pair(wi, direction(theta, phi)))) for phi, v in phis)

    rule = tanh_sinh(sorted({mpf(0), theta_i, mp.pi / 3, half}), 2 / mpf(n))
    return total(
        (g2(Pair(wi, direction(theta, mpf(0)))) * mp.cos(theta) * mp.sin(theta) * w, ring(theta))
        for theta, w in rule
        if 0 < theta < half and w > mpf(10) ** -28
    )


def about_axis(exponent, theta, n, alpha):
    """(k + 2)/(2π) ∫ cos^k γ cos θe dωe over γ ≤ π/2 from an axis θ from the normal, above the horizon; k the exponent. On
    the cone of a γ cos θe = cos γ cos θ − sin γ sin θ cos ψ, whose positive part has a closed integral over ψ."""
    half = +mp.pi / 2

    def cone(gamma):
        level, swing = mp.cos(gamma) * mp.cos(theta), mp.sin(gamma) * mp.sin(theta)
        if level >= swing:
            return 2 * mp.pi * level
        psi = mp.acos(level / swing)  # cos θe is positive beyond
        return 2 * ((mp.pi - psi) * level + swing * mp.sin(psi))

    # The lobe ends as e^(−γ²/α²) does.
    breaks = {mpf(0), half - theta, half, *(k * alpha for k in (2, 5, 12))}
    rule = tanh_sinh(sorted(x for x in breaks if x <= half), 1 / mpf(n))
    scale = (exponent + 2) / (2 * mp.pi)
    return (scale * sum(w * mp.cos(g) ** exponent * mp.sin(g) * cone(g) for g, w in rule if g < half),)
