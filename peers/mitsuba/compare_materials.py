"""Renders one room with each of our materials and with Mitsuba's of the same meaning: are the pictures the same but for noise?

Every picture is rendered several times by both, with other seeds, so that standard errors come from independent images. The
means of the channels must agree within 0.3 %, known to 0.1 %. The picture is cut into blocks of 16 x 16 pixels; the
difference of each block and channel over its standard error is z, and z must be distributed as noise: no |z| above 4.5 (one
picture in five hundred has a larger one by chance), and a mean of z^2 near 1, by picture and over all pictures together.
Mitsuba's masking of Beckmann's facets is Walter's rational fit, 0.04 to 0.3 % too bright in terms of albedo (alpha 0.49, up to
60 degrees), so that z of the means grows with the samples there; differences of that size stay within the bounds.
Where the two models differ by design (Fresnel's equations by polarisation in thin sheets, masking in `principled`), a case
compares what they share, or another way to the same physics.

Ends with code 1 if a picture is not the same, and with 77 if Mitsuba is missing.
"""

import argparse
import json
import math
import pathlib
import sys
import tempfile

import backend  # First, for its message when something is missing.
import numpy as np
import scene as converter

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import ours
import pictures
from same import Result

GOLD = {"type": "conductor", "eta": [0.16, 0.35, 1.45], "k": [3.9, 2.5, 1.9]}
"""Roughly gold, by its index in three channels."""

GLASS = {"type": "refractive", "refractionIndex": 1.5}

FACETS = {"masking": "smith-separable", "multipleScattering": False}
"""Facets as Mitsuba has them."""


def quad(a, b, c, d, **keys):
    corners = {f"vertex-{i + 1}": corner for i, corner in enumerate((a, b, c, d))}
    return {"geometry": "quad"} | corners | keys


def panel(material, uvs=((0, 0), (1, 0), (1, 1), (0, 1)), corners=None):
    """A tilted rectangle with texture coordinates, which say where its tangents point."""
    corners = corners or ([0.5, 0.1, 0.7], [1.9, 0.1, 0.3], [1.7, 1.6, -0.7], [0.3, 1.6, -0.3])
    mesh = {"positions": [list(c) for c in corners], "triangles": [[0, 1, 2], [0, 2, 3]], "uvs": [list(uv) for uv in uvs]}
    return {"geometry": "mesh", "material": material} | mesh


def slab(material, corners, normal, thickness):
    """A closed box over a rectangle: two faces of a thin sheet, and its edges."""
    near, far = (np.array(corners) + side * 0.5 * thickness * np.array(normal) for side in (1, -1))
    sides = [(i, (i + 1) % 4) for i in range(4)]
    triangles = [[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6]]
    triangles += [t for i, j in sides for t in ([i, 4 + i, 4 + j], [i, 4 + j, j])]
    mesh = {"positions": np.vstack([near, far]).tolist(), "triangles": triangles}
    return {"geometry": "mesh", "material": material} | mesh


def ball(material):
    return {"geometry": "sphere", "origin": [-0.7, 0.95, 0.1], "radius": 0.85, "material": material}


def room(materials, objects, grey=False):
    """A room of luminous walls and a lamp, a diffuse floor, a diffuse ball at the back, and the objects."""

    def color(*value):
        return [sum(value) / 3] * 3 if grey else list(value)

    low, high = [-3, 0, -3], [3, 4, 3]
    (x0, y0, z0), (x1, y1, z1) = low, high
    a, b, c, d = [x0, y0, z0], [x1, y0, z0], [x1, y0, z1], [x0, y0, z1]
    e, f, g, h = ([p[0], y1, p[2]] for p in (a, b, c, d))
    surfaces = [
        quad(d, c, b, a, material="floor"),
        quad(e, f, g, h, emission=color(0.5, 0.55, 0.6)),
        quad(a, b, f, e, emission=color(0.2, 0.3, 0.5)),
        quad(b, c, g, f, emission=color(0.15, 0.5, 0.2)),
        quad(d, a, e, h, emission=color(0.6, 0.25, 0.15)),
        quad(c, d, h, g, emission=color(0.3, 0.3, 0.3)),
        quad([-0.9, 3.9, -0.4], [0.9, 3.9, -0.4], [0.9, 3.9, 1.0], [-0.9, 3.9, 1.0], emission=color(6, 5, 4)),
        {"geometry": "sphere", "origin": [0.2, 0.6, -1.7], "radius": 0.6, "material": "clay"},
    ]
    own = [
        {"name": "floor", "type": "diffuse", "color": color(0.55, 0.5, 0.45)},
        {"name": "clay", "type": "diffuse", "color": color(0.7, 0.2, 0.1)},
    ]
    return {
        "etendue": 1,
        "camera": {"origin": [0, 1.9, 2.9], "lookAt": [0.1, 0.7, -0.5], "fieldOfView": 62},
        "materials": own + materials,
        "surfaces": surfaces + objects,
    }


