"""Rules for the integrals: Gauss-Legendre on panels, and tanh-sinh for what is singular at the ends of an interval."""

from functools import lru_cache

from mpmath import mp, mpf


@lru_cache(maxsize=None)
def gauss_legendre(n):
    """[(x, weight)] on [0, 1], to the working precision of the first call."""
    rule = []
    for k in range(n):
        x = mp.cos(mp.pi * (k + mpf("0.75")) / (n + mpf("0.5")))
        for _ in range(8):  # Newton's method, from 2 digits to 80 and more
            p, q = mpf(1), x
            for j in range(2, n + 1):
                p, q = q, ((2 * j - 1) * x * q - (j - 1) * p) / j
            slope = n * (x * q - p) / (x * x - 1)
            x -= q / slope
        rule.append(((1 + x) / 2, 1 / ((1 - x * x) * slope**2)))
    return rule


def panels(breaks, n):
    """[(x, weight)] over consecutive intervals, n nodes each."""
    return [
        (a + (b - a) * x, (b - a) * weight)
        for a, b in zip(breaks, breaks[1:])
        if b > a
        for x, weight in gauss_legendre(n)
    ]


def tanh_sinh(breaks, step):
    """[(x, weight)] over consecutive intervals, by x = a + (b − a)/(1 + e^(−2s)), s = π/2 sinh t, |t| ≤ 4."""
    count = int(4 / step)
    rule = []
    for a, b in zip(breaks, breaks[1:]):
        for t in (k * step for k in range(-count, count + 1)):
            s = mp.pi / 2 * mp.sinh(t)
            slope = step * mp.pi * mp.cosh(t) / (4 * mp.cosh(s) ** 2)
            rule.append((a + (b - a) / (1 + mp.exp(-2 * s)), (b - a) * slope))
    return rule


def graded(end, first, most):
    """Ends of panels over [0, end]: the last is `first` long, each before it up to twice as long, `most` at most."""
    breaks, length = [end], first
    while breaks[0] > length:
        breaks.insert(0, breaks[0] - length)
        length = min(2 * length, most)
    return [mpf(0), *breaks]
