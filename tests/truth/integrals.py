"""ρ_dh and ρ_hh: each twice, by a rule and by a finer one; what both agree on is written, 20 digits at least.

ρ_hh = 2 ∫ ρ_dh(μ) μ dμ = 2 ∫ ρ_dh cos θ sin θ dθ.
"""

from multiprocessing import Pool

from mpmath import mp, mpf

import cases
import fresnel
import hemisphere
import masking
import models
import ndf
from geometry import direction
from quadrature import panels, tanh_sinh

WORKING_DIGITS = 38
LEAST_DIGITS, MOST_DIGITS = 20, 30
THETAS = (0.0, 0.6, 1.2, 1.5)

# Rules, coarse and fine.
COUNTS = {"normals": (20, 24), "definition": (18, 22), "opposite": (24, 28), "rings": (24, 30), "axis": (30, 40)}


def jobs():
    """(way, model, parameters, theta_i), theta_i None for ρ_hh."""
    for name in fresnel.TERMS:
        model = "mirror" if name == "schlick" else f"mirror-{name}"
        for parameters in cases.FRESNEL[name]:
            yield from (("mirror", model, parameters, theta) for theta in (*THETAS, None))

    yield from _wide("lambert", ({},), (*THETAS, None))
    yield from _wide("oren-nayar", cases.SIGMA[1:], (*THETAS, None))
    for model in ("fujii", "burley", "frostbite", "disney-subsurface"):
        yield from _wide(model, cases.ROUGHNESS[1:], (*THETAS, None))
    yield from _wide("eon", cases.EON[1:], (*THETAS, None))
    yield from _wide("ashikhmin-shirley-diffuse", ({},), (*THETAS, None))
    for model in ("gltf_diffuse", "disney-sheen"):
        yield from (("opposite", model, {}, theta) for theta in THETAS)

    for model in ("ggx", "beckmann", "ward-dur"):
        for alpha in (0.1, 0.5, 1.0):
            yield from (("normals", model, {"alpha": alpha}, theta) for theta in THETAS)
    for model in ("blinn", "blinn-phong", "ggx-smith-separable-none", "ggx-smith-separable-schlick"):
        yield from (("normals", model, {"alpha": 0.5}, theta) for theta in (0.0, 1.2))
    for mask in ("schlick-ggx", "schlick-ggx-direct", "kelemen", "ashikhmin-neubelt", "disney-clearcoat"):
        yield "normals", f"ggx-{mask}-schlick", {"alpha": 0.5}, 0.6
    for gamma in (1.0, 1.5, 3.0):
        yield "normals", "gtr", {"alpha": 0.5, "gamma": gamma}, 0.6
    for alpha in (0.25, 0.5):  # 1/α is even, and D analytic
        yield from (("rings", "charlie", {"alpha": alpha}, theta) for theta in (0.6, 1.2, 1.5))

    for alpha in (0.001, 0.1, 0.5, 1.0):
        yield from (("axis", "phong", {"alpha": alpha}, theta) for theta in THETAS)
    for alpha, cxy, cz in ((0.1, -1.0, 0.75), (0.5, 0.5, 1.0), (1.0, 1.0, 0.5)):
        yield from (("axis", "lafortune", {"alpha": alpha, "cxy": cxy, "cz": cz}, theta) for theta in THETAS)
    yield "uniform", "ggx-smith-correlated-none", {"alpha": 1.0}, None


def _wide(model, settings, thetas):
    return (("definition", model, parameters, theta) for parameters in settings for theta in thetas)


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
        gaussian = model.startswith(("beckmann", "ward"))
        reach = 9 if gaussian else None  # e^(−81)
        return lambda theta, n: hemisphere.by_normals(lobe, theta, mpf(parameters["alpha"]), n, reach)
    return lambda theta, n: hemisphere.by_definition(lobe, theta, n, way == "opposite")


def _about_axis(model, alpha, cxy=-1.0, cz=1.0):
    """Lafortune's lobe is |Cωi|^k times that about the axis Cωi; Phong's has C = (−1, 1)."""
    k = 2 / mpf(alpha) ** 2 - 1

    def rho(theta, n):
        x, z = mpf(cxy) * mp.sin(theta), mpf(cz) * mp.cos(theta)
        (about,) = hemisphere.about_axis(k, mp.atan2(abs(x), z), n)
        return (mp.hypot(x, z) ** k * about,)

    return rho


def rho_hh(way, model, parameters, n):
    half = +mp.pi / 2
    if way == "uniform":  # GGX of α = 1: f depends on cosines alone, and is singular where both are 0
        lobe = models.lobe(model, parameters)
        rule = tanh_sinh([mpf(0), half], 1 / mpf(n))
        rule = [(mp.sin(t) * mp.cos(t) * w, direction(t, mpf(0))) for t, w in rule if 0 < t < half]
        return tuple([sum(4 * mp.pi * v * w * lobe(hemisphere.Pair(wi, we))[0] for v, wi in rule for w, we in rule)])
    rho = rho_dh(way, model, parameters)
    rule = tanh_sinh([mpf(0), half], 1 / mpf(n)) if way == "mirror" else panels([mpf(0), half], n)
    return hemisphere._sum((2 * mp.sin(t) * mp.cos(t) * w, rho(t, n)) for t, w in rule)


def evaluate(job):
    way, model, parameters, theta = job
    mp.dps = WORKING_DIGITS
    counts = COUNTS.get(way, (24, 32))
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
            texts = []
            for x, digits in components:
                assert digits >= LEAST_DIGITS, (model, parameters, theta, digits)
                texts.append(number(x, digits))
            quantity, angle = ("rho_hh", "") if theta is None else ("rho_dh", double(theta))
            yield [model, parameters_text(parameters), quantity, angle, *[*texts, ""][:2]]