def both(material, **facets):
    """A ball and a panel of one material, twice: for us and for Mitsuba."""
    scene = room([{"name": "it"} | material | facets], [ball("it"), panel("it")])
    return scene, scene, "llvm_ad_rgb"


def only_ball(material, **facets):
    scene = room([{"name": "it"} | material | facets], [ball("it")])
    return scene, scene, "llvm_ad_rgb"


def in_wavelengths(objects, material):
    """The room by paths that carry wavelengths, in both: colours become the same smooth spectra, and lights those times D65."""
    scene = room([{"name": "it"} | material], objects)
    return scene | {"render": {"spectral": True}}, scene, "llvm_ad_spectral"


def turned():
    """Facets of ours turned by 30 degrees beside texture coordinates of Mitsuba turned by as much.

    u and v grow along directions turned by 30 degrees in the panel's plane, counter-clockwise about its normal.
    """
    metal = GOLD | FACETS | {"name": "it", "roughness": 0.6, "anisotropy": 0.8}
    mine = room([metal | {"rotation": 30}], [panel("it")])
    corners = np.array(mine["surfaces"][-1]["positions"])
    s = corners[1] - corners[0]
    s /= np.linalg.norm(s)
    n = np.cross(s, corners[3] - corners[0])
    n /= np.linalg.norm(n)
    t = np.cross(n, s)
    angle = math.radians(30)
    axes = np.stack([math.cos(angle) * s + math.sin(angle) * t, math.cos(angle) * t - math.sin(angle) * s], 1)
    theirs = room([metal], [panel("it", ((corners - corners[0]) @ axes).tolist())])
    return mine, theirs, "llvm_ad_rgb"


NEAR = ([-0.8, 1.0, 1.9], [0.8, 1.0, 1.9], [0.8, 2.2, 2.324], [-0.8, 2.2, 2.324])
"""A pane before the camera, across its view."""

WINDOW = ([-1.6, 0.05, 0.9], [0.9, 0.05, -0.6], [0.9, 1.9, -0.6], [-1.6, 1.9, 0.9])
"""A pane in the middle of the room, seen at all angles."""


def sheet_across():
    """Thin sheets seen near their normal, where Fresnel's equations are alike for both polarisations."""
    scene = room([{"name": "it", "type": "thin-refractive", "refractionIndex": 1.5}], [panel("it", corners=NEAR)])
    return scene, scene, "llvm_ad_rgb"


def sheet_polarised():
    """Our thin sheet beside a slab with two faces in Mitsuba, which follows the polarisation of the light between them."""
    mine = room([{"name": "it", "type": "thin-refractive", "refractionIndex": 1.5}], [panel("it", corners=WINDOW)], True)
    corners = np.array(WINDOW)
    normal = np.cross(corners[1] - corners[0], corners[3] - corners[0])
    theirs = room([GLASS | {"name": "it"}], [slab("it", WINDOW, normal / np.linalg.norm(normal), 1e-3)], True)
    return mine, theirs, "llvm_ad_mono_polarized"


