"""ρ_dh and ρ_hh: each twice, by a rule and by a finer one; what both agree on is written, 20 digits at least.

ρ_hh = 2 ∫ ρ_dh(μ) μ dμ = 2 ∫ ρ_dh cos θ sin θ dθ.
"""

import sys
from multiprocessing import Pool

from mpmath import mp, mpf

import cases
import fresnel
import hemisphere
import masking
import models
import ndf
from geometry import Pair, direction
from quadrature import panels, tanh_sinh

WORKING_DIGITS = 36
LEAST_DIGITS, MOST_DIGITS = 20, 30
THETAS = (0.0, 0.6, 1.2, 1.5)

# Rules, coarse and fine.
COUNTS = {
    "normals": (20, 24),
    "flat": (17, 21),
    "definition": (16, 18),
    "opposite": (22, 26),
    "rings": (20, 24),
    "axis": (32, 40),
    "uniform": (14, 20),
    "mirror": (64, 96),
}


def jobs():
    """(way, model, parameters, theta_i), theta_i None for ρ_hh."""
    for alpha in (0.1, 0.5, 1.0):
        yield from (("normals", "ggx", {"alpha": alpha}, theta) for theta in (THETAS if alpha > 0.1 else THETAS[:3]))
    for alpha, thetas in ((0.1, (0.0, 0.6)), (0.5, (0.0,)), (1.0, (0.0, 1.2))):
        yield from (("normals", "beckmann", {"alpha": alpha}, theta) for theta in thetas)

    yield from (("definition", "lambert", {}, theta) for theta in (*THETAS, None))
    yield from (("definition", "ashikhmin-shirley-diffuse", {}, theta) for theta in THETAS)
    settings = {"oren-nayar": cases.SIGMA, "eon": cases.EON}
    for model in ("oren-nayar", "fujii", "eon", "burley", "frostbite", "disney-subsurface"):
        thetas = THETAS if model != "disney-subsurface" else (0.0, 0.6, 1.0)
        for parameters in settings.get(model, cases.ROUGHNESS)[1:]:
            yield from (("definition", model, parameters, theta) for theta in thetas)
    for model in ("oren-nayar", "fujii", "eon", "burley"):
        yield "definition", model, settings.get(model, cases.ROUGHNESS)[2], None

    for alpha in (0.001, 0.1, 0.5, 1.0):
        yield from (("axis", "phong", {"alpha": alpha}, theta) for theta in THETAS)
    for alpha, cxy, cz in ((0.1, -1.0, 0.75), (0.5, 0.5, 1.0), (1.0, 1.0, 0.5)):
        yield from (("axis", "lafortune", {"alpha": alpha, "cxy": cxy, "cz": cz}, theta) for theta in (0.6, 1.2))
    yield "uniform", "ggx-smith-correlated-none", {"alpha": 1.0}, None

    # 1/α is even, and D analytic.
    for alpha, thetas in ((0.25, (0.0, 0.6, 1.2)), (0.5, (0.0, 0.6))):
        yield from (("rings", "charlie", {"alpha": alpha}, theta) for theta in thetas)
    for alpha, thetas in ((0.1, (0.0,)), (0.5, (0.0, 0.6, 1.2)), (1.0, (0.0, 0.6, 1.2))):
        yield from (("normals", "ward-dur", {"alpha": alpha}, theta) for theta in thetas)

    for name in fresnel.TERMS:
        model = "mirror" if name == "schlick" else f"mirror-{name}"
        for parameters in cases.FRESNEL[name]:
            yield from (("mirror", model, parameters, theta) for theta in (0.0, 1.2, 1.5, None))
    masks = "smith-separable schlick-ggx schlick-ggx-direct smith-joint-approx kelemen ashikhmin-neubelt disney-clearcoat"
    for mask in masks.split():
        yield "normals", f"ggx-{mask}-schlick", {"alpha": 0.5}, 0.6
    for gamma in (1.0, 1.5, 3.0):
        yield "normals", "gtr", {"alpha": 0.5, "gamma": gamma}, 0.6
    yield "normals", "student-t", {"alpha": 0.5, "gamma": 3.0}, 0.6
    yield from (("normals", "blinn", {"alpha": 0.5}, theta) for theta in (0.0, 1.2))
    yield "normals", "blinn-phong", {"alpha": 0.5}, 0.0
    for model in ("gltf_diffuse", "disney-sheen"):
        yield from (("opposite", model, {}, theta) for theta in (0.0, 0.6, 1.2))


