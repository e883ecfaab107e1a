"""Writes one of our scenes for POV-Ray 3.7: radiosity, area lights, photons for glass and mirrors.

POV-Ray has no rough diffuse surface; `--lambert FILE` also writes our own scene with Lambert's in its place, to be the
other side of the comparison. What else differs is in ../README.md.
"""

import argparse
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "mitsuba"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))

import numpy as np
import ours
import scene as reader

FADE = 1e-3
"""POV-Ray's falloff is 2 / (1 + (d / FADE)^2): with FADE far below any distance it is 2 FADE^2 / d^2."""


def v(x):
    return "<" + ",".join(f"{float(a):.9g}" for a in x) + ">"


class Writer(reader.Converter):
    """One scene on its way into POV-Ray's language. Vertices and the camera's vectors are given as they are, so that
    POV-Ray's left-handed frame does not matter."""

    def __init__(self, path, args):
        super().__init__(path, fujii="lambertian")
        self.args, self.text, self.lamps = args, [], []

    def bsdf(self, material):
        return None

    def finish(self, name, photons):
        m = {"type": "black"} if name is None else self.materials[name]
        color = v(m.get("color", [1, 1, 1]))
        if m["type"] == "diffuse":
            return f"pigment {{ rgb {color} }} finish {{ ambient 0 emission 0 diffuse 1 }}"
        if m["type"] == "black":
            return "pigment { rgb 0 } finish { ambient 0 emission 0 diffuse 0 }"
        target = "photons { target reflection on refraction on collect off }" if photons else ""
        if m["type"] == "reflective":
            return (
                f"pigment {{ rgb 0 }} finish {{ ambient 0 emission 0 diffuse 0 reflection {{ rgb {color} }} }} {target}"
            )
        if m["type"] == "refractive":
            if m.get("exteriorIndex", 1.0) != 1.0:
                raise reader.Unsupported("an exterior index other than 1")
            return (
                "pigment { rgb 1 transmit 1 } finish { ambient 0 emission 0 diffuse 0 reflection { 0, 1 fresnel on }"
                f" conserve_energy }} interior {{ ior {m['refractionIndex']} }} {target}"
            )
        raise reader.Unsupported(f"material type {m['type']}")

    def add_shape(self, shape, material, emission):
        if shape["type"] != "sphere":
            raise reader.Unsupported(f"a {shape['type']}")
        if emission is not None:
            raise reader.Unsupported("a glowing sphere")
        look = self.finish(material, self.args.photons)
        centre, radius = self.args.scale * reader.vec(shape["center"]), self.args.scale * shape["radius"]
        self.text.append(f"sphere {{ {v(centre)}, {radius:.9g} {look} }}")

    def add_placed(self, positions, normals, triangles, smooth, material, emission):
        corners = (self.args.scale * positions)[triangles]
        if normals is not None:
            raise reader.Unsupported("a smooth mesh")
        faces = "\n".join(f"triangle {{ {v(a)}, {v(b)}, {v(c)} }}" for a, b, c in corners)
        if emission is None:
            # Large mirrors scatter photons over the whole room, which spends them badly: only round things are targets.
            self.text.append(f"mesh {{\n{faces}\n{self.finish(material, False)} }}")
            return
        if material is not None:
            raise reader.Unsupported("a lamp that reflects")
        # The lamp as it is seen. With light sources beside it, radiosity must not count it again.
        unseen = "" if self.args.lamps == "emission" else "no_radiosity"
        glow = f"pigment {{ rgb {v(emission)} }} finish {{ ambient 0 diffuse 0 emission 1 }}"
        self.text.append(f"mesh {{\n{faces}\n{glow} no_shadow {unseen} }}")
        if self.args.lamps == "area":
            self.lamps.append((corners, emission))

    def add_polygon(self, vertices, matrix, material, emission):
        """Walls reach a little beyond each other: radiosity's rays leave through a seam, and it grows dark there."""
        if emission is None:
            points = reader.vec(vertices)
            vertices = points + self.args.overlap * (points - points.mean(0))
        super().add_polygon(vertices, matrix, material, emission)

    def lights(self):
        """Area lights that fill the lamps: each lamp is cut into strips between the corners of its outline."""
        for corners, emission in self.lamps:
            flat = corners.reshape(-1, 3)
            y = flat[:, 1]
            if np.ptp(y) > 1e-6 * np.ptp(flat):
                raise reader.Unsupported("a lamp that is not horizontal: it cannot be cut into strips here")
            normal = np.cross(corners[0, 1] - corners[0, 0], corners[0, 2] - corners[0, 0])
            way = -1.0 if normal[1] < 0 else 1.0
            for x0, x1 in strips(np.unique(flat[:, 0].round(6)), self.args.strip * self.args.scale):
                # The width in z of the lamp at the middle of the strip, so that its area is right.
                z = crossings(corners, (x0 + x1) / 2)
                if z is None:
                    continue
                size = [x1 - x0, z[1] - z[0]]
                middle = [(x0 + x1) / 2, y[0] + way * 1e-4 * self.args.scale, (z[0] + z[1]) / 2]
                # Radiance L of area A: irradiance L A cos cos / d^2, which POV-Ray divides by pi.
                power = np.array(emission) * size[0] * size[1] / math.pi / (2 * FADE**2)
                nx, nz = (max(1, round(s / self.args.spacing / self.args.scale)) for s in size)
                # Points of the grid stand in the middle of their cells.
                side_x, side_z = size[0] * (nx - 1) / nx, size[1] * (nz - 1) / nz
                gather = "photons { reflection on refraction on area_light }" if self.args.photons else ""
                self.text.append(
                    f"light_source {{ {v(middle)}, rgb {v(power)}\n"
                    f"  spotlight point_at {v(np.add(middle, [0, way, 0]))} radius 0 falloff 90 tightness 1\n"
                    f"  area_light {v([side_x, 0, 0])}, {v([0, 0, side_z])}, {nx}, {nz}\n"
                    f"  {'adaptive ' + str(self.args.adaptive) if self.args.adaptive >= 0 else ''} jitter"
                    f" area_illumination on\n"
                    f"  fade_distance {FADE} fade_power 2\n  {gather} }}"
                )

    def camera(self, resolution):
        width, height = resolution
        c = self.json["camera"]
        if not self.native or c.get("type") == "view-plane":
            raise reader.Unsupported("the view-plane camera")
        origin, target = reader.vec(c.get("origin", [0, 0, 0])), reader.vec(c.get("lookAt", [0, 0, -1]))
        forward = (target - origin) / np.linalg.norm(target - origin)
        right = np.cross(forward, reader.vec(c.get("up", [0, 1, 0])))
        right = right / np.linalg.norm(right)
        half = math.tan(math.radians(c.get("fieldOfView", 90.0)) / 2)
        vertical = c.get("fieldOfViewAxis", "horizontal") == "vertical"
        x, y = (half * width / height, half) if vertical else (half, half * height / width)
        up = np.cross(right, forward)
        self.text.append(
            f"camera {{ perspective location {v(self.args.scale * origin)} direction {v(forward)}"
            f" right {v(2 * x * right)} up {v(2 * y * up)} }}"
        )

    def write(self, resolution):
        a = self.args
        for surface in self.json.get("surfaces", []):
            self.add_surface(surface)
        for light in self.json.get("lights", []):
            if light["type"] != "area":
                raise reader.Unsupported("a point light")
            self.add_light(light)
        for (material, emission), triangles in self.soups.items():
            points = np.array(triangles).reshape(-1, 3)
            self.add_mesh(points, None, np.arange(len(points)).reshape(-1, 3), np.eye(4), False, material, emission)
        self.soups = {}
        self.lights()
        self.camera(resolution)
        photons = f"photons {{ count {a.photons} max_trace_level 10 autostop 0 gather 20, 80 }}" if a.photons else ""
        head = (
            "#version 3.7;\n"
            f"global_settings {{ assumed_gamma 1 max_trace_level {a.trace_level} adc_bailout 0.0005 {photons}\n"
            f"  radiosity {{ count {a.count} error_bound {a.error_bound} recursion_limit {a.recursion}\n"
            f"    pretrace_start 0.08 pretrace_end {a.pretrace_end} nearest_count {a.nearest}"
            f" low_error_factor {a.low_error}\n"
            f"    minimum_reuse {a.minimum_reuse} maximum_reuse 0.2 gray_threshold 0 brightness 1 adc_bailout 0.0005\n"
            "    always_sample off normal off media off } }\n"
            "background { rgb 0 }\n"
        )
        return head + "\n".join(self.text) + "\n"


