"""Distributions of microfacet normals, D(ωm), each with Smith's Λ(ω).

Smith's Λ is that of the distribution itself for GGX and Beckmann. Blinn-Phong takes Beckmann's (Walter et al. 2007,
section 5.2), GTR takes GGX's (Burley 2012, section 5.6), and Charlie a fit (Estevez & Kulla 2017).
"""

from mpmath import mp, mpf

from geometry import tan_of


def smith_ggx(alpha, tangent):
    """Walter et al. 2007, eq. 34: G1 = 2/(1 + √(1 + α² tan²θ)); Λ = 1/G1 − 1."""
    g1 = 2 / (1 + mp.sqrt(1 + alpha**2 * tangent**2))
    return 1 / g1 - 1


def smith_beckmann(alpha, tangent):
    """Walter et al. 2007, section 5.2: G1 = 2/(1 + erf a + e^(−a²)/(a √π)), a = 1/(α tan θ), not its rational fit."""
    if tangent == 0:
        return mpf(0)
    a = 1 / (alpha * tangent)
    # 1 + erf a = 2 − erfc a
    lost = mp.exp(-(a**2)) / (a * mp.sqrt(mp.pi)) - mp.erfc(a)
    g1 = 2 / (2 + lost)
    return 1 / g1 - 1


class Isotropic:
    def __init__(self, alpha):
        self.alpha = mpf(alpha)


class Ggx(Isotropic):
    def d(self, wm):
        """Walter et al. 2007, eq. 33."""
        a2 = self.alpha**2
        return a2 / (mp.pi * wm[2] ** 4 * (a2 + tan_of(wm) ** 2) ** 2)

    def smith(self, w):
        return smith_ggx(self.alpha, tan_of(w))


class Beckmann(Isotropic):
    def d(self, wm):
        """Walter et al. 2007, eq. 25."""
        a2 = self.alpha**2
        return mp.exp(-(tan_of(wm) ** 2) / a2) / (mp.pi * a2 * wm[2] ** 4)

    def smith(self, w):
        return smith_beckmann(self.alpha, tan_of(w))


class BlinnPhong(Isotropic):
    def d(self, wm):
        """Walter et al. 2007, eq. 30: D = (p + 2)/2π cos^p θm, p = 2/α² − 2 (section 5.2)."""
        p = 2 / self.alpha**2 - 2
        return (p + 2) / (2 * mp.pi) * wm[2] ** p

    def smith(self, w):
        return smith_beckmann(self.alpha, tan_of(w))


class Gtr(Isotropic):
    """Generalised Trowbridge-Reitz: Burley 2012, appendix B; α is 0.001 at least, as in disney.brdf."""

    def __init__(self, alpha, gamma):
        super().__init__(max(mpf(alpha), mpf("0.001")))
        self.gamma = mpf(gamma)

    def d(self, wm):
        a2, gamma = self.alpha**2, self.gamma
        if a2 == 1:
            return 1 / mp.pi
        if gamma == 1:  # eq. 4
            scale = (a2 - 1) / (mp.pi * mp.log(a2))
        else:  # eq. 2
            scale = (gamma - 1) * (a2 - 1) / (mp.pi * (1 - a2 ** (1 - gamma)))
        return scale / (1 + (a2 - 1) * wm[2] ** 2) ** gamma

    def smith(self, w):
        return smith_ggx(self.alpha, tan_of(w))


