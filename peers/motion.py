"""Is a picture of things that move the mean of many pictures of things at rest? Ours alone, without another renderer.

Each scene is rendered several times with its shutter open, and as often as the mean of many stills (`--time-at`) at moments of their
own: one in each of so many equal shares of the exposure, at a random place in it, so that the mean of the stills has no bias.
Stills know nothing of motion: everything is transformed to where it is at that moment before the scene is built. All together there
are `--renders` x `--stills` stills of each scene, 512 by default. With few stills in a mean, the noise of their moments is seen in many
blocks at once, whose z are then no independent numbers; with 64 it is less than that of the light.

The means of the channels must agree within 0.3 % and within three standard errors; blocks of 16 x 16 pixels must differ as noise does
(see same.py). Controls follow: stills of another shutter, which the comparison must find to be other pictures.

Ends with code 1 if a picture is not the same or a control is not found, and with 77 if numpy is missing.
"""

import argparse
import copy
import json
import math
import pathlib
import sys
import tempfile

try:
    import numpy as np
except ImportError as missing:
    print(f"SKIPPED: numpy is not installed ({missing}). NOTHING WAS COMPARED.", file=sys.stderr)
    sys.exit(77)

import ours
import pictures
from same import MEAN_BOUND, Picture

CAMERA = {"origin": [0.3, 1.7, 4.4], "lookAt": [0, 0.8, 0], "fieldOfView": 55, "shutter": {"open": 0.2, "close": 1.2}}

MATERIALS = [
    {"name": "floor", "type": "diffuse", "color": [0.6, 0.55, 0.5]},
    {"name": "clay", "type": "diffuse", "color": [0.7, 0.25, 0.15]},
    {"name": "blue", "type": "diffuse", "color": [0.15, 0.3, 0.6]},
    {"name": "metal", "type": "conductor", "metal": "Cu", "roughness": 0.4},
]

