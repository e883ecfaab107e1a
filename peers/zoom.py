"""Turns the camera of a scene to one box of its pixels, square, with a field of view that just covers it.

A path tracer that finds a caustic once in a thousand tries then spends all of them there, and the mean of the picture
is an unbiased figure that other integrators must meet. Row 0 is on top; the picture is not a crop of the scene's, for
the image plane turns with the camera.
"""

import argparse
import json
import math
import pathlib
import sys

import numpy as np


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene", help="native scene without mesh files, camera a perspective one")
    parser.add_argument("box", type=float, nargs=4, help="X0 Y0 X1 Y1, of the scene's own pixels")
    parser.add_argument("output", help="scene file to write")
    parser.add_argument("--resolution", type=int, default=16, help="pixels on a side (default 16)")
    args = parser.parse_args()
    scene = json.loads(pathlib.Path(args.scene).read_text(encoding="utf-8"))
    camera, (width, height) = scene["camera"], scene["render"]["resolution"]
    if camera.get("type", "perspective") != "perspective":
        sys.exit(f"{args.scene}: not a perspective camera")
    origin, target, up = (
        np.array(camera.get(k, d), dtype=float)
        for k, d in (("origin", [0] * 3), ("lookAt", [0, 0, -1]), ("up", [0, 1, 0]))
    )
    forward = (target - origin) / np.linalg.norm(target - origin)
    right = np.cross(forward, up) / np.linalg.norm(np.cross(forward, up))
    up = np.cross(right, forward)
    side = height if camera.get("fieldOfViewAxis", "horizontal") == "vertical" else width
    pixel = 2 * math.tan(math.radians(camera.get("fieldOfView", 90.0)) / 2) / side
    x0, y0, x1, y1 = args.box
    x, y = ((x0 + x1) / 2 - width / 2) * pixel, (height / 2 - (y0 + y1) / 2) * pixel
    toward = forward + x * right + y * up
    # Half the longer side of the box, at the distance of its centre.
    half = max(x1 - x0, y1 - y0) / 2 * pixel / np.linalg.norm(toward)
    camera |= {
        "lookAt": (origin + toward).round(9).tolist(),
        "fieldOfView": round(math.degrees(2 * math.atan(half)), 9),
    }
    scene["render"]["resolution"] = [args.resolution] * 2
    pathlib.Path(args.output).write_text(json.dumps(scene, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
