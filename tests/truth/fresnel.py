"""Fresnel terms F(c), c = ωi·ωm: a tuple of what the weights multiply, (A, B) of F = F0 A + F90 B or (A,) of F = A."""

from mpmath import mp, mpc, mpf


def schlick(c):
    """Schlick 1994, eq. 15: F0 + (F90 − F0)(1 − c)⁵."""
    return (1 - (1 - c) ** 5, (1 - c) ** 5)


def generalized_schlick(c, exponent):
    """MaterialX's generalized_schlick_bsdf."""
    return (1 - (1 - c) ** mpf(exponent), (1 - c) ** mpf(exponent))


def none(_c):
    return (mpf(1),)


def dielectric(c, eta):
    """Fresnel's equations with Snell's law, sin θt = sin θ/η (Born & Wolf 1999, section 1.5.2), unpolarised."""
    return _interface(c, mpf(eta))


def conductor(c, eta, k):
    """The same with the complex index η + ik (Born & Wolf 1999, section 14.2)."""
    return _interface(c, mpc(eta, k))


def _interface(c, n):
    cos_t = mp.sqrt(1 - (1 - c**2) / n**2)
    r_s = (c - n * cos_t) / (c + n * cos_t)
    r_p = (n * c - cos_t) / (n * c + cos_t)
    return ((abs(r_s) ** 2 + abs(r_p) ** 2) / 2,)


def f82(c, f82):
    """F82-tint, Kutz, Hašan & Edmondson 2021: F = S(c) − a c (1 − c)⁶ with Schlick's S and a such that F(1/7) is
    f82 times S(1/7); linear in F0 and F90, so that each basis is evaluated by itself."""
    seventh = mpf(1) / 7

    def basis(f0, f90):
        def s(c):
            return f0 + (f90 - f0) * (1 - c) ** 5

        a = (1 - mpf(f82)) * s(seventh) / (seventh * (1 - seventh) ** 6)
        return s(c) - a * c * (1 - c) ** 6

    return (basis(1, 0), basis(0, 1))


# KHR_materials_iridescence, "Iridescence Fresnel": value, position and variance of the Gaussians of X, Y and Z, and the
# second one of X.
_GAUSSIANS = (
    (("5.4856e-13", "1.6810e+06", "4.3278e+09"), ("9.7470e-14", "2.2399e+06", "4.5282e+09")),
    (("4.4201e-13", "1.7953e+06", "9.3046e+09"),),
    (("5.2481e-13", "2.2084e+06", "6.6121e+09"),),
)
_XYZ_TO_REC709 = (
    ("3.2404542", "-1.5371385", "-0.4985314"),
    ("-0.9692660", "1.8760108", "0.0415560"),
    ("0.0556434", "-0.2040259", "1.0572252"),
)


def _sensitivity(path, shift, channel):
    """evalSensitivity of the specification; path in nm. Channels between 0, 1 and 2 are mixed linearly (the model's
    documentation)."""
    phase = 2 * mp.pi * path * mpf("1e-9")
    xyz = [
        sum(
            mpf(value) * mp.sqrt(2 * mp.pi * mpf(var)) * mp.cos(mpf(pos) * phase + shift) * mp.exp(-(phase**2) * mpf(var))
            for value, pos, var in gaussians
        )
        / mpf("1.0685e-7")
        for gaussians in _GAUSSIANS
    ]
    rgb = [sum(mpf(m) * x for m, x in zip(row, xyz)) for row in _XYZ_TO_REC709]
    below = min(int(channel), 1)
    return rgb[below] + (channel - below) * (rgb[below + 1] - rgb[below])


def thin_film(c, thickness, film_eta, f0, channel):
    """KHR_materials_iridescence after Belcour & Barla 2017, with air outside. Two departures, both documented by the
    model: R12 R23 is not clamped, and in place of max(I, 0) stands (I + √(I² + ε²))/2, ε = 1/256."""
    thickness, film_eta, f0, channel = mpf(thickness), mpf(film_eta), mpf(f0), mpf(channel)
    x = min(max(thickness / mpf("0.03"), mpf(0)), mpf(1))
    eta = 1 + (film_eta - 1) * x * x * (3 - 2 * x)  # mix(outside, film, smoothstep(0, 0.03, thickness))
    cos_2 = mp.sqrt(1 - (1 - c**2) / eta**2)

    def f0_of(inside, outside):
        return ((inside - outside) / (inside + outside)) ** 2

    def f_schlick(r0, cosine):
        return r0 + (1 - r0) * (1 - cosine) ** 5

    root = mp.sqrt(f0 + mpf("0.0001"))
    base = (1 + root) / (1 - root)
    r_12 = f_schlick(f0_of(eta, mpf(1)), c)
    t_121 = 1 - r_12
    r_23 = f_schlick(f0_of(base, eta), cos_2)
    phi = mp.pi + (mp.pi if base < eta else 0)  # φ21 = π − φ12, φ12 = 0 where the film is not thinner than air
    path = 2 * eta * thickness * cos_2

    r_123 = mp.sqrt(r_12 * r_23)
    r_s = t_121**2 * r_23 / (1 - r_12 * r_23)
    i = r_12 + r_s
    c_m = r_s - t_121
    for m in (1, 2):
        c_m *= r_123
        i += c_m * 2 * _sensitivity(m * path, m * phi, channel)
    return ((i + mp.sqrt(i**2 + mpf(1) / 256**2)) / 2,)


TERMS = {
    "schlick": schlick,
    "generalized-schlick": generalized_schlick,
    "none": none,
    "dielectric": dielectric,
    "conductor": conductor,
    "f82": f82,
    "thin-film": thin_film,
}
