"""Twelve (parameters, angles) of each model. All numbers are Python floats: exact binary doubles."""

from math import pi

GRAZING = 89.9 * pi / 180

# alpha, theta_i, phi_i, theta_e, phi_e of lobes about the half vector.
LOBES = [
    (0.001, 0.0, 0.0, 2e-4, 1.0),  # the normal, ωm 1e-4 rad from the peak
    (0.001, 0.7, 0.0, 0.7001, pi),  # 1e-4 rad from the mirror direction, in the plane of incidence
    (0.001, 1.2, 0.3, 1.2, 0.3 + pi + 1e-4),  # and across it
    (0.001, GRAZING, 0.0, GRAZING - 1e-4, pi),
    (0.1, 0.0, 0.0, 0.0, 0.0),
    (0.1, 0.5, 1.0, 0.6, 4.3),
    (0.1, 0.1, 0.0, 0.15, pi / 2),  # perpendicular azimuths
    (0.1, 0.12, 2.0, 0.12, 2.0),  # retro-reflection
    (0.5, 0.7, 0.5, 0.7, 0.5),
    (0.5, GRAZING, 0.25, 0.1, 0.25 + pi / 2),
    (1.0, GRAZING, 0.0, GRAZING, pi / 2),
    (1.0, 0.9, 5.0, 1.4, 2.2),
]

# The same of Gaussians of slopes, of which nothing is left where both directions graze.
SLOPES = [*LOBES[:10], (1.0, GRAZING, 0.0, 1.0, pi / 2), LOBES[11]]

# The same of Charlie, whose normals lean; 0.001 is below the least α that it takes.
FIBRES = [
    (0.001, 1.5, 0.0, 1.55, 0.1),
    (0.01, 1.5, 0.0, 1.5, 0.0),
    (0.01, GRAZING, 0.0, GRAZING, pi / 2),
    (0.01, 1.4, 1.0, 1.5, 1.3),
    (0.1, 0.9, 0.0, 0.9, 0.0),
    (0.1, 0.5, 0.0, 1.2, 1.0),
    (0.1, GRAZING, 0.25, 0.1, 0.25 + pi / 2),
    (0.5, 0.7, 0.0, 0.7001, pi),
    (0.5, 0.0, 0.0, 0.4, 1.0),
    (0.5, 1.0, 5.0, 1.1, 2.2),
    (1.0, GRAZING, 0.0, 1.3, 3.0),
    (1.0, 0.9, 5.0, 1.4, 2.2),
]

# theta_i, phi_i, theta_e, phi_e of lobes as wide as the hemisphere.
WIDE = [
    (0.0, 0.0, 0.0, 0.0),
    (0.0, 0.0, 1.2, 1.0),
    (0.7, 0.0, 0.7, pi),  # the mirror direction
    (0.7, 0.0, 0.7, 0.0),  # retro-reflection
    (1.2, 0.3, 1.4, 0.3),
    (0.9, 0.0, 0.6, pi / 2),  # perpendicular azimuths
    (0.9, 5.0, 1.4, 2.2),
    (0.3, 1.0, 1.0, 1.8),
    (GRAZING, 0.0, GRAZING, 0.0),
    (GRAZING, 0.0, GRAZING, pi),
    (GRAZING, 0.25, 0.1, 0.25 + pi / 2),
    (1.5, 2.0, GRAZING, 0.5),
]

# alpha, cxy, cz, theta_i, phi_i, theta_e, phi_e of Lafortune's.
ABOUT_AXES = [
    (0.001, -1.0, 1.0, 0.7, 0.0, 0.7001, pi),
    (0.001, -1.0, 1.0, 1.2, 0.3, 1.2, 0.3 + pi + 1e-4),
    (0.001, 1.0, 1.0, 0.7, 0.5, 0.7001, 0.5),  # back
    (0.001, 1.0, 1.0, GRAZING, 2.0, GRAZING - 1e-4, 2.0001),
    (0.1, -1.0, 0.9, 1.4, 0.0, 1.35, pi),  # off-specular
    (0.1, 0.98, 1.0, 0.3, 0.0, 0.35, 0.1),
    (0.1, 0.0, 1.0, 0.1, 0.0, 0.2, 1.0),
    (0.1, -1.0, 1.0, 0.0, 0.0, 0.15, 3.0),
    (0.5, -0.75, 1.0, 0.9, 0.0, 0.7, pi / 2),
    (0.5, 0.5, 0.25, GRAZING, 1.0, 1.3, 1.3),
    (1.0, -1.0, 0.5, GRAZING, 0.0, 0.1, 3.0),
    (1.0, 0.25, 0.75, 0.9, 5.0, 1.4, 2.2),
]

