"""Diffuse lobes: f over its weight (albedo, color), one component."""

from mpmath import mp, mpf

from geometry import dot


def lambert(_pair):
    """Lambert 1760."""
    return 1 / mp.pi


def gltf_diffuse(pair):
    """glTF 2.0, Appendix B.3.5: (1 − F)·c_diff/π with F of black f0 and white f90: what fresnel_mix leaves."""
    return (1 - (1 - pair.cos_d) ** 5) / mp.pi


def oren_nayar(pair, sigma):
    """Oren & Nayar 1994, the qualitative model without interreflection (0.33 in A); σ in rad, ρ = 1."""
    s2 = mpf(sigma) ** 2
    a = 1 - mpf("0.5") * s2 / (s2 + mpf("0.33"))
    b = mpf("0.45") * s2 / (s2 + mpf("0.09"))
    theta_i, theta_e = mp.acos(pair.mu_i), mp.acos(pair.mu_e)
    sines = mp.hypot(*pair.wi[:2]) * mp.hypot(*pair.we[:2])
    cos_phi = (pair.wi[0] * pair.we[0] + pair.wi[1] * pair.we[1]) / sines if sines else mpf(0)
    alpha, beta = max(theta_i, theta_e), min(theta_i, theta_e)
    return (a + b * max(mpf(0), cos_phi) * mp.sin(alpha) * mp.tan(beta)) / mp.pi


def gltf_oren_nayar(pair, sigma):
    """KHR_materials_diffuse_roughness (draft): the same under what fresnel_mix leaves."""
    return (1 - (1 - pair.cos_d) ** 5) * oren_nayar(pair, sigma)


def fujii(pair, roughness):
    """Fujii, A tiny improvement of Oren-Nayar reflectance model, the second pair of A and B; ρ = 1."""
    sigma = mpf(roughness)
    a = 1 / (mp.pi + (mp.pi / 2 - mpf(2) / 3) * sigma)
    b = sigma * a
    s = dot(pair.wi, pair.we) - pair.mu_i * pair.mu_e
    t = max(pair.mu_i, pair.mu_e) if s > 0 else mpf(1)
    return a + b * s / t


def eon_albedo(mu, r):
    """E_FON_exact of listing 1 in Portsmouth, Kutz & Hill 2025."""
    a = 1 / (1 + (mpf(1) / 2 - 2 / (3 * mp.pi)) * r)
    s = mp.sqrt(1 - mu**2)
    g = s * (mp.acos(mu) - s * mu) + mpf(2) / 3 * ((s / mu) * (1 - s**3) - s)
    return a + r * a * g / mp.pi


def eon(pair, roughness, albedo):
    """f_EON of listing 1, exact; without its ε = 1e-7, which guards 0/0 at r = 0 alone."""
    r, rho = mpf(roughness), mpf(albedo)
    a = 1 / (1 + (mpf(1) / 2 - 2 / (3 * mp.pi)) * r)
    s = dot(pair.wi, pair.we) - pair.mu_i * pair.mu_e
    s_over_t = s / max(pair.mu_i, pair.mu_e) if s > 0 else s
    single = rho / mp.pi * a * (1 + r * s_over_t)
    if r == 0:
        return single
    mean = a * (1 + (mpf(2) / 3 - 28 / (15 * mp.pi)) * r)
    rho_ms = rho**2 * mean / (1 - rho * (1 - mean))
    lost = (1 - eon_albedo(pair.mu_i, r)) * (1 - eon_albedo(pair.mu_e, r)) / (1 - mean)
    return single + rho_ms / mp.pi * lost


def _schlick(f90, cosine):
    """F_Schlick of f0 = 1."""
    return 1 + (f90 - 1) * (1 - cosine) ** 5


def burley(pair, roughness):
    """Burley 2012, section 5.3."""
    f90 = mpf("0.5") + 2 * mpf(roughness) * pair.cos_d**2
    return _schlick(f90, pair.mu_i) * _schlick(f90, pair.mu_e) / mp.pi


def frostbite(pair, roughness):
    """Lagarde & de Rousiers 2014, Fr_DisneyDiffuse over π, of linearRoughness."""
    r = mpf(roughness)
    bias = (1 - r) * 0 + r * mpf("0.5")
    factor = (1 - r) * 1 + r * (1 / mpf("1.51"))
    f90 = bias + 2 * r * pair.cos_d**2
    return factor * _schlick(f90, pair.mu_i) * _schlick(f90, pair.mu_e) / mp.pi


def disney_subsurface(pair, roughness):
    """ss of BRDF Explorer's disney.brdf (Burley 2012) over π, base colour 1."""
    fss90 = mpf(roughness) * pair.cos_d**2
    fss = _schlick(fss90, pair.mu_i) * _schlick(fss90, pair.mu_e)
    return mpf("1.25") * (fss * (1 / (pair.mu_i + pair.mu_e) - mpf("0.5")) + mpf("0.5")) / mp.pi


def disney_sheen(pair):
    """FH of BRDF Explorer's disney.brdf (Burley 2012): what sheen · Csheen weighs."""
    return (1 - pair.cos_d) ** 5