def strips(breaks, width):
    """Intervals between neighbouring breaks, each cut into parts no wider than `width`."""
    for x0, x1 in zip(breaks, breaks[1:], strict=False):
        n = max(1, math.ceil((x1 - x0) / width - 1e-9))
        for i in range(n):
            yield x0 + (x1 - x0) * i / n, x0 + (x1 - x0) * (i + 1) / n


def crossings(corners, x):
    """Smallest and largest z where the triangles are crossed by the line of this x; None if they are not."""
    found = []
    for triangle in corners:
        for a, b in ((0, 1), (1, 2), (2, 0)):
            p, q = triangle[a], triangle[b]
            if (p[0] - x) * (q[0] - x) < 0:
                found.append(p[2] + (q[2] - p[2]) * (x - p[0]) / (q[0] - p[0]))
    return (min(found), max(found)) if found else None


def add_arguments(parser):
    parser.add_argument(
        "--lamps", choices=["area", "emission"], default="emission", help="area lights, or radiosity alone"
    )
    parser.add_argument("--count", type=int, default=200, help="rays of a radiosity sample")
    parser.add_argument("--error-bound", type=float, default=0.25)
    parser.add_argument("--recursion", type=int, default=16, help="diffuse bounces")
    parser.add_argument("--pretrace-end", type=float, default=0.01)
    parser.add_argument("--nearest", type=int, default=8)
    parser.add_argument("--low-error", type=float, default=0.6)
    parser.add_argument("--minimum-reuse", type=float, default=0.015)
    parser.add_argument("--photons", type=int, default=0, help="photons shot; 0 for none")
    parser.add_argument("--spacing", type=float, default=1.0, help="distance of an area light's points, scene units")
    parser.add_argument("--strip", type=float, default=2.0, help="widest strip of a lamp, scene units")
    parser.add_argument("--adaptive", type=int, default=1, help="of area lights; -1 for full")
    parser.add_argument("--overlap", type=float, default=1e-3, help="by which share of their size walls overlap")
    parser.add_argument("--scale", type=float, default=100.0, help="of all lengths, against POV-Ray's fixed tolerances")
    parser.add_argument("--trace-level", type=int, default=30)


def write(path, output, resolution, args):
    writer = Writer(path, args)
    try:
        text = writer.write(resolution or writer.json.get("render", {}).get("resolution", [256, 256]))
    except reader.Unsupported as error:
        sys.exit(f"{path}: {error}")
    finally:
        writer.close()
    pathlib.Path(output).write_text(text, encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("output", help=".pov to write")
    parser.add_argument("--resolution", type=int, nargs=2, metavar=("W", "H"))
    parser.add_argument("--lambert", help="also write our scene without rough diffuse materials here")
    add_arguments(parser)
    args = parser.parse_args()
    write(args.scene, args.output, args.resolution, args)
    if args.lambert:
        ours.lambert(args.scene, args.lambert)


if __name__ == "__main__":
    main()