def mixed():
    metal = GOLD | FACETS | {"name": "metal", "roughness": 0.5}
    dirt = {"name": "dirt", "type": "diffuse", "color": [0.2, 0.15, 0.1]}
    mix = {"name": "old", "type": "mix", "materials": ["metal", "dirt"], "weight": 0.4}
    sides = {"name": "it", "type": "two-sided", "front": "dirt", "back": "metal"}
    # The panel's normal points to the camera; its back is seen where the vertices run the other way.
    back = panel("it")
    back["triangles"] = [[0, 2, 1], [0, 3, 2]]
    scene = room([metal, dirt, mix, sides], [ball("old"), back])
    return scene, scene, "llvm_ad_rgb"


PLASTIC = {"type": "coated-diffuse", "color": [0.7, 0.3, 0.1], "refractionIndex": 1.5}
METALLIC = {"type": "principled", "base_color": [0.9, 0.6, 0.3], "base_metalness": 1.0, "multipleScattering": False}
CLEAR = {"type": "principled", "transmission_weight": 1.0, "transmission_color": [0.8, 0.9, 0.5], "multipleScattering": False}

CASES = {
    "conductor": lambda: both(GOLD),
    "roughconductor, GGX 0.3": lambda: both(GOLD, **FACETS, roughness=0.3),
    "roughconductor, GGX 0.7": lambda: both(GOLD, **FACETS, roughness=0.7),
    "roughconductor, GGX 1": lambda: both(GOLD, **FACETS, roughness=1.0),
    "roughconductor, Beckmann 0.3": lambda: both(GOLD, **FACETS, roughness=0.3, distribution="beckmann"),
    "roughconductor, Beckmann 0.7": lambda: both(GOLD, **FACETS, roughness=0.7, distribution="beckmann"),
    "roughconductor, GGX 0.5, anisotropy 0.8": lambda: both(GOLD, **FACETS, roughness=0.5, anisotropy=0.8),
    "roughconductor, Beckmann 0.5, anisotropy 0.8": lambda: both(
        GOLD, **FACETS, roughness=0.5, anisotropy=0.8, distribution="beckmann"
    ),
    "roughconductor, GGX 0.6, turned by 30 degrees": turned,
    "dielectric": lambda: only_ball(GLASS),
    "roughdielectric, GGX 0.3": lambda: only_ball(GLASS, **FACETS, roughness=0.3),
    "roughdielectric, GGX 0.7": lambda: only_ball(GLASS, **FACETS, roughness=0.7),
    "roughdielectric, Beckmann 0.5": lambda: only_ball(GLASS, **FACETS, roughness=0.5, distribution="beckmann"),
    "roughdielectric, GGX 0.6, anisotropy 0.8": lambda: only_ball(GLASS, **FACETS, roughness=0.6, anisotropy=0.8),
    "roughdielectric, GGX 0.5, a bubble": lambda: only_ball(
        GLASS | {"refractionIndex": 1.0, "exteriorIndex": 1.5}, **FACETS, roughness=0.5
    ),
    "plastic, nonlinear": lambda: both(PLASTIC),
    "thindielectric, near its normal": sheet_across,
    "thin sheet, beside a slab in polarised light": sheet_polarised,
    "principled, metal 0.2": lambda: both(METALLIC, specular_roughness=0.2),
    "principled, glass 0.2": lambda: only_ball(CLEAR, specular_roughness=0.2),
    "mix and two-sided (blendbsdf, twosided)": mixed,
    "wavelengths, diffuse": lambda: in_wavelengths([ball("it"), panel("it")], {"type": "diffuse", "color": [0.1, 0.6, 0.3]}),
    "wavelengths, dielectric": lambda: in_wavelengths([ball("it")], GLASS),
    "wavelengths, roughdielectric, GGX 0.3": lambda: in_wavelengths([ball("it")], GLASS | FACETS | {"roughness": 0.3}),
}


HEAD = """| materials | means R / G / B, ours over Mitsuba's, % | ± % | largest z | noise of a block, % | mean z² of blocks | largest z | |
|---|---|--:|--:|--:|--:|--:|---|"""


def render_ours(args, file, folder, seed):
    output = pathlib.Path(folder) / "ours.pfm"
    size = "x".join(str(n) for n in args.resolution)
    options = ("--resolution", size, "--spp", args.spp, "--filter", "box", "--integrator", "path", "--reuse=off", "--light-paths=off")
    ours.render(args.etendue, file, output, args.threads, seed, *options)
    return pictures.read_pfm(output)


