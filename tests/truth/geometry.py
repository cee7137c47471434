"""A pair of directions as unit vectors, from four angles that are exact binary doubles."""

from mpmath import mp, mpf

mp.dps = 80

LEAST_COSINE = mpf(2) ** -24  # nearer to the horizon f is that of this cosine; no case goes there


def direction(theta, phi):
    return (mp.sin(theta) * mp.cos(phi), mp.sin(theta) * mp.sin(phi), mp.cos(theta))


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def tan_of(w):
    """tan θ of a direction."""
    return mp.hypot(w[0], w[1]) / w[2]


class Pair:
    """ωi and ωe, both away from the surface, and ωm = (ωi + ωe)/|ωi + ωe| unless it is given."""

    def __init__(self, wi, we, wm=None):
        self.wi, self.we = wi, we
        if wm is None:
            h = tuple(a + b for a, b in zip(wi, we))
            length = mp.sqrt(dot(h, h))
            wm = tuple(a / length for a in h)
        self.wm = wm
        self.mu_i, self.mu_e = wi[2], we[2]
        # ωi·ωm = ωe·ωm; of equal directions exactly 1, as 1 − cos_d is then no rounding error but 0.
        self.cos_d = dot(wi, self.wm) if wi != we else mpf(1)
        self.cos_m = self.wm[2]

    @classmethod
    def of_angles(cls, theta_i, phi_i, theta_e, phi_e):
        pair = cls(direction(mpf(theta_i), mpf(phi_i)), direction(mpf(theta_e), mpf(phi_e)))
        assert min(pair.mu_i, pair.mu_e) > LEAST_COSINE
        return pair
