"""Renders small scenes with each of our lights and lenses, and with Mitsuba's of the same meaning: are the pictures the same?

Every picture is rendered several times by both, with other seeds, so that standard errors come from independent images. The
means of the channels must agree within 0.3 % and within three standard errors, which have to be below 0.1 %. The worst of 4 x 4
regions is printed in percent; blocks of 16 x 16 pixels must differ as noise does (z is a difference over its standard error): no
|z| above 4.5, and a mean of z^2 near 1.

Controls follow: Mitsuba's scene is changed (the sky mirrored, turned the other way, moved by a texel, a lens of another radius, a
spot light with Mitsuba's own falloff), and the comparison must find every one of them. `--sky FILE` adds a sky of one's own.

Ends with code 1 if a picture is not the same or a control is not found, and with 77 if Mitsuba is missing.
"""

import argparse
import copy
import json
import pathlib
import sys
import tempfile

import backend  # First, for its message when something is missing.
import numpy as np
import scene as converter
from compare_materials import FACETS, GOLD, quad, render_ours

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import ours
from same import MEAN_BOUND, Picture

CAMERA = {"origin": [0.4, 1.9, 4.6], "lookAt": [0, 0.7, 0], "fieldOfView": 55}

MATERIALS = [
    {"name": "floor", "type": "diffuse", "color": [0.6, 0.55, 0.5]},
    {"name": "clay", "type": "diffuse", "color": [0.7, 0.25, 0.15]},
    {"name": "blue", "type": "diffuse", "color": [0.15, 0.3, 0.6]},
    GOLD | FACETS | {"name": "gold", "roughness": 0.4},
    {"name": "plastic", "type": "coated-diffuse", "color": [0.2, 0.5, 0.2], "refractionIndex": 1.5},
]


