"""Writes the scene for time to equal error under a real sky, from an image of the sky that is not part of the repository.

OUT/NAME.json, after the image's name, stands beside everything it needs: the sky as 32-bit floating point without values below zero
(all renderers then read the same numbers, whatever they make of compression, chromaticities and negative light), and the meshes.
Everything is made of flat triangles, spheres too, so that the geometry is the same for all. Surfaces are Lambert's, and a metal with
rough facets.

    peers/sky.py city.exr            # from Debian's package blender-data: usr/share/blender/datafiles/studiolights/world
    peers/sky.py city.exr --bench    # makes the reference as well, and times all renderers: everything in one command

What follows `--` goes to bench.py: `-- --rounds 3 --peers mitsuba-llvm`.
"""

import argparse
import hashlib
import json
import math
import os
import pathlib
import shutil
import subprocess
import sys

try:
    import numpy as np
    import OpenEXR

    import pictures
except ImportError as missing:
    print(f"SKIPPED: {missing} (pip install numpy OpenEXR). NOTHING WAS WRITTEN.", file=sys.stderr)
    sys.exit(77)

HERE = pathlib.Path(__file__).resolve().parent
TEAPOT = HERE.parent / "scenes" / "meshes" / "teapot.obj"

COPPER = {"eta": [0.27, 0.68, 1.32], "k": [3.61, 2.63, 2.29]}
"""Roughly copper, by its index in three channels."""


def sphere(around=256, steps=128):
    """Positions and triangles of a unit sphere, y up, counter-clockwise from outside."""
    t, p = np.linspace(0, math.pi, steps + 1)[1:-1], np.linspace(0, 2 * math.pi, around, endpoint=False)
    rows = np.stack([np.outer(np.sin(t), np.cos(p)), np.outer(np.cos(t), np.ones_like(p)), np.outer(np.sin(t), np.sin(p))], -1)
    points = np.concatenate([[[0, 1, 0]], rows.reshape(-1, 3), [[0, -1, 0]]])
    last, triangles = len(points) - 1, []
    for j in range(around):
        k = (j + 1) % around
        triangles += [[0, 1 + k, 1 + j], [last, last - around + j, last - around + k]]
        for i in range(steps - 2):
            a, b = 1 + i * around, 1 + (i + 1) * around
            triangles += [[a + j, a + k, b + j], [a + k, b + k, b + j]]
    return points, np.array(triangles)


def write_obj(path, points, triangles):
    lines = [f"v {x:.7g} {y:.7g} {z:.7g}" for x, y, z in points] + [f"f {a} {b} {c}" for a, b, c in np.array(triangles) + 1]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def box(low, high):
    (x0, y0, z0), (x1, y1, z1) = low, high
    corners = [[x, y, z] for x in (x0, x1) for y in (y0, y1) for z in (z0, z1)]
    faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
    return {"geometry": "mesh", "positions": corners, "triangles": faces}


def description(sky, digest):
    metal = {"type": "conductor", "masking": "smith-separable", "multipleScattering": False} | COPPER
    ball = {"geometry": "mesh", "file": "sphere.obj"}
    return {
        "etendue": 1,
        "description": f"A floor, balls, a teapot and a box under a sky alone ({sky}, SHA-256 of its image {digest})",
        "camera": {"origin": [0.6, 2.6, 7.6], "lookAt": [0, 1.0, 0], "fieldOfView": 42},
        "textures": [{"name": "sky", "type": "image", "file": sky}],
        "lights": [{"type": "environment", "texture": "sky", "rotation": 150}],
        "materials": [
            {"name": "floor", "type": "diffuse", "color": [0.45, 0.43, 0.4]},
            {"name": "clay", "type": "diffuse", "color": [0.65, 0.3, 0.2]},
            {"name": "white", "type": "diffuse", "color": [0.75, 0.75, 0.72]},
            {"name": "blue", "type": "diffuse", "color": [0.15, 0.25, 0.5]},
            {"name": "copper", "roughness": 0.35} | metal,
            {"name": "dull copper", "roughness": 0.6} | metal,
        ],
        "surfaces": [
            {
                "geometry": "quad", "material": "floor",
                "vertex-1": [-12, 0, 9], "vertex-2": [12, 0, 9], "vertex-3": [12, 0, -12], "vertex-4": [-12, 0, -12],
            },
            ball | {"material": "copper", "scale": 0.9, "origin": [-2.1, 0.9, 0.6]},
            ball | {"material": "clay", "scale": 0.6, "origin": [1.9, 0.6, 2.2]},
            ball | {"material": "dull copper", "scale": 0.45, "origin": [0.4, 0.45, 2.9]},
            {"geometry": "mesh", "file": "teapot.obj", "material": "white", "scale": 0.75, "origin": [0.5, 0, 0]},
            box([2.2, 0, -2.4], [3.6, 2.6, -1.2]) | {"material": "blue", "transform": {"rotate": [0, 15, 0]}},
        ],
    }  # fmt: skip


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    default = os.environ.get("ETENDUE_SKY")
    parser.add_argument("sky", nargs="?" if default else None, default=default, help="OpenEXR image by longitude and latitude (default: the variable ETENDUE_SKY)")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/sky"), help="folder")
    parser.add_argument("--bench", action="store_true", help="make the reference (or go on with it) and run bench.py")
    parser.add_argument("--etendue", default="target/release/examples/etendue", help="our program")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--reference-spp", type=int, default=64, help="samples per pixel of each render of the reference (default 64)")
    parser.add_argument("--reference-renders", type=int, default=128, help="renders of the reference (default 128)")
    parser.add_argument("--references", type=pathlib.Path, default=pathlib.Path("out/references"), help="their folder")
    own = sys.argv[1:]
    split = own.index("--") if "--" in own else len(own)
    args, further = parser.parse_args(own[:split]), own[split + 1 :]
    image = pictures.read_exr(args.sky)
    if image is None:
        sys.exit(f"{args.sky} has no channels R, G and B")
    name = pathlib.Path(args.sky).stem
    args.out.mkdir(parents=True, exist_ok=True)
    image = np.maximum(image, 0.0).astype(np.float32)
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, {"RGB": image}).write(str(args.out / f"{name}-sky.exr"))
    write_obj(args.out / "sphere.obj", *sphere())
    shutil.copyfile(TEAPOT, args.out / "teapot.obj")
    scene = description(f"{name}-sky.exr", hashlib.sha256(image.tobytes()).hexdigest()[:16])
    (args.out / f"{name}.json").write_text(json.dumps(scene, indent=1) + "\n", encoding="utf-8")
    file = args.out / f"{name}.json"
    print(file, flush=True)
    if args.bench:
        both = ["--etendue", args.etendue, "--threads", args.threads, "--references", args.references]
        renders = ["--spp", args.reference_spp, "--renders", args.reference_renders]
        run(HERE / "references.py", file, *both, *renders)
        places = [x for kind in ("json", "markdown") for x in (f"--{kind}", args.out / f"{name}-bench.{kind.replace('markdown', 'md')}")]
        chosen = ["--lambert", "no", "--peers", "mitsuba-llvm", "cycles", "--budgets", 2, 8, "--png", args.out / "png"]
        run(HERE / "bench.py", file, *both, *places, *chosen, *further)


def run(script, *arguments):
    done = subprocess.run([str(x) for x in (sys.executable, script, *arguments)])
    if done.returncode:
        sys.exit(done.returncode)


if __name__ == "__main__":
    main()