class StudentT(Isotropic):
    """Ribardière et al. 2017: slopes (p, q) of density P22 = (γ − 1)^γ α^(2γ − 2)/(π ((γ − 1) α² + p² + q²)^γ)."""

    def __init__(self, alpha, gamma):
        super().__init__(alpha)
        self.gamma = mpf(gamma)

    def d(self, wm):
        """P22/cos⁴θm."""
        g, a = self.gamma, self.alpha
        p22 = (g - 1) ** g * a ** (2 * g - 2) / (mp.pi * ((g - 1) * a**2 + tan_of(wm) ** 2) ** g)
        return p22 / wm[2] ** 4

    def smith(self, w):
        """Λ = 1/c ∫_c^∞ (q − c) P2(q) dq, c = cot θ; P2 = ∫ P22 dp, as ∫ (B + p²)^(−γ) dp = √π Γ(γ − ½)/Γ(γ) B^(½ − γ)."""
        if w[0] == 0 and w[1] == 0:
            return mpf(0)
        g, a, c = self.gamma, self.alpha, 1 / tan_of(w)
        b = (g - 1) * a**2
        scale = (g - 1) ** g * a ** (2 * g - 2) * mp.gamma(g - 0.5) / (mp.sqrt(mp.pi) * mp.gamma(g))
        mean = (b + c**2) ** (mpf(3) / 2 - g) / (2 * g - 3)
        # ∫_c^∞ (b + q²)^(½ − γ) dq, by powers of b/q²
        beyond = c ** (2 - 2 * g) / (2 * g - 2) * mp.hyp2f1(g - 0.5, g - 1, g, -b / c**2)
        return scale * (mean - c * beyond) / c


class Charlie(Isotropic):
    """Estevez & Kulla 2017; α is 0.005 at least, as renderers have it (documented in the model)."""

    # Table 1: parameters of L at r = 0 and r = 1.
    AT_0 = ("25.3245", "3.32435", "0.16801", "-1.27393", "-4.85967")
    AT_1 = ("21.5473", "3.82987", "0.19823", "-1.97760", "-4.32054")

    def __init__(self, alpha):
        super().__init__(max(mpf(alpha), mpf("0.005")))

    def d(self, wm):
        """Eq. 2."""
        sine = mp.hypot(wm[0], wm[1])
        return (2 + 1 / self.alpha) * sine ** (1 / self.alpha) / (2 * mp.pi)

    def fit(self, x):
        """L of eq. 3 and the text below it: p = (1 − r)² p0 + (1 − (1 − r)²) p1."""
        share = (1 - self.alpha) ** 2
        a, b, c, d, e = (share * mpf(p) + (1 - share) * mpf(q) for p, q in zip(self.AT_0, self.AT_1))
        return a / (1 + b * x**c) + d * x + e

    def smith(self, w):
        """Eq. 4, without the terminator of eq. 5."""
        cosine, half = w[2], mpf("0.5")
        if cosine < half:
            return mp.exp(self.fit(cosine))
        return mp.exp(2 * self.fit(half) - self.fit(1 - cosine))


class Anisotropic:
    """αx along the tangent, αy along the bitangent. Here α = √(αx αy), aspect = αx/αy; then, by a strength s as in
    KHR_materials_anisotropy, αx is mixed with 1: αx (1 − s²) + s²."""

    def __init__(self, alpha, aspect, strength):
        self.alpha = mpf(alpha)
        root = mp.sqrt(mpf(aspect))
        share = mpf(strength) ** 2
        self.x = self.alpha * root * (1 - share) + share
        self.y = self.alpha / root

    def stretched(self, wm):
        """tan²θm (cos²φm/αx² + sin²φm/αy²)"""
        return (wm[0] / (wm[2] * self.x)) ** 2 + (wm[1] / (wm[2] * self.y)) ** 2

    def seen_from(self, w):
        """α that Λ sees: Heitz 2014, eq. 80, √(cos²φ αx² + sin²φ αy²)."""
        sine = mp.hypot(w[0], w[1])
        return mp.hypot(w[0] * self.x, w[1] * self.y) / sine if sine else self.alpha


class GgxAnisotropic(Anisotropic):
    def d(self, wm):
        """Heitz 2014, eq. 85."""
        return 1 / (mp.pi * self.x * self.y * wm[2] ** 4 * (1 + self.stretched(wm)) ** 2)

    def smith(self, w):
        """Heitz 2014, eq. 86."""
        return smith_ggx(self.seen_from(w), tan_of(w))


class BeckmannAnisotropic(Anisotropic):
    def d(self, wm):
        """Heitz 2014, eq. 83."""
        return mp.exp(-self.stretched(wm)) / (mp.pi * self.x * self.y * wm[2] ** 4)

    def smith(self, w):
        """Heitz 2014, eq. 84."""
        return smith_beckmann(self.seen_from(w), tan_of(w))
