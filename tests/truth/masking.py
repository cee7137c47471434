"""Masking and shadowing, G2(ωi, ωe), of a pair of directions and an NDF."""

from mpmath import mp, mpf


def smith_correlated(pair, ndf):
    """Heitz 2014, eq. 99."""
    return 1 / (1 + ndf.smith(pair.wi) + ndf.smith(pair.we))


def smith_separable(pair, ndf):
    """Walter et al. 2007, eq. 23, with G1 = 1/(1 + Λ)."""
    return 1 / (1 + ndf.smith(pair.wi)) / (1 + ndf.smith(pair.we))


def _schlick(pair, k):
    """Schlick 1994: G1 = n·v/(n·v (1 − k) + k)."""
    return pair.mu_i / (pair.mu_i * (1 - k) + k) * pair.mu_e / (pair.mu_e * (1 - k) + k)


def schlick_ggx(pair, ndf):
    """Karis 2013, for image-based light: k = α/2."""
    return _schlick(pair, ndf.alpha / 2)


def schlick_ggx_direct(pair, ndf):
    """Karis 2013, for lights: k = (roughness + 1)²/8, α = roughness²."""
    return _schlick(pair, (mp.sqrt(ndf.alpha) + 1) ** 2 / 8)


def smith_joint_approx(pair, ndf):
    """Hammon 2017: G2/(4 n·l n·v) = 0.5/mix(2 n·l n·v, n·l + n·v, α)."""
    a, product = ndf.alpha, pair.mu_i * pair.mu_e
    return 2 * product / ((1 - a) * 2 * product + a * (pair.mu_i + pair.mu_e))


def v_cavity(pair, _):
    """Cook & Torrance 1982, section 4."""
    n_h, v_h = pair.cos_m, pair.cos_d
    return min(mpf(1), 2 * n_h * pair.mu_e / v_h, 2 * n_h * pair.mu_i / v_h)


def kelemen(pair, _):
    """Kelemen & Szirmay-Kalos 2001: G2/(n·l n·v) = 1/(v·h)² = 4/|l + v|²."""
    h = [a + b for a, b in zip(pair.wi, pair.we)]
    return 4 * pair.mu_i * pair.mu_e / sum(x * x for x in h)


def ashikhmin_neubelt(pair, _):
    """Neubelt & Pettineo 2013: D F/(4 (n·l + n·v − n·l n·v))."""
    n_l, n_v = pair.mu_i, pair.mu_e
    return n_l * n_v / (n_l + n_v - n_l * n_v)


def disney_clearcoat(pair, _):
    """Burley 2012, section 5.6: separable Smith of GGX at α = 0.25, whatever the normals'."""
    a2 = mpf("0.25") ** 2

    def g1(cosine):
        return 2 / (1 + mp.sqrt(1 + a2 * (1 / cosine**2 - 1)))

    return g1(pair.mu_i) * g1(pair.mu_e)


def none(_pair, _ndf):
    return mpf(1)


TERMS = {
    "smith-correlated": smith_correlated,
    "smith-separable": smith_separable,
    "schlick-ggx": schlick_ggx,
    "schlick-ggx-direct": schlick_ggx_direct,
    "smith-joint-approx": smith_joint_approx,
    "v-cavity": v_cavity,
    "kelemen": kelemen,
    "ashikhmin-neubelt": ashikhmin_neubelt,
    "disney-clearcoat": disney_clearcoat,
    "none": none,
}
