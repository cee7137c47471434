#!/usr/bin/env python3
"""How fast Mitsuba 3 writes the table that `cargo run --release --example fill` writes, and how exactly.

f(θi, θe, δφ) cos θe of a rough gold conductor (GGX, Smith, α = 0.1) at 64 × 256 × 512 angles in RGB, f32:
from the index to the angles, to the directions, to `bsdf.eval`, in one kernel of Mitsuba's LLVM backend
on all cores. δφ = 0 is the mirror direction; all axes include both ends, as gonio's do.

On a fresh Debian bookworm:

    sudo apt-get install python3-venv libllvm19
    python3 -m venv venv && venv/bin/pip install mitsuba numpy
    venv/bin/python scripts/beside_mitsuba.py

Dr.Jit finds the LLVM library by itself; where it finds none, or an old one, set DRJIT_LIBLLVM_PATH, here
/usr/lib/x86_64-linux-gnu/libLLVM.so.19.1 (with LLVM 15 it starts, and aborts at the first BSDF: it cannot
compile `fmaximum`).

What differs from gonio: Mitsuba takes Fresnel's equations with a complex index (gonio: Schlick), Smith's
separable masking G1 G1 (gonio: the height-correlated one), multiplies by cos θe, and writes one array a
channel (row `brdf packed`: RGB side by side, as gonio does). Each row is a kernel:

    fill               three numbers made of the index: what writing costs
    directions         the sum of both directions: what the angles and their sines and cosines add
    no Fresnel         D G1 G1 / (4 cos θi) by MicrofacetDistribution, times a constant colour
    brdf               bsdf.eval
    brdf packed        bsdf.eval, RGB side by side (dr.ravel in the same kernel)
    brdf axes          sines and cosines gathered from three short tables instead of computed
    brdf stored        both directions read from memory, 24 bytes a texel
    brdf frozen        bsdf.eval again, its trace recorded once (dr.freeze)

A run is trace + kernel + wait; the first is told apart: it compiles, or finds the kernel in ~/.drjit. The
values of `brdf` are compared with the same formula in f64 at the exact angles, away from the horizon rows
(θ = π/2), where Mitsuba's side depends on the sign of a rounded cosine.
"""

import argparse
import gc
import json
import statistics
import time

import numpy as np

import mitsuba as mi

mi.set_variant("llvm_ad_rgb")
import drjit as dr  # noqa: E402: Mitsuba chooses the backend first


class Table:
    """Angles of the table, θi slowest and δφ fastest, as Mitsuba makes them from an index."""

    def __init__(self, shape):
        self.shape = shape
        self.texels = shape[0] * shape[1] * shape[2]
        ends = (np.pi / 2, np.pi / 2, np.pi)
        self.axes = [np.linspace(0.0, end, n) for end, n in zip(ends, shape)]
        self.steps = [end / (n - 1) for end, n in zip(ends, shape)]

    def indices(self):
        """(i, e, d) of every texel."""
        _, exits, azimuths = self.shape
        texel = dr.arange(mi.UInt32, self.texels)
        row = texel // azimuths
        return row // exits, row % exits, texel % azimuths

    def directions(self):
        """(ωi, ωe): index to angle to vector."""
        angles = [mi.Float(k) * step for k, step in zip(self.indices(), self.steps)]
        return directions(*(dr.sincos(angle) for angle in angles))

    def axis_tables(self):
        """(sin, cos) along each axis, rounded once from f64."""
        return [(mi.Float(np.sin(a).astype("f4")), mi.Float(np.cos(a).astype("f4"))) for a in self.axes]

    def gathered_directions(self, tables):
        """(ωi, ωe): index to sine and cosine to vector."""
        return directions(*(
            tuple(dr.gather(mi.Float, table, k) for table in pair) for k, pair in zip(self.indices(), tables)
        ))


def directions(theta_i, theta_e, delta_phi):
    """(ωi, ωe) from (sin, cos) of each angle: ωi at φ = 0, ωe at φ = π + δφ."""
    (si, ci), (se, ce), (sd, cd) = theta_i, theta_e, delta_phi
    return mi.Vector3f(si, 0, ci), mi.Vector3f(-se * cd, -se * sd, ce)


def conductor(alpha):
    """Mitsuba's rough gold."""
    return mi.load_dict({"type": "roughconductor", "material": "Au", "distribution": "ggx", "alpha": alpha})


