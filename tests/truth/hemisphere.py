"""ρ_dh = ∫ f cos θe dωe over the hemisphere, of a fixed ωi, by four ways.

Each takes a count that says how fine, and returns a tuple of components; nothing else of a rule is exact, so that whoever
calls compares two counts. ωi has azimuth 0; isotropic models are even in φ, which is 0 to π here.
"""

from mpmath import mp, mpf

from geometry import Pair, direction, dot
from quadrature import graded, panels, tanh_sinh


def _sum(terms):
    """Σ weight · components."""
    total = None
    for weight, components in terms:
        part = [weight * x for x in components]
        total = part if total is None else [a + b for a, b in zip(total, part)]
    return tuple(total)


def by_definition(lobe, theta_i, n):
    """∫∫ f cos θe sin θe dθe dφ, panels that end where a diffuse lobe has its kinks: θe = θi and φ = π/2. They crowd at
    θe = π/2 and φ = π, where both directions may be nearly opposite."""
    wi = direction(theta_i, mpf(0))
    # mp.pi is a constant of no precision of its own: +mp.pi is a number.
    half = +mp.pi / 2
    thetas = sorted({mpf(0), theta_i, half - (half - theta_i) / 3, half})
    phis = panels([mpf(0), half, half * mpf("1.6"), half * mpf("1.9"), 2 * half], n)
    return _sum(
        (2 * mp.cos(theta) * mp.sin(theta) * w * v, lobe(Pair(wi, direction(theta, phi))))
        for theta, w in panels(thetas, n)
        for phi, v in phis
    )


def by_normals(lobe, theta_i, alpha, n):
    """∫∫ f cos θe 4 (ωi·ωm) dωm, over the normals whose mirror images of ωi are above the horizon.

    With t = tan θm and φ the azimuth of ωm, dωm = t/(1 + t²)^(3/2) dt dφ, and t ends where cos θe = 0, that is
    μ t² − 2 s t cos φ − μ = 0. t = α sinh v; and φ = π/2 ± μ sinh u, as the horizon turns there on that scale.
    """
    wi = direction(theta_i, mpf(0))
    s, mu = wi[0], wi[2]

    def inner(cos_phi, sin_phi):
        root = mp.sqrt((s * cos_phi) ** 2 + mu**2)
        t_max = (s * cos_phi + root) / mu if cos_phi > 0 else mu / (root - s * cos_phi)
        # Λ(ωe) turns at cos θe ~ α, that is about α/μ before the horizon in v.
        first = min(mpf(1), max(alpha / mu / 2, mpf("0.1")))
        rule = panels(graded(mp.asinh(t_max / alpha), first, mpf("1.7")), n)
        for v, weight in rule:
            t = alpha * mp.sinh(v)
            cos_m = 1 / mp.sqrt(1 + t * t)
            wm = (t * cos_m * cos_phi, t * cos_m * sin_phi, cos_m)
            projected = dot(wi, wm)
            we = tuple(2 * projected * m - i for m, i in zip(wm, wi))
            if we[2] <= 0:
                continue  # by rounding, at the horizon
            solid_angle = t * cos_m**3 * alpha * mp.cosh(v)
            yield weight * we[2] * 4 * projected * solid_angle, lobe(Pair(wi, we))

    if s == 0:
        return tuple(2 * mp.pi * x for x in _sum(inner(mpf(1), mpf(0))))
    reach = mp.asinh(mp.pi / (2 * mu))
    count = max(1, int(mp.ceil(reach / mpf("1.7"))))
    terms = []
    for u, weight in panels([reach * k / count for k in range(count + 1)], n):
        turn, scale = mu * mp.sinh(u), 2 * mu * mp.cosh(u) * weight
        for sign in (1, -1):
            terms.append((scale, _sum(inner(sign * mp.sin(turn), mp.cos(turn)))))
    return _sum(terms)


def by_fibres(unmasked, g2, theta_i, n):
    """Charlie's, whose G2 is singular where θe is 0 or π/2, and has a seam at cos θe = 1/2, but is the same for all φ."""
    wi = direction(theta_i, mpf(0))
    half = +mp.pi / 2
    phis = panels([mpf(0), half, half * mpf("1.6"), 2 * half], 20 if n <= 20 else 26)

    def ring(theta):
        return _sum((2 * v, unmasked(Pair(wi, direction(theta, phi)))) for phi, v in phis)

    rule = tanh_sinh(sorted({mpf(0), theta_i, mp.pi / 3, half}), 1 / mpf(n))
    return _sum(
        (g2(Pair(wi, direction(theta, mpf(0)))) * mp.cos(theta) * mp.sin(theta) * w, ring(theta))
        for theta, w in rule
        if 0 < theta < half
    )


def about_axis(n_exponent, cos_axis, step):
    """(n + 2)/(2π) ∫ cosⁿγ cos θe dωe over γ ≤ π/2 from an axis and above the horizon. At γ the cone's directions have
    cos θe = cos γ cos θ − sin γ sin θ cos ψ, whose positive part is integrated over ψ in closed form."""
    theta = mp.acos(cos_axis)
    sin_axis = mp.sin(theta)
    half = +mp.pi / 2

    def cone(gamma):
        level, swing = mp.cos(gamma) * cos_axis, mp.sin(gamma) * sin_axis
        if level >= swing:
            return 2 * mp.pi * level
        psi = mp.acos(level / swing)  # cos θe is positive beyond
        return 2 * ((mp.pi - psi) * level + swing * mp.sin(psi))

    rule = tanh_sinh(sorted({mpf(0), half - theta, half}), 1 / mpf(step))
    scale = (n_exponent + 2) / (2 * mp.pi)
    return (scale * sum(w * mp.cos(g) ** n_exponent * mp.sin(g) * cone(g) for g, w in rule),)
