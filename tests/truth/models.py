"""Every model by its name and its parameters: components(name, parameters, pair) is (A,) or (A, B)."""

import classic
import diffuse
import fresnel
import masking
import ndf

SIMPLE = {
    "lambert": diffuse.lambert,
    "gltf_diffuse": diffuse.gltf_diffuse,
    "gltf_oren_nayar": diffuse.gltf_oren_nayar,
    "oren-nayar": diffuse.oren_nayar,
    "fujii": diffuse.fujii,
    "eon": diffuse.eon,
    "burley": diffuse.burley,
    "frostbite": diffuse.frostbite,
    "disney-subsurface": diffuse.disney_subsurface,
    "disney-sheen": diffuse.disney_sheen,
    "ward": classic.ward,
    "ward-dur": classic.ward_dur,
    "blinn": classic.blinn,
    "phong": classic.phong,
    "lafortune": classic.lafortune,
    "ashikhmin-shirley": classic.ashikhmin_shirley,
    "ashikhmin-shirley-diffuse": classic.ashikhmin_shirley_diffuse,
}

# NDFs and the parameters that they take beside alpha.
NDFS = {
    "ggx": (ndf.Ggx, ()),
    "beckmann": (ndf.Beckmann, ()),
    "blinn-phong": (ndf.BlinnPhong, ()),
    "gtr": (ndf.Gtr, ("gamma",)),
    "student-t": (ndf.StudentT, ("gamma",)),
    "charlie": (ndf.Charlie, ()),
    "ggx-anisotropic": (ndf.GgxAnisotropic, ("aspect", "strength")),
    "beckmann-anisotropic": (ndf.BeckmannAnisotropic, ("aspect", "strength")),
}


def parts(name):
    """The parts of a microfacet model's name, ndf[-masking-fresnel]: (ndf, masking, fresnel)."""
    for ndf_name in sorted(NDFS, key=len, reverse=True):
        if name == ndf_name:
            return ndf_name, "smith-correlated", "schlick"
        for mask in sorted(masking.TERMS, key=len, reverse=True):
            for term in fresnel.TERMS:
                if name == f"{ndf_name}-{mask}-{term}":
                    return ndf_name, mask, term
    raise KeyError(name)


def lobe(name, parameters):
    """The model at these parameters, as a function of a pair: (A,) or (A, B)."""
    if name in SIMPLE:
        function = SIMPLE[name]

        def simple(pair):
            value = function(pair, **parameters)
            return value if isinstance(value, tuple) else (value,)

        return simple
    ndf_name, mask, term = parts(name)
    make, own = NDFS[ndf_name]
    normals = make(parameters["alpha"], *(parameters[key] for key in own))
    g2, f = masking.TERMS[mask], fresnel.TERMS[term]
    rest = {key: value for key, value in parameters.items() if key != "alpha" and key not in own}

    def microfacet(pair):
        """Walter et al. 2007, eq. 20."""
        s = normals.d(pair.wm) * g2(pair, normals) / (4 * pair.mu_i * pair.mu_e)
        return tuple(s * part for part in f(pair.cos_d, **rest))

    return microfacet