def evaluate(bsdf, wi, wo):
    """f cos θe"""
    si = dr.zeros(mi.SurfaceInteraction3f)
    si.wi = wi
    return bsdf.eval(mi.BSDFContext(), si, wo)


def without_fresnel(alpha, wi, wo):
    """D G1 G1 / (4 cos θi) on the upper side, times F = F0."""
    ggx = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, alpha)
    wm = dr.normalize(wi + wo)
    value = ggx.eval(wm) * ggx.G(wi, wo, wm) / (4 * wi.z)
    # Three different channels: of equal ones Dr.Jit would write one.
    return mi.Color3f(1, 0.78, 0.34) * (value & ((wi.z > 0) & (wo.z > 0)))


def kernels(table, alpha):
    """Name and function of each row; a function returns lazy arrays. Stored inputs are made on the way."""
    bsdf = conductor(alpha)

    def fill():
        texel = mi.Float(dr.arange(mi.UInt32, table.texels))
        return mi.Color3f(texel, texel + 1, texel + 2)

    def direction_sum():
        wi, wo = table.directions()
        return wi + wo

    def brdf():
        return evaluate(bsdf, *table.directions())

    yield "fill", fill
    yield "directions", direction_sum
    yield "no Fresnel", lambda: without_fresnel(alpha, *table.directions())
    yield "brdf", brdf
    yield "brdf packed", lambda: dr.ravel(brdf())
    tables = table.axis_tables()
    yield "brdf axes", lambda: evaluate(bsdf, *table.gathered_directions(tables))
    stored = table.directions()
    dr.eval(stored)
    yield "brdf stored", lambda: evaluate(bsdf, *stored)
    del stored
    # A frozen function wants all that it reads as arguments.
    frozen = dr.freeze(lambda bsdf: evaluate(bsdf, *table.directions()))
    yield "brdf frozen", lambda: frozen(bsdf)


def run(kernel):
    """Seconds to trace one kernel, and to trace, run and wait for it."""
    start = time.perf_counter()
    values = kernel()
    traced = time.perf_counter()
    dr.eval(values)
    dr.sync_thread()
    return traced - start, time.perf_counter() - start


def measure(kernel, runs):
    """The first run compiles; the second still asks the system for memory and is not counted either."""
    dr.sync_thread()
    first = run(kernel)[1]
    run(kernel)
    # Dr.Jit keeps freed arrays and hands them out again: the pages are touched already.
    trace, total = zip(*(run(kernel) for _ in range(runs)))
    return {
        "first_ms": 1e3 * first,
        "min_ms": 1e3 * min(total),
        "median_ms": 1e3 * statistics.median(total),
        "trace_ms": 1e3 * statistics.median(trace),
    }


def reference(table, i, alpha, eta, k):
    """f cos θe at one θi in f64: (θe, δφ, RGB). From angles, so that nothing cancels near the peak."""
    ti, te, d = table.axes[0][i], table.axes[1][:, None], table.axes[2][None, :]
    ci, ce = np.cos(ti), np.cos(te)
    ss = np.sin(ti) * np.sin(te)
    # |ωi + ωe|², tangential and normal part
    ht2 = (np.sin(ti) - np.sin(te)) ** 2 + 4 * ss * np.sin(d / 2) ** 2
    h2 = ht2 + (ci + ce) ** 2
    # GGX: Walter et al. 2007, eq. 33, over |ωi + ωe|²
    ndf = h2**2 / (np.pi * alpha**2 * ((ci + ce) ** 2 + ht2 / alpha**2) ** 2)
    # G1 = 2 / (1 + √(1 + α² tan²θ)): eq. 34
    g1 = lambda c: 2 / (1 + np.sqrt(1 + alpha**2 * (1 - c * c) / (c * c)))  # noqa: E731
    value = ndf * g1(ci) * g1(ce) / (4 * ci)
    return value[..., None] * fresnel_conductor(np.sqrt(h2) / 2, eta, k)


def fresnel_conductor(cos_theta, eta, k):
    """Unpolarised reflectance at a metal of index η + ik."""
    c = cos_theta[..., None].astype(complex)
    index = eta + 1j * k
    ct = np.sqrt(1 - (1 - c * c) / index**2)
    rs = (c - index * ct) / (c + index * ct)
    rp = (index * c - ct) / (index * c + ct)
    return (abs(rs) ** 2 + abs(rp) ** 2) / 2