# The same of Phong's, whose lobe ends 90° from the mirror direction.
ABOUT_MIRROR = [
    (0.001, 0.0, 0.0, 1e-4, 1.0),
    *LOBES[1:7],
    (0.1, 0.12, 2.0, 0.12, 2.0),
    (0.5, 0.4, 0.5, 0.4, 0.5),
    (0.5, 1.3, 0.25, 0.5, 0.25 + pi / 2),
    (1.0, GRAZING, 0.0, GRAZING, pi / 2),
    (1.0, 0.9, 5.0, 1.4, 2.2),
]

ROUGHNESS = ({"roughness": 0.01}, {"roughness": 0.1}, {"roughness": 0.5}, {"roughness": 1.0})
SIGMA = ({"sigma": 0.05}, {"sigma": 0.2}, {"sigma": 0.7}, {"sigma": 1.5})
EON = tuple({**r, "albedo": a} for r, a in zip(ROUGHNESS, (0.18, 1.0, 0.9, 0.6)))
GAMMA = ({"gamma": 1.0}, {"gamma": 1.5}, {"gamma": 2.0}, {"gamma": 5.0})
STUDENT = ({"gamma": 1.6}, {"gamma": 2.0}, {"gamma": 5.0}, {"gamma": 40.0})
AXES = (
    {"aspect": 4.0, "strength": 0.0},
    {"aspect": 0.25, "strength": 0.0},
    {"aspect": 9.0, "strength": 0.0},
    {"aspect": 1.0, "strength": 0.25},
)
NO_MORE = ({},)

FRESNEL = {
    "schlick": NO_MORE,
    "none": NO_MORE,
    "generalized-schlick": tuple({"exponent": p} for p in (2.0, 3.5, 5.0, 10.0)),
    "dielectric": tuple({"eta": eta} for eta in (1.0001, 1.33, 1.5, 3.0)),
    "conductor": tuple({"eta": n, "k": k} for n, k in ((0.22, 3.208), (1.33, 1.872), (3.18, 3.3), (1.0, 50.0))),
    "f82": tuple({"f82": tint} for tint in (0.55, 0.75, 0.9, 1.0)),
    "thin-film": tuple(
        {"thickness": d, "film_eta": n, "f0": f0, "channel": c}
        for d, n, f0, c in ((400.0, 1.3, 0.04, 1.0), (250.0, 1.8, 0.04, 0.0), (550.0, 1.33, 0.8, 2.0), (0.01, 1.5, 0.5, 0.5))
    ),
}


def _with_alpha(rows, more=NO_MORE):
    return [({"alpha": row[0], **more[k % len(more)]}, row[1:]) for k, row in enumerate(rows)]


def _wide(more=NO_MORE):
    return [(more[(k + k // 4) % len(more)], row) for k, row in enumerate(WIDE)]


def values():
    """Yields (model, parameters, angles)."""
    for model, rows in _models():
        assert len(rows) == 12, model
        for parameters, angles in rows:
            yield model, parameters, angles


def _models():
    for model in ("lambert", "gltf_diffuse", "disney-sheen", "ashikhmin-shirley-diffuse"):
        yield model, _wide()
    for model in ("gltf_oren_nayar", "oren-nayar"):
        yield model, _wide(SIGMA)
    for model in ("fujii", "burley", "frostbite", "disney-subsurface"):
        yield model, _wide(ROUGHNESS)
    yield "eon", _wide(EON)
    for model in ("ward", "ward-dur"):
        yield model, _with_alpha(SLOPES)
    for model in ("blinn", "ashikhmin-shirley"):
        yield model, _with_alpha(LOBES)
    yield "phong", _with_alpha(ABOUT_MIRROR)
    yield "lafortune", [({"alpha": a, "cxy": x, "cz": z}, angles) for a, x, z, *angles in ABOUT_AXES]

    for model in ("ggx", "beckmann", "blinn-phong", "ggx-anisotropic", "beckmann-anisotropic", "gtr"):
        more = GAMMA if model == "gtr" else AXES if model.endswith("anisotropic") else NO_MORE
        rows = SLOPES if model.startswith("beckmann") else LOBES
        yield model, _with_alpha(rows, more)
        yield f"{model}-smith-separable-none", _with_alpha(rows, more)
    for model in ("student-t", "student-t-smith-separable-none"):
        yield model, _with_alpha(SLOPES, STUDENT)
    yield "gtr-disney-clearcoat-schlick", _with_alpha(LOBES, GAMMA[:1])
    for model in ("charlie", "charlie-smith-separable-none", "charlie-ashikhmin-neubelt-schlick"):
        yield model, _with_alpha(FIBRES)
    masking = "smith-separable schlick-ggx schlick-ggx-direct smith-joint-approx v-cavity kelemen ashikhmin-neubelt disney-clearcoat none"
    for mask in masking.split():
        yield f"ggx-{mask}-schlick", _with_alpha(LOBES)
    for term, more in FRESNEL.items():
        if term != "schlick":
            yield f"ggx-smith-correlated-{term}", _with_alpha(LOBES, more)