def box(low, high, angle, material):
    """A box that stands turned about the vertical through its middle."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    a, b, c, d = [x0, y0, z0], [x1, y0, z0], [x1, y0, z1], [x0, y0, z1]
    e, f, g, h = ([p[0], y1, p[2]] for p in (a, b, c, d))
    middle = [(x0 + x1) / 2, 0, (z0 + z1) / 2]
    turn = [{"translate": [-x for x in middle]}, {"rotate": [0, angle, 0]}, {"translate": middle}]
    faces = [(e, h, g, f), (a, e, f, b), (b, f, g, c), (c, g, h, d), (d, h, e, a)]
    return [quad(*face, material=material, transform=turn) for face in faces]


def stage(lights, textures=(), camera=CAMERA, third="plastic"):
    """A floor, a box and three balls, two of them shiny."""
    surfaces = [
        quad([-4, 0, 4], [4, 0, 4], [4, 0, -4], [-4, 0, -4], material="floor"),
        {"geometry": "sphere", "origin": [-1.3, 0.7, 0.2], "radius": 0.7, "material": "gold"},
        {"geometry": "sphere", "origin": [0.5, 0.4, 1.4], "radius": 0.4, "material": "clay"},
        {"geometry": "sphere", "origin": [1.6, 0.55, 0.5], "radius": 0.55, "material": third},
        *box([-0.2, 0, -1.4], [0.7, 1.3, -0.5], 25, "blue"),
    ]
    return {
        "etendue": 1,
        "camera": camera,
        "textures": list(textures),
        "lights": lights,
        "materials": MATERIALS,
        "surfaces": surfaces,
    }


def small_sky():
    """A sky of 64 x 32 texels that looks like itself from no other side: gradients, a bright spot, single texels, a dark ground."""
    height, width = 32, 64
    v, u = np.meshgrid((np.arange(height) + 0.5) / height, (np.arange(width) + 0.5) / width, indexing="ij")
    image = np.stack([0.4 + 0.3 * np.sin(2 * np.pi * u), 0.5 + 0.2 * np.cos(2 * np.pi * u + 1), 0.9 - 0.5 * u], -1)
    image = image * np.where(v < 0.5, 1.0 - 0.8 * v, 0.15)[..., None]
    image[8:10, 20:22] = [260, 210, 150]
    image[11, 45] = [10, 30, 120]
    image[0, 5] = [3, 40, 3]
    image[31, 40] = [60, 3, 40]
    image[14, 63] = [40, 5, 5]
    return image.astype(np.float32)


def sky_texture(file):
    return {"name": "sky", "type": "image", "file": str(file)}


def under_sky(file, third="plastic", **keys):
    return stage([{"type": "environment", "texture": "sky"} | keys], [sky_texture(file)], third=third)


SPOT = {"type": "spot", "origin": [1.5, 4, 2.5], "direction": [-0.35, -0.9, -0.65], "color": [60, 52, 40]}
SUN = {"type": "distant", "sun": [0.9, 1.4, 0.6], "color": [3, 2.7, 2.2]}
EVEN = {"type": "environment", "color": [0.5, 0.6, 0.75]}
LENS = CAMERA | {"lensRadius": 0.15, "focusDistance": 3.4}
LAMPS = [{"geometry": "sphere", "origin": [x, 1.7, -2.5], "radius": 0.15, "emission": [9, 6, 3]} for x in (-2, -0.6, 1.6)]


def with_lamps(scene):
    scene["surfaces"] += LAMPS
    return scene


def cases(folder, sky):
    """Names and scenes."""
    image = small_sky()
    small, radiance = folder / "small.exr", folder / "small.hdr"
    backend.write_exr(small, image)
    backend.write_exr(radiance, image)  # By its extension in Radiance's format.
    result = {
        "even environment": stage([EVEN]),
        "environment, image": under_sky(small),
        "environment, image, turned by 50 degrees": under_sky(small, rotation=50),
        "environment, image, +z up, turned by -30 degrees": under_sky(small, rotation=-30, up=[0, 0, 1]),
        "environment, image, tilted, a colour": under_sky(small, rotation=120, up=[0.3, 1, -0.2], color=[1, 0.8, 0.5], intensity=1.5),
        "environment, image, -y up": under_sky(small, up=[0, -1, 0], rotation=20),
        "environment, image of Radiance": under_sky(radiance),
        "environment, seen alone": under_sky(small) | {"surfaces": [], "camera": {"origin": [0, 0, 0], "lookAt": [0.3, 0.4, -1], "fieldOfView": 110}},
        "lens": with_lamps(stage([EVEN], camera=LENS)),
        "lens, fStop, focusAt": with_lamps(
            stage([EVEN], camera=CAMERA | {"fStop": 1.4, "focalLength": 0.5, "focusAt": [0.4, 1.2, -0.9]})
        ),
        "orthographic, width": stage([EVEN, SUN], camera={"type": "orthographic", "origin": [3, 3, 4], "lookAt": [0, 0.6, 0], "width": 6}),
        "orthographic, height, from above": stage(
            [EVEN, SUN], camera={"type": "orthographic", "origin": [0, 6, 0], "lookAt": [0, 0, 0], "up": [1, 0, -1], "height": 5}
        ),
        "spot": stage([SPOT | {"outerConeAngle": 35}]),
        "spot, inner cone": stage([SPOT | {"outerConeAngle": 32, "innerConeAngle": 20}]),
        "spot, hard edge": stage([SPOT | {"outerConeAngle": 25, "innerConeAngle": 25}]),
        "distant, parallel": stage([SUN]),
        # Without plastic: its smooth coat makes caustics of a small sun, which both find by chance alone.
        "distant, 0.533 degrees": stage([SUN | {"angle": 0.533}], third="blue"),
        "distant, 12 degrees": stage([SUN | {"angle": 12}]),
        "distant, low, in the picture": stage(
            [EVEN, SUN | {"sun": [-0.2, 0.22, -1], "angle": 8}], camera=CAMERA | {"lookAt": [0, 1.4, 0]}
        ),
        "all at once, by a lens": stage(
            [{"type": "environment", "texture": "sky", "rotation": 200}, SPOT, SUN | {"angle": 2}], [sky_texture(small)], LENS
        ),
    }
    if sky is not None:
        result[f"environment, {sky.stem}"] = under_sky(sky.resolve(), "blue")
        result[f"environment, {sky.stem}, turned by 100 degrees"] = under_sky(sky.resolve(), "blue", rotation=100)
    return result


def controls(folder, scenes):
    """Names, the scene for us, and a scene for Mitsuba that is another one."""
    image = small_sky()
    changed = {"mirrored": image[:, ::-1], "upside down": image[::-1], "moved by a texel": np.roll(image, 1, 1)}
    result = {}
    for name, other in changed.items():
        file = folder / f"{name.replace(' ', '-')}.exr"
        backend.write_exr(file, other)
        result[f"environment, {name}"] = (scenes["environment, image"], under_sky(file))

    def change(name, control, **keys):
        other = copy.deepcopy(scenes[name])
        other["lights"][0].update(keys)
        result[control] = (scenes[name], other)

    change("environment, image, turned by 50 degrees", "environment, turned the other way", rotation=-50)
    change("environment, image, +z up, turned by -30 degrees", "environment, -z up", up=[0, 0, -1])
    change("spot", "spot, another inner cone", innerConeAngle=3)
    change("distant, 12 degrees", "distant, 15 degrees", angle=15)
    lens = copy.deepcopy(scenes["lens"])
    lens["camera"]["lensRadius"] *= 4 / 3
    result["lens, a third wider"] = (scenes["lens"], lens)
    focus = copy.deepcopy(scenes["lens"])
    focus["camera"]["focusDistance"] *= 1.2
    result["lens, focus a fifth farther"] = (scenes["lens"], focus)
    flat = copy.deepcopy(scenes["orthographic, width"])
    flat["camera"]["width"] *= 1.01
    result["orthographic, 1 % wider"] = (scenes["orthographic, width"], flat)
    return result


def compare(mi, args, name, mine, theirs, folder, first):
    files = [folder / f"{who}.json" for who in ("ours", "theirs")]
    for file, scene in zip(files, (mine, theirs), strict=True):
        file.write_text(json.dumps(scene), encoding="utf-8")
    loaded = converter.load(files[1], args.resolution)
    images = [[], []]
    for seed in range(first, first + args.renders):
        images[0].append(render_ours(args, files[0], folder, seed))
        images[1].append(backend.render(mi, loaded, args.spp, seed))
    if args.pictures:
        place = pathlib.Path(args.pictures)
        place.mkdir(parents=True, exist_ok=True)
        file = name.replace(",", "").replace(" ", "-")
        means = [np.mean(list_, axis=0) for list_ in images]
        for who, mean in zip(("ours", "mitsuba"), means, strict=True):
            backend.write_exr(place / f"{file}-{who}.exr", mean)
            backend.write_png(place / f"{file}-{who}.png", mean)
        difference = (means[0] - means[1]) / np.maximum(means[1], 0.05 * means[1].mean())
        backend.write_png(place / f"{file}-difference.png", np.clip(0.2 + 2.0 * difference, 0.0, 1.0))
    return Picture(name, *images)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("only", nargs="*", help="parts of the names of the cases to compare (default: all)")
    parser.add_argument("--sky", type=pathlib.Path, help="an environment by longitude and latitude of one's own")
    parser.add_argument("--resolution", type=int, nargs=2, default=(192, 144), metavar=("W", "H"))
    parser.add_argument("--renders", type=int, default=16, help="independent renders by each (default 16)")
    parser.add_argument("--spp", type=int, default=64, help="samples per pixel of one render (default 64)")
    parser.add_argument("--seed", type=int, default=1, help="another number makes other images")
    parser.add_argument("--threads", type=int, default=2, help="threads; 0 for all cores (default 2)")
    parser.add_argument("--variant", choices=["llvm_ad_rgb", "scalar_rgb"], default="llvm_ad_rgb")
    parser.add_argument("--etendue", default="target/release/examples/etendue", help="our program")
    parser.add_argument("--no-controls", action="store_true", help="leave out the scenes that must not be the same")
    parser.add_argument("--pictures", metavar="FOLDER", help="also write the mean images of both, and their difference")
    parser.add_argument("--markdown", metavar="FILE", help="also write the tables here")
    args = parser.parse_args()
    mi = backend.mitsuba(args.variant)
    backend.set_threads(args.threads)
    mi.set_log_level(mi.LogLevel.Error)
    ours.find(args.etendue)
    lines, wrong = [], []

    def say(line):
        print(line, flush=True)
        lines.append(line)

    def wanted(name):
        return not args.only or any(part in name for part in args.only)

    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place)
        scenes = cases(folder, args.sky)
        others = {} if args.no_controls else controls(folder, scenes)
        if not any(map(wanted, [*scenes, *others])):
            sys.exit(f"no such case; there are: {', '.join([*scenes, *others])}")
        say(Picture.head("scene", "Mitsuba's"))
        for index, (name, scene) in enumerate(scenes.items()):
            if wanted(name):
                # Seeds of its own for every case, so that cases share no noise.
                found = compare(mi, args, name, scene, scene, folder, 1 + 1000 * (100 * args.seed + index))
                say(found.row())
                wrong += [name] if found.wrong() else []
        if any(map(wanted, others)):
            say("\nControls, which must not be the same:\n")
            say(Picture.head("scene", "Mitsuba's"))
        for index, (name, (mine, theirs)) in enumerate(others.items()):
            if wanted(name):
                found = compare(mi, args, name, mine, theirs, folder, 1 + 1000 * (100 * args.seed + 50 + index))
                say(found.row())
                wrong += [] if found.differences() else [f"{name} (not found)"]
    say(f"\nMeans must agree within {100 * MEAN_BOUND:g} % and three standard errors.")
    if args.markdown:
        pathlib.Path(args.markdown).write_text("\n".join(lines) + "\n", encoding="utf-8")
    if wrong:
        sys.exit(f"not as it should be: {'; '.join(wrong)}")


if __name__ == "__main__":
    main()