def mirror(model, parameters):
    """f = F δ(θi − θe) δ(φi + π − φe)/(cos θi sin θi), so that ρ_dh = F."""
    term = fresnel.TERMS["schlick" if model == "mirror" else model.removeprefix("mirror-")]
    return lambda theta, _n: term(mp.cos(theta), **parameters)


def rho_dh(way, model, parameters):
    """ρ_dh as a function of theta_i and of how fine."""
    if way == "mirror":
        return mirror(model, parameters)
    if way == "axis":
        return _about_axis(model, **parameters)
    if way == "rings":
        normals, unmasked = ndf.Charlie(parameters["alpha"]), models.lobe("charlie-none-schlick", parameters)
        return lambda theta, n: hemisphere.by_rings(
            unmasked, lambda pair: masking.smith_correlated(pair, normals), theta, n
        )
    lobe = models.lobe(model, parameters)
    if way == "normals":
        alpha = mpf(parameters["alpha"])
        reach = 9 if model.startswith(("beckmann", "ward")) else None  # e^(−81)
        flat = _is_flat(model, parameters)
        return lambda theta, n: hemisphere.by_normals(lobe, theta, alpha, n, reach, flat)
    return lambda theta, n: hemisphere.by_definition(lobe, theta, n, way == "opposite")


def _is_flat(model, parameters):
    """Whether Beckmann's Λ, e^(−1/(α tan θ)²) where it is flat, is to be seen there."""
    return parameters["alpha"] > 0.1 and model.startswith(("beckmann", "blinn-phong"))


def _about_axis(model, alpha, cxy=-1.0, cz=1.0):
    """Lafortune's lobe is |Cωi|^k times that about the axis Cωi; Phong's has C = (−1, 1)."""
    k = 2 / mpf(alpha) ** 2 - 1

    def rho(theta, n):
        x, z = mpf(cxy) * mp.sin(theta), mpf(cz) * mp.cos(theta)
        (about,) = hemisphere.about_axis(k, mp.atan2(abs(x), z), n, mpf(alpha))
        return (mp.hypot(x, z) ** k * about,)

    return rho


def rho_hh(way, model, parameters, n):
    half = +mp.pi / 2
    if way == "uniform":  # GGX of α = 1: f depends on cosines alone, and is singular where both are 0
        lobe = models.lobe(model, parameters)
        rule = tanh_sinh([mpf(0), half], 1 / mpf(n))
        rule = [(mp.sin(t) * mp.cos(t) * w, direction(t, mpf(0))) for t, w in rule if 0 < t < half]
        return (sum(4 * mp.pi * v * w * lobe(Pair(wi, we))[0] for v, wi in rule for w, we in rule),)
    rho = rho_dh(way, model, parameters)
    rule = tanh_sinh([mpf(0), half], 1 / mpf(n)) if way == "mirror" else panels([mpf(0), half], n)
    return hemisphere.total((2 * mp.sin(t) * mp.cos(t) * w, rho(t, n)) for t, w in rule)


def evaluate(job):
    way, model, parameters, theta = job
    mp.dps = WORKING_DIGITS
    counts = COUNTS["flat" if way == "normals" and _is_flat(model, parameters) else way]
    if theta is None:
        coarse, fine = (rho_hh(way, model, parameters, n) for n in counts)
    else:
        coarse, fine = (rho_dh(way, model, parameters)(mpf(theta), n) for n in counts)
    return job, [(x, _agreed(x, y)) for x, y in zip(fine, coarse)]


def _agreed(x, y):
    if x == y:
        return MOST_DIGITS
    return min(MOST_DIGITS, int(mp.floor(-mp.log10(abs(x - y) / abs(x)))))


def rows(number, double, parameters_text):
    with Pool(2) as pool:
        for (_, model, parameters, theta), components in pool.imap(evaluate, list(jobs())):
            if min(digits for _, digits in components) < LEAST_DIGITS:
                print("left out:", model, parameters, theta, [digits for _, digits in components], file=sys.stderr)
                continue
            quantity, angle = ("rho_hh", "") if theta is None else ("rho_dh", double(theta))
            texts = [number(x, digits) for x, digits in components]
            yield [model, parameters_text(parameters), quantity, angle, *[*texts, ""][:2]]