SKY = {"type": "environment", "color": [0.4, 0.5, 0.6]}
SUN = {"type": "distant", "sun": [0.8, 1.5, 0.7], "color": [2.5, 2.2, 1.9], "angle": 3}
CORNERS = [[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
FACES = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]


def stage(lights, surfaces, camera=CAMERA, meshes=()):
    rest = [
        {
            "geometry": "quad", "material": "floor",
            "vertex-1": [-4, 0, 4], "vertex-2": [4, 0, 4], "vertex-3": [4, 0, -4], "vertex-4": [-4, 0, -4],
        },
        {"geometry": "sphere", "material": "metal", "origin": [1.5, 0.5, -0.6], "radius": 0.5},
    ]  # fmt: skip
    return {
        "etendue": 1,
        "camera": camera,
        "lights": lights,
        "materials": MATERIALS,
        "meshes": list(meshes),
        "surfaces": rest + surfaces,
    }


def block(size, material, **keys):
    """A box around the origin."""
    positions = (np.array(CORNERS) * 0.5 * np.array(size)).tolist()
    return {"geometry": "mesh", "material": material, "positions": positions, "triangles": FACES} | keys


def cases():
    """Names and scenes. The shutter is open from 0.2 to 1.2."""
    box = {"name": "box", "positions": (0.4 * np.array(CORNERS)).tolist(), "triangles": FACES}
    instance = {"geometry": "mesh", "mesh": "box", "material": "blue"}
    fall = [{"time": 0, "translate": [-1.2, 2, 0.4]}, {"time": 0.7, "translate": [-0.9, 0.42, 0.4]}, {"time": 1.4, "translate": [-0.3, 1.2, 0.4]}]
    turn = [{"time": 0.2, "translate": [-0.4, 0.9, 0.6]}, {"time": 1.2, "translate": [-0.4, 0.9, 0.6], "axis": [0.2, 0.3, 1], "angle": 150}]
    grow = [{"time": 0, "translate": [-0.6, 0.7, 0.5], "scale": 0.5}, {"time": 1.5, "translate": [-0.6, 0.7, 0.5], "scale": [1.4, 1, 0.6], "rotate": [0, 70, 20]}]
    pan = [{"time": 0}, {"time": 1.5, "translate": [0.8, 0.2, -0.4], "axis": [0, 1, 0], "angle": 14}]
    lamp = {"geometry": "sphere", "emission": [9, 7, 5], "origin": [0, 2, 0.5], "radius": 0.3}
    across = [{"time": 0.2, "translate": [-1.5, 0, 0]}, {"time": 1.2, "translate": [1.5, 0.4, 0]}]
    pane = {"geometry": "quad", "emission": [6, 5, 4], "vertex-1": [-0.4, 2.4, -0.4], "vertex-2": [0.4, 2.4, -0.4], "vertex-3": [0.4, 2.4, 0.4], "vertex-4": [-0.4, 2.4, 0.4]}
    swing = [{"time": 0}, {"time": 0.7, "translate": [0, 1, 0], "rotate": [40, 0, 0]}, {"time": 1.4, "translate": [1, 1.2, 0], "rotate": [20, 30, 0]}]
    flag = [[[x, y, 0.6 + a * math.sin(3 * x + b)] for y in (0.3, 1.5) for x in np.linspace(-1.6, 0.4, 9)] for a, b in ((0.1, 0), (0.5, 1), (0.3, 3))]
    cloth = {
        "geometry": "mesh", "material": "clay", "positions": flag[0],
        "triangles": [t for i in range(8) for t in ([i, i + 1, 10 + i], [i, 10 + i, 9 + i])],
        "steps": [{"time": time, "positions": positions} for time, positions in zip((0.1, 0.8, 1.4), flag, strict=True)],
    }  # fmt: skip
    spot = {"type": "spot", "origin": [0, 3.2, 1.5], "direction": [0, -1, -0.4], "color": [30, 27, 22], "outerConeAngle": 32, "innerConeAngle": 10}
    point = {"type": "point", "origin": [-1, 2.2, 1.2], "color": [9, 8, 7]}
    ball = {"geometry": "sphere", "material": "metal", "origin": [0, 0, 0], "radius": 0.4}

    def shutter(curve):
        return CAMERA | {"shutter": CAMERA["shutter"] | {"curve": curve}}

    lens = shutter([1, 3, 0, 2]) | {"lensRadius": 0.1, "focusDistance": 4, "motion": pan}
    return {
        "an instance moves": stage([SKY, SUN], [instance | {"motion": fall}, instance | {"transform": {"translate": [0.6, 0.4, 1]}}], meshes=[box]),
        "a bar turns": stage([SKY, SUN], [block([2.2, 0.3, 0.2], "blue", motion=turn)]),
        "a cylinder turns": stage([SKY, SUN], [{"geometry": "cylinder", "base": [0, -1, 0], "axis": [0, 1, 0], "radius": 0.12, "height": 2, "material": "clay", "motion": turn}]),
        "a ball grows and turns": stage([SKY, SUN], [ball | {"motion": grow}]),
        "the camera moves": stage([SKY, SUN], [block([0.5, 1.6, 0.5], "blue", origin=[-0.6, 0.8, 0.4])], CAMERA | {"motion": pan}),
        "a ball that glows moves": stage([], [lamp | {"motion": across}, block([0.5, 1.2, 0.5], "blue", origin=[-0.4, 0.6, 0.4])]),
        "a pane that glows swings": stage([], [pane | {"motion": swing}, block([0.5, 1.2, 0.5], "blue", origin=[-0.4, 0.6, 0.4])]),
        "a point light moves": stage([point | {"motion": across}], [block([0.5, 1.2, 0.5], "blue", origin=[-0.4, 0.6, 0.4])]),
        "a spot light swings": stage([spot | {"motion": swing}], [block([0.5, 1.2, 0.5], "blue", origin=[-0.4, 0.6, 0.4])]),
        "a mesh deforms": stage([SKY, SUN], [cloth]),
        "a smooth mesh deforms": stage([SKY, SUN], [cloth | {"shading": "smooth"}]),
        "a mesh deforms and moves": stage([SKY, SUN], [cloth | {"motion": across}]),
        "trapezoid shutter": stage([SKY, SUN], [instance | {"motion": fall}], shutter("trapezoid"), meshes=[box]),
        "shutter by numbers, lens, all moves": stage(
            [SKY, spot | {"motion": swing}], [lamp | {"motion": across}, cloth, ball | {"motion": grow}], lens
        ),
    }  # fmt: skip


def controls(scenes):
    """Names, the scene for the open shutter, and another one for the stills."""
    result = {}
    for name, control, keys in (
        ("an instance moves", "an instance moves, the shutter closes later", {"close": 1.4}),
        ("the camera moves", "the camera moves, the shutter opens earlier", {"open": 0.0, "close": 1.0}),
        ("a point light moves", "a point light moves, trapezoid", {"curve": "trapezoid"}),
        ("trapezoid shutter", "trapezoid shutter, box", {"curve": "box"}),
    ):
        other = copy.deepcopy(scenes[name])
        other["camera"]["shutter"].update(keys)
        result[control] = (scenes[name], other)
    return result


def moments(shutter, count, random):
    """Times, one in each of `count` equal shares of the exposure."""
    curve = shutter.get("curve", "box")
    curve = {"box": [1, 1], "trapezoid": [0, 1, 1, 1, 0]}.get(curve, curve) if isinstance(curve, str) else curve
    t = np.linspace(0, 1, 1 << 16)
    total = np.cumsum(np.interp(0.5 * (t[1:] + t[:-1]), np.linspace(0, 1, len(curve)), curve))
    share = (np.arange(count) + random.random(count)) / count
    place = np.interp(share, np.concatenate([[0], total]) / total[-1], t)
    return shutter["open"] + place * (shutter["close"] - shutter["open"])


def render(args, file, folder, seed, spp, *options):
    output = folder / "image.pfm"
    size = "x".join(str(n) for n in args.resolution)
    fixed = ("--resolution", size, "--spp", spp, "--filter", "box", "--integrator", "path")
    ours.render(args.etendue, file, output, args.threads, seed, *fixed, *options)
    return pictures.read_pfm(output)


def compare(args, name, blurred, rest, folder, first):
    files = [folder / f"{who}.json" for who in ("blurred", "rest")]
    for file, scene in zip(files, (blurred, rest), strict=True):
        file.write_text(json.dumps(scene), encoding="utf-8")
    random, images = np.random.default_rng(first), [[], []]
    for seed in range(first, first + args.renders):
        images[0].append(render(args, files[0], folder, seed, args.stills * args.spp))
        times = moments(rest["camera"]["shutter"], args.stills, random)
        stills = [
            render(args, files[1], folder, 1000 * seed + i, args.spp, "--time-at", repr(float(time))) for i, time in enumerate(times)
        ]
        images[1].append(np.mean(stills, axis=0))
    if args.pictures:
        place = pathlib.Path(args.pictures)
        place.mkdir(parents=True, exist_ok=True)
        file = name.replace(",", "").replace(" ", "-")
        means = [np.mean(list_, axis=0) for list_ in images]
        difference = (means[0] - means[1]) / np.maximum(means[1], 0.05 * means[1].mean())
        for who, image in (("blurred", means[0]), ("stills", means[1]), ("difference", 0.2 + 2.0 * difference)):
            pictures.write_png(place / f"{file}-{who}.png", image)
    return Picture(name, *images)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("only", nargs="*", help="parts of the names of the cases to compare (default: all)")
    parser.add_argument("--resolution", type=int, nargs=2, default=(128, 96), metavar=("W", "H"))
    parser.add_argument("--renders", type=int, default=8, help="pictures with the shutter open, and means of stills (default 8)")
    parser.add_argument("--stills", type=int, default=64, help="stills in each mean (default 64)")
    parser.add_argument("--spp", type=int, default=2, help="samples per pixel of a still (default 2); a blurred picture has as many as its stills")
    parser.add_argument("--seed", type=int, default=1, help="another number makes other images")
    parser.add_argument("--threads", type=int, default=2, help="threads; 0 for all cores (default 2)")
    parser.add_argument("--etendue", default="target/release/examples/etendue", help="our program")
    parser.add_argument("--no-controls", action="store_true", help="leave out the scenes that must not be the same")
    parser.add_argument("--pictures", metavar="FOLDER", help="also write PNG pictures of both means and their difference")
    parser.add_argument("--markdown", metavar="FILE", help="also write the tables here")
    args = parser.parse_args()
    ours.find(args.etendue)
    lines, wrong = [], []

    def say(line):
        print(line, flush=True)
        lines.append(line)

    def wanted(name):
        return not args.only or any(part in name for part in args.only)

    scenes = cases()
    others = {} if args.no_controls else controls(scenes)
    if not any(map(wanted, [*scenes, *others])):
        sys.exit(f"no such case; there are: {', '.join([*scenes, *others])}")
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place)
        say(Picture.head("scene", "stills"))
        for index, (name, scene) in enumerate(scenes.items()):
            if wanted(name):
                found = compare(args, name, scene, scene, folder, 1 + 1000 * (100 * args.seed + index))
                say(found.row())
                wrong += [name] if found.wrong() else []
        if any(map(wanted, others)):
            say("\nControls, which must not be the same:\n")
            say(Picture.head("scene", "stills"))
        for index, (name, (blurred, rest)) in enumerate(others.items()):
            if wanted(name):
                found = compare(args, name, blurred, rest, folder, 1 + 1000 * (100 * args.seed + 50 + index))
                say(found.row())
                wrong += [] if found.differences() else [f"{name} (not found)"]
    say(f"\nMeans must agree within {100 * MEAN_BOUND:g} % and three standard errors.")
    if args.markdown:
        pathlib.Path(args.markdown).write_text("\n".join(lines) + "\n", encoding="utf-8")
    if wrong:
        sys.exit(f"not as it should be: {'; '.join(wrong)}")


if __name__ == "__main__":
    main()