def compare(mi, args, name, folder):
    mine, theirs, variant = CASES[name]()
    files = [pathlib.Path(folder) / f"{who}.json" for who in ("ours", "theirs")]
    for file, scene in zip(files, (mine, theirs), strict=True):
        file.write_text(json.dumps(scene), encoding="utf-8")
    if args.variant == "scalar_rgb":
        variant = {"llvm_ad_rgb": "scalar_rgb"}.get(variant, variant)
    backend.select(mi, variant)
    mi.set_log_level(mi.LogLevel.Error)
    loaded = converter.load(files[1], args.resolution)
    images = [[], []]
    # Seeds of its own for every case, so that cases share no noise.
    first = 1 + 1000 * (args.seed * len(CASES) + list(CASES).index(name))
    for seed in range(first, first + args.renders):
        images[0].append(render_ours(args, files[0], folder, seed))
        # Without colours there is one channel.
        images[1].append(np.broadcast_to(backend.render(mi, loaded, args.spp, seed), images[0][0].shape))
    if args.pictures:
        place = pathlib.Path(args.pictures)
        place.mkdir(parents=True, exist_ok=True)
        file = name.replace(",", "").replace(" ", "-")
        for who, list_ in zip(("ours", "mitsuba"), images, strict=True):
            mean = np.mean(list_, axis=0)
            backend.write_exr(place / f"{file}-{who}.exr", mean)
            backend.write_png(place / f"{file}-{who}.png", mean)
    return Result(name, *images)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("only", nargs="*", help="parts of the names of the cases to compare (default: all)")
    parser.add_argument("--resolution", type=int, nargs=2, default=(192, 144), metavar=("W", "H"))
    parser.add_argument("--renders", type=int, default=24, help="independent renders by each (default 24)")
    parser.add_argument("--spp", type=int, default=32, help="samples per pixel of one render (default 32)")
    parser.add_argument("--seed", type=int, default=1, help="another number makes other images")
    parser.add_argument("--threads", type=int, default=2, help="threads; 0 for all cores (default 2)")
    parser.add_argument("--variant", choices=["llvm_ad_rgb", "scalar_rgb"], default="llvm_ad_rgb")
    parser.add_argument("--etendue", default="target/release/examples/etendue", help="our program")
    parser.add_argument("--pictures", metavar="FOLDER", help="also write the mean images of both")
    parser.add_argument("--markdown", metavar="FILE", help="also write the table here")
    args = parser.parse_args()
    mi = backend.mitsuba(args.variant)
    backend.set_threads(args.threads)
    ours.find(args.etendue)
    names = [name for name in CASES if not args.only or any(part in name for part in args.only)]
    if not names:
        sys.exit(f"no such case; there are: {', '.join(CASES)}")

    lines, results = [], []

    def say(line):
        print(line, flush=True)
        lines.append(line)

    say(HEAD)
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            results.append(compare(mi, args, name, folder))
            say(results[-1].row())
    squares = np.concatenate([r.blocks for r in results]) ** 2
    count = sum(r.count for r in results)
    spread, room_for_noise = float(squares.mean()), 4.0 * math.sqrt(2.0 / count)
    say("")
    # 0.27 % of normal numbers are beyond 3.
    beyond = float(np.mean(squares > 9.0))
    say(
        f"All blocks together: mean z² {spread:.3f} (noise: 1 ± {room_for_noise / 4:.3f}), beyond |z| = 3: {100 * beyond:.2f} %"
        f" (noise: 0.27 %), {squares.size} blocks and channels."
    )
    if args.markdown:
        pathlib.Path(args.markdown).write_text("\n".join(lines) + "\n", encoding="utf-8")
    wrong = [r.name for r in results if r.wrong()]
    if abs(spread - 1.0) > room_for_noise:
        wrong.append("the spread of all blocks")
    if wrong:
        sys.exit(f"not the same: {'; '.join(wrong)}")


if __name__ == "__main__":
    main()
