"""Mitsuba's BSDFs for our materials, where both mean the same; `Unsupported` says why where they do not.

Mitsuba's facets have Smith's separable masking and leave out what facets scatter more than once. Rough materials must ask for both:
`"masking": "smith-separable"`, `"multipleScattering": false`. Mitsuba's alpha is our roughness squared.
"""

import math


class Unsupported(Exception):
    """A part of the scene that Mitsuba cannot express here."""


def rgb(value):
    return {"type": "rgb", "value": [float(x) for x in value]}


def facets(material, roughness=None):
    """Mitsuba's keys of rough facets, or None where the surface is smooth."""
    roughness = material.get("roughness", 0.0) if roughness is None else roughness
    if roughness * roughness < 1e-4:
        return None
    name = material["name"]
    if material.get("masking", "smith") != "smith-separable":
        raise Unsupported(f"material {name}: Mitsuba's masking is smith-separable")
    if material.get("multipleScattering", True):
        raise Unsupported(f"material {name}: Mitsuba leaves out multiple scattering")
    if material.get("rotation", 0.0):
        raise Unsupported(f"material {name}: Mitsuba rotates no facets; turn texture coordinates instead")
    narrow = 1.0 - material.get("anisotropy", 0.0)
    alpha = roughness**2 * math.sqrt(2.0 / (1.0 + narrow * narrow))
    keys = {"distribution": material.get("distribution", "ggx")}
    return keys | {"alpha_u": alpha, "alpha_v": alpha * narrow} if narrow < 1.0 else keys | {"alpha": alpha}


def is_opaque(material, materials):
    kind = material["type"]
    if kind == "mix":
        return all(is_opaque(materials[name], materials) for name in material["materials"])
    return kind not in ("refractive", "thin-refractive") and not material.get("transmission_weight", 0.0)


def conductor(material):
    if "eta" not in material:
        raise Unsupported(f"material {material['name']}: only conductors with eta and k")
    rough = facets(material)
    kind = {"type": "conductor"} if rough is None else {"type": "roughconductor"} | rough
    return kind | {"eta": rgb(material["eta"]), "k": rgb(material["k"])}


def refractive(material):
    for key in ("absorption", "transmittance", "priority"):
        if material.get(key):
            raise Unsupported(f"material {material['name']}: {key}")
    indices = {"int_ior": float(material["refractionIndex"]), "ext_ior": float(material.get("exteriorIndex", 1.0))}
    rough = facets(material)
    return ({"type": "dielectric"} if rough is None else {"type": "roughdielectric"} | rough) | indices


def thin(material):
    if material.get("transmittance", [1, 1, 1]) != [1, 1, 1]:
        raise Unsupported(f"material {material['name']}: Mitsuba tints all transmitted light alike, ours each crossing")
    indices = {"int_ior": float(material["refractionIndex"]), "ext_ior": float(material.get("exteriorIndex", 1.0))}
    return {"type": "thindielectric"} | indices


def coated(material):
    if material.get("roughness", 0.0) > 0.01:
        raise Unsupported(f"material {material['name']}: Mitsuba's roughplastic couples coat and base in another way")
    indices = {"int_ior": float(material.get("refractionIndex", 1.5)), "ext_ior": float(material.get("exteriorIndex", 1.0))}
    return {"type": "plastic", "nonlinear": True, "diffuse_reflectance": rgb(material["color"])} | indices


def principled(material):
    """Metal, or clear glass: what Disney's model of 2012/2015 and OpenPBR share, but for masking.

    Both have GGX, alpha = roughness squared, Schlick's or Fresnel's reflectance, and half of the colour at each interface of
    glass. Mitsuba's masking is separable and ours correlated by height; they differ by the product of both Lambdas, which
    grows with the fourth power of the roughness.
    """
    known = {"name", "type", "base_color", "base_metalness", "specular_roughness", "specular_ior", "transmission_weight"}
    extra = sorted(material.keys() - known - {"multipleScattering", "transmission_color"})
    metal, clear = material.get("base_metalness", 0.0), material.get("transmission_weight", 0.0)
    if extra or material.get("multipleScattering", True) or sorted((metal, clear)) != [0.0, 1.0]:
        what = f"{', '.join(extra)} differ" if extra else "only metal or glass without multiple scattering"
        raise Unsupported(f"material {material['name']}: {what}")
    color = material["base_color"] if metal else material.get("transmission_color", [1, 1, 1])
    keys = {"type": "principled", "metallic": metal, "spec_trans": clear, "base_color": rgb(color)}
    return keys | {"roughness": material["specular_roughness"], "eta": material.get("specular_ior", 1.5)}


def bsdf(material, materials):
    """The Mitsuba BSDF of a material other than a diffuse one or a mirror, two-sided where ours is."""
    kind = material["type"]
    if kind == "mix":
        parts = [bsdf(materials[name], materials) for name in material["materials"]]
        inner = [part["bsdf"] if part["type"] == "twosided" else part for part in parts]
        made = {"type": "blendbsdf", "weight": material.get("weight", 0.5), "first": inner[0], "second": inner[1]}
    elif kind == "two-sided":
        sides = [bsdf(materials[material[side]], materials)["bsdf"] for side in ("front", "back")]
        return {"type": "twosided", "front": sides[0], "back": sides[1]}
    elif kind == "diffuse" and material.get("brdf", "lambertian") == "lambertian":
        made = {"type": "diffuse", "reflectance": rgb(material["color"])}
    else:
        makers = {
            "conductor": conductor,
            "refractive": refractive,
            "thin-refractive": thin,
            "coated-diffuse": coated,
            "principled": principled,
        }
        if kind not in makers:
            raise Unsupported(f"material type {kind}")
        made = makers[kind](material)
    return {"type": "twosided", "bsdf": made} if is_opaque(material, materials) else made
