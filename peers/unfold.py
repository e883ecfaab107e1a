"""Replaces a plane mirror of reflectance 1 in a wall by a hole into the mirror image of the room.

By the method of images both scenes have the same radiance on our side. In the unfolded one the mirror's caustics are
ordinary diffuse surfaces seen directly, so a particle tracer or bidirectional path tracer finds them without bias. The
mirror must be axis-aligned, one quad, and fill its hole in the wall exactly; all else must lie on one side of it.
Takes spheres, triangles and quads without transforms, which is what scenes/caustic-mirror.json is made of.
"""

import argparse
import json
import pathlib
import sys


def corners(surface):
    return [key for key in sorted(surface) if key.startswith("vertex-")]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene", help="native scene with one mirror")
    parser.add_argument("output", help="scene file to write")
    args = parser.parse_args()
    scene = json.loads(pathlib.Path(args.scene).read_text(encoding="utf-8"))

    mirrors = {
        m["name"] for m in scene["materials"] if m["type"] == "reflective" and m.get("color", [1] * 3) == [1] * 3
    }
    panels = [s for s in scene["surfaces"] if s.get("material") in mirrors]
    if len(panels) != 1 or panels[0]["geometry"] != "quad":
        sys.exit(f"{args.scene}: wants one quad that is a mirror of reflectance 1, found {len(panels)}")
    points = [panels[0][key] for key in corners(panels[0])]
    axes = [a for a in range(3) if len({p[a] for p in points}) == 1]
    if len(axes) != 1 or scene.get("lights"):
        sys.exit(f"{args.scene}: the mirror must be axis-aligned, and lights surfaces with an emission")
    axis, plane = axes[0], points[0][axes[0]]

    def image(point):
        return [2 * plane - x if a == axis else x for a, x in enumerate(point)]

    unfolded = []
    for s in scene["surfaces"]:
        if s is panels[0]:
            continue
        unfolded.append(s)
        if s["geometry"] not in ("sphere", "triangle", "quad") or "transform" in s:
            sys.exit(f"{args.scene}: surfaces must be spheres, triangles or quads without transform")
        keys = corners(s) or ["origin"]
        if all(s[key][axis] == plane for key in keys):
            continue  # The wall around the mirror is its own image.
        # The order of corners is reversed, so that the normal is the image of the normal.
        unfolded.append(s | dict(zip(keys, (image(s[key]) for key in reversed(keys)), strict=True)))
    scene["surfaces"] = unfolded
    scene["materials"] = [m for m in scene["materials"] if m["name"] not in mirrors]
    pathlib.Path(args.output).write_text(json.dumps(scene, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