def relative_errors(table, alpha):
    """|Mitsuba / f64 − 1| of every value at θi, θe < π/2."""
    bsdf = conductor(alpha)
    parameters = mi.traverse(bsdf)
    eta, k = (np.array(parameters[name + ".value"], dtype="f8").ravel() for name in ("eta", "k"))
    values = np.array(evaluate(bsdf, *table.directions())).reshape(3, *table.shape)
    # The width that Mitsuba works with
    alpha = float(np.float32(alpha))
    errors = np.empty((table.shape[0] - 1, table.shape[1] - 1, table.shape[2], 3), dtype="f4")
    for i in range(len(errors)):
        exact = reference(table, i, alpha, eta, k)[:-1]
        errors[i] = abs(np.moveaxis(values[:, i, :-1], 0, -1) / exact - 1)
    i, e, d, _ = np.unravel_index(errors.argmax(), errors.shape)
    worst = [float(np.degrees(axis[n])) for axis, n in zip(table.axes, (i, e, d))]
    return {
        "max": float(errors.max()),
        "p99.9": float(np.quantile(errors, 0.999)),
        "median": float(np.median(errors)),
        "rms": float(np.sqrt(np.mean(errors.astype("f8") ** 2))),
        "worst_at_degrees": worst,
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--shape", type=int, nargs=3, default=[64, 256, 512], metavar=("θi", "θe", "δφ"))
    parser.add_argument("--alpha", type=float, default=0.1, help="GGX width α (0.1)")
    parser.add_argument("--runs", type=int, default=25, help="warm runs of each kernel (25)")
    parser.add_argument("--threads", type=int, help="threads (all cores)")
    parser.add_argument("--only", nargs="+", metavar="ROW", help="these rows, by name")
    parser.add_argument("--no-check", action="store_true", help="do not compare values with f64")
    parser.add_argument("--json", action="store_true", help="print JSON instead of the table")
    arguments = parser.parse_args()
    if min(arguments.shape) < 2 or arguments.runs < 1 or not arguments.alpha > 0:
        parser.error("give at least 2 samples an axis, 1 run and α > 0")
    if arguments.threads:
        dr.set_thread_count(arguments.threads)

    table = Table(arguments.shape)
    result = {
        "mitsuba": mi.__version__,
        "drjit": dr.__version__,
        "variant": mi.variant(),
        "llvm": ".".join(map(str, dr.detail.llvm_version())),
        "threads": dr.thread_count(),
        "shape": table.shape,
        "alpha": arguments.alpha,
        "runs": arguments.runs,
        "rows": {},
    }
    for name, kernel in kernels(table, arguments.alpha):
        if arguments.only and name not in arguments.only:
            continue
        gc.collect()
        times = measure(kernel, arguments.runs)
        times["m_values_per_s"] = table.texels / times["median_ms"] / 1e3
        result["rows"][name] = times
    if arguments.only and len(result["rows"]) < len(arguments.only):
        parser.error(f"rows: {'; '.join(name for name, _ in kernels(table, arguments.alpha))}")
    if not arguments.no_check:
        result["relative_error"] = relative_errors(table, arguments.alpha)

    if arguments.json:
        print(json.dumps(result, indent=2))
    else:
        show(result)


def show(result):
    shape = " × ".join(map(str, result["shape"]))
    print(
        f"Mitsuba {result['mitsuba']}, Dr.Jit {result['drjit']}, {result['variant']},"
        f" LLVM {result['llvm']}, {result['threads']} threads"
    )
    print(f"{shape} RGB, α = {result['alpha']}, {result['runs']} warm runs; ms")
    print(f"{'':16} {'first':>8} {'min':>8} {'median':>8} {'(trace)':>8} {'M RGB/s':>8}")
    for name, t in result["rows"].items():
        ms = " ".join(f"{t[k]:8.2f}" for k in ("first_ms", "min_ms", "median_ms", "trace_ms"))
        print(f"{name:16} {ms} {t['m_values_per_s']:8.0f}")
    if error := result.get("relative_error"):
        at = ", ".join(f"{angle:.1f}°" for angle in error["worst_at_degrees"])
        print(
            f"|value / f64 − 1|: max {error['max']:.1e} at (θi, θe, δφ) = ({at}),"
            f" 99.9 % {error['p99.9']:.1e}, rms {error['rms']:.1e}, median {error['median']:.1e}"
        )


if __name__ == "__main__":
    main()
