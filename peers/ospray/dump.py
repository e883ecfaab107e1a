"""Writes one of our scenes as `host_bench.c` reads it: a text of lines, and a binary file for every mesh.

Spheres stay analytic unless they glow: OSPRay's sphere lights throw no shadow, and a geometry that is to be sampled as
a light must be a mesh. Lamps of polygons become luminous meshes with a black one a hair behind them, for OSPRay's
luminous material shines on both sides.
"""

import argparse
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "mitsuba"))

import numpy as np
import scene as reader

BEHIND = 1e-4
"""Distance of a lamp's black back, as a share of the lamp's extent."""


def ball(centre, radius):
    """A sphere as a mesh of about a thousand triangles of the same area, and no normals."""
    t = np.linspace(0.0, 1.0, 17)
    rows = np.stack([np.sin(np.pi * t), np.sin(np.pi * t), np.cos(np.pi * t)], 1)
    positions, _, triangles = reader.swept((rows, lambda p: p), around=32)
    p = positions[triangles]
    area = 0.5 * np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1).sum()
    return np.array(centre) + radius * math.sqrt(4 * math.pi / area) * positions, None, triangles


class Converter(reader.Converter):
    def __init__(self, path, folder):
        super().__init__(path)
        self.output, self.lines, self.numbers = pathlib.Path(folder), [], {}

    def line(self, *words):
        self.lines.append(" ".join(w if isinstance(w, str) else f"{float(w):.9g}" for w in words))

    def bsdf(self, material):
        return None

    def material(self, name):
        """The number of a material, whose line is written when it is first used."""
        if name in self.numbers:
            return str(self.numbers[name])
        m = {"type": "black"} if name is None else self.materials[name]
        color = [0, 0, 0] if m["type"] == "black" else m.get("color", [1, 1, 1])
        if m["type"] in ("diffuse", "black"):
            if m.get("brdf", "lambertian") != "lambertian":
                raise reader.Unsupported(f"error: brdf {m['brdf']}: OSPRay has no such diffuse model")
            self.line("material", "diffuse", *color)
        elif m["type"] == "reflective":
            self.line("material", "mirror", *color)
        elif m["type"] == "refractive":
            self.line("material", "glass", m["refractionIndex"], m.get("exteriorIndex", 1.0), 0)
        else:
            raise reader.Unsupported(f"error: material type {m['type']}")
        self.numbers[name] = len(self.numbers)
        return str(self.numbers[name])

    def luminous(self, emission):
        key = ("emission", *emission)
        if key not in self.numbers:
            self.line("material", "luminous", *emission)
            self.numbers[key] = len(self.numbers)
        return str(self.numbers[key])

    def add_shape(self, shape, material, emission):
        if shape["type"] != "sphere":
            raise reader.Unsupported(f"error: a {shape['type']}")
        if emission is None:
            number = self.material(material)
            self.line("sphere", number, *shape["center"], shape["radius"])
        elif material is not None:
            raise reader.Unsupported("error: a lamp that reflects")
        else:
            self.write_mesh(self.luminous(emission), *ball(shape["center"], shape["radius"]))

    def write_mesh(self, number, positions, normals, triangles):
        file = self.output / f"{self.count}.mesh"
        self.count += 1
        arrays = [(positions, "<f4"), (triangles, "<u4")] + ([] if normals is None else [(normals, "<f4")])
        file.write_bytes(b"".join(np.ascontiguousarray(a).astype(t).tobytes() for a, t in arrays))
        self.line("mesh", number, str(len(positions)), str(len(triangles)), "0" if normals is None else "1", file.name)

    def add_placed(self, positions, normals, triangles, smooth, material, emission):
        if emission is None:
            self.write_mesh(self.material(material), positions, normals, triangles)
            return
        if material is not None:
            raise reader.Unsupported("error: a lamp that reflects")
        self.write_mesh(self.luminous(emission), positions, None, triangles)
        corners = positions[triangles]
        face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        face = face / np.maximum(np.linalg.norm(face, axis=1, keepdims=True), 1e-30)
        back = corners - BEHIND * np.ptp(positions, axis=0).max() * face[:, None]
        indices = np.arange(3 * len(back)).reshape(-1, 3)
        self.write_mesh(self.material(None), back.reshape(-1, 3), None, indices)

    def camera(self, resolution):
        width, height = resolution
        c = self.json["camera"]
        if not self.native or c.get("type") == "view-plane":
            raise reader.Unsupported("error: the view-plane camera")
        origin, target = reader.vec(c.get("origin", [0, 0, 0])), reader.vec(c.get("lookAt", [0, 0, -1]))
        half = math.tan(math.radians(c.get("fieldOfView", 90.0)) / 2)
        vertical = c.get("fieldOfViewAxis", "horizontal") == "vertical"
        fov = 2 * math.degrees(math.atan(half if vertical else half * height / width))
        self.line("camera", *origin, *(target - origin), *c.get("up", [0, 1, 0]), fov, width / height)

    def write(self, resolution):
        self.line("image", str(resolution[0]), str(resolution[1]))
        self.camera(resolution)
        for light in self.json.get("lights", []):
            if light["type"] != "area":
                raise reader.Unsupported("error: a point light")
            self.add_light(light)
        for surface in self.json.get("surfaces", []):
            self.add_surface(surface)
        for (material, emission), triangles in self.soups.items():
            points = np.array(triangles).reshape(-1, 3)
            self.add_mesh(points, None, np.arange(len(points)).reshape(-1, 3), np.eye(4), False, material, emission)
        (self.output / "scene.txt").write_text("\n".join(self.lines) + "\n", encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", help="native scene file")
    parser.add_argument("folder", help="where to write scene.txt and its meshes")
    parser.add_argument("--resolution", type=int, nargs=2, default=[256, 256], metavar=("W", "H"))
    args = parser.parse_args()
    pathlib.Path(args.folder).mkdir(parents=True, exist_ok=True)
    converter = Converter(args.scene, args.folder)
    try:
        converter.write(args.resolution)
    except reader.Unsupported as reason:
        sys.exit(f"{args.scene}: {reason}")
    finally:
        converter.close()


if __name__ == "__main__":
    main()
