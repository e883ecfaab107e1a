"""Reads one of our scenes (native, or the 2017 report's) into Mitsuba 3. As a program, renders it once.

The image is oriented as ours: row 0 on top, not mirrored, scene-linear radiance. What differs is in ../README.md.
"""

import argparse
import json
import math
import pathlib
import sys
import tempfile

import backend  # First, for its message when something is missing.
import lights
import materials
import numpy as np
from materials import Unsupported


def vec(value):
    return np.array(value, dtype=np.float64)


def translation(offset):
    m = np.eye(4)
    m[:3, 3] = offset
    return m


def rotation(angles):
    """Rz Ry Rx about the axes of the world, radians."""
    (sx, sy, sz), (cx, cy, cz) = np.sin(angles), np.cos(angles)
    rx = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    ry = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    rz = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    m = np.eye(4)
    m[:3, :3] = rz @ ry @ rx
    return m


def transform_of(surface):
    """Object to world of a native surface: one step or several, the first applied first."""
    steps = surface.get("transform", [])
    result = np.eye(4)
    for step in [steps] if isinstance(steps, dict) else steps:
        if "matrix" in step:
            m = np.array(step["matrix"], dtype=np.float64).reshape(4, 4)
        else:
            scale = np.diag(np.append(np.broadcast_to(vec(step.get("scale", 1.0)), 3), 1.0))
            turn = rotation(np.radians(step.get("rotate", [0, 0, 0])))
            m = translation(step.get("translate", [0, 0, 0])) @ turn @ scale
        result = m @ result
    return result


def placement_of(surface):
    """A mesh's own keys: scale, rotate (radians), move. Native files add a `transform` after it."""
    scale = np.diag([surface.get("scale", 1.0)] * 3 + [1.0])
    return translation(surface.get("origin", [0, 0, 0])) @ rotation(vec(surface.get("rotate", [0, 0, 0]))) @ scale


def read_plain_obj(path):
    """A large OBJ of nothing but positions and triangles, some ten times faster than line by line; None if it has more."""
    lines = pathlib.Path(path).read_text(encoding="utf-8").splitlines()
    v = [line[2:] for line in lines if line.startswith("v ")]
    f = [line[2:] for line in lines if line.startswith("f ")]
    if len(v) + len(f) + sum(line.startswith("#") or not line for line in lines) != len(lines) or any(
        "/" in x for x in f
    ):
        return None
    positions, triangles = (np.fromstring(" ".join(x), sep=" ") for x in (v, f))
    if len(positions) != 3 * len(v) or len(triangles) != 3 * len(f) or triangles.min() < 1:
        return None
    return positions.reshape(-1, 3), None, triangles.reshape(-1, 3).astype(np.int64) - 1


def read_obj(path):
    """Positions, normals (or None) per corner-unique vertex and triangles of a Wavefront OBJ; polygons become fans."""
    plain = read_plain_obj(path)
    if plain is not None:
        return plain
    v, vn, corners, index, triangles = [], [], [], {}, []
    with open(path, encoding="utf-8") as file:
        for line in file:
            part = line.split()
            if not part:
                continue
            if part[0] == "v":
                v.append([float(x) for x in part[1:4]])
            elif part[0] == "vn":
                vn.append([float(x) for x in part[1:4]])
            elif part[0] == "f":
                ids = []
                for corner in part[1:]:
                    field = (corner.split("/") + ["", ""])[:3]
                    key = tuple((int(x) if x else 0) for x in (field[0], field[2]))
                    # Negative numbers count from the end; 0 is a normal left out.
                    key = tuple(k if k >= 0 else n + 1 + k for k, n in zip(key, (len(v), len(vn)), strict=True))
                    if key not in index:
                        index[key] = len(corners)
                        corners.append(key)
                    ids.append(index[key])
                triangles += [[ids[0], ids[i], ids[i + 1]] for i in range(1, len(ids) - 1)]
    positions = np.array([v[a - 1] for a, _ in corners], dtype=np.float64)
    has_normals = bool(vn) and all(b for _, b in corners)
    normals = np.array([vn[b - 1] for _, b in corners], dtype=np.float64) if has_normals else None
    return positions, normals, np.array(triangles, dtype=np.int64)


def write_ply(path, positions, normals, triangles, uvs=None):
    """A binary PLY that Mitsuba reads, in single precision."""
    names = ["x", "y", "z"] + (["nx", "ny", "nz"] if normals is not None else []) + (["u", "v"] if uvs is not None else [])
    columns = [positions] + [extra for extra in (normals, uvs) if extra is not None]
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(positions)}\n"
    header += "".join(f"property float {n}\n" for n in names)
    header += f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    faces = np.empty(len(triangles), dtype=[("n", "u1"), ("v", "<i4", 3)])
    faces["n"], faces["v"] = 3, triangles
    with open(path, "wb") as file:
        file.write(header.encode())
        file.write(np.hstack(columns).astype("<f4").tobytes())
        file.write(faces.tobytes())


def swept(profile, around=512):
    """A smooth mesh over t in [0, 1] and an angle; `profile` gives half-axes, height and a function for the gradient.

    Rows (rx, ry, z) are ellipses x = rx cos, y = ry sin; `gradient` maps points to normals of any length.
    """
    rows, gradient = profile
    phi = np.linspace(0, 2 * math.pi, around + 1)
    points = np.stack(
        [np.outer(rows[:, 0], np.cos(phi)), np.outer(rows[:, 1], np.sin(phi)), np.outer(rows[:, 2], np.ones_like(phi))],
        2,
    ).reshape(-1, 3)
    n = around + 1
    i, j = np.meshgrid(np.arange(len(rows) - 1), np.arange(around), indexing="ij")
    a = (i * n + j).ravel()
    triangles = np.concatenate([np.stack([a, a + 1, a + n + 1], 1), np.stack([a, a + n + 1, a + n], 1)])
    normals = gradient(points)
    normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    # Wind every triangle so that its face agrees with its vertex normals; leave out those without area at a pole.
    p = points[triangles]
    face = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    wrong = np.einsum("ij,ij->i", face, normals[triangles].sum(1)) < 0
    triangles[wrong] = triangles[wrong][:, ::-1]
    return points, normals, triangles[np.linalg.norm(face, axis=1) > 1e-14]


def frame(origin, axis):
    """A rigid frame with its z axis along `axis`."""
    z = vec(axis) / np.linalg.norm(axis)
    x = np.cross(z, np.eye(3)[np.argmin(np.abs(z))])
    x = x / np.linalg.norm(x)
    m = np.eye(4)
    m[:3, 0], m[:3, 1], m[:3, 2], m[:3, 3] = x, np.cross(z, x), z, origin
    return m


def quadric(surface, steps=256):
    """A fine smooth mesh (steps x 512 quadrilaterals) for a quadric, which Mitsuba does not have, and its own frame."""
    kind, t = surface["geometry"], np.linspace(0.0, 1.0, steps + 1)
    if kind in ("sphere", "ellipsoid"):
        radii = np.broadcast_to(vec(surface["radius" if kind == "sphere" else "radii"]), 3)
        s, c = np.sin(math.pi * t), np.cos(math.pi * t)
        rows = np.stack([radii[0] * s, radii[1] * s, radii[2] * c], 1)
        return swept((rows, lambda p: p / radii**2)), translation(surface["origin"])
    if kind in ("cylinder", "cone"):
        r, h = surface["radius"], surface["height"]
        radius = r * (1 - t) if kind == "cone" else np.full_like(t, r)
        slope = r * r / h if kind == "cone" else 0.0

        def gradient(p):
            # Outwards at an angle; the apex takes the direction of its neighbours, which has no meaning there.
            d = np.stack([p[:, 0], p[:, 1], np.zeros(len(p))], 1)
            d = d / np.maximum(np.linalg.norm(d, axis=1, keepdims=True), 1e-30)
            return d + np.array([0, 0, slope / r])

        return swept((np.stack([radius, radius, h * t], 1), gradient)), frame(surface["base"], surface["axis"])
    if kind == "paraboloid":
        r, h = surface["radius"], surface["height"]
        rows = np.stack([r * t, r * t, h * t * t], 1)
        place = frame(surface["apex"], surface["axis"])
        return swept((rows, lambda p: p * [1, 1, 0] + [0, 0, -r * r / h / 2])), place
    if kind == "disk":
        rows = np.stack([surface["radius"] * t, surface["radius"] * t, 0 * t], 1)
        return swept((rows, lambda p: p * 0 + [0, 0, 1])), frame(surface["origin"], surface["normal"])
    a, b, c, d, e, f, g, h, i, j = surface["coefficients"]
    if not any((d, e, f, g, h, i)) and a > 0 and b > 0:
        # Ellipses around z; the clip box must cut along z only.
        z = surface["clip"]["min"][2] + t * (surface["clip"]["max"][2] - surface["clip"]["min"][2])
        square = np.maximum(-(c * z * z + j), 0.0)
        rows = np.stack([np.sqrt(square / a), np.sqrt(square / b), z], 1)
        low, high = vec(surface["clip"]["min"]), vec(surface["clip"]["max"])
        if np.all(rows[:, :2].max(0) <= np.minimum(-low, high)[:2]):
            return swept((rows, lambda p: p * [a, b, c])), np.eye(4)
    raise Unsupported("this quadric: only those around the z axis, clipped along z, are tessellated")


class Converter:
    """One scene on its way into a Mitsuba dictionary. Temporary meshes live until `close`."""

    def __init__(self, path, mirror=None, fujii="fujii"):
        """`mirror`: a constant reflectance for all mirrors (the report's program has 0.9), None for their colours.
        `fujii`: "fujii", or "lambertian" to render rough diffuse materials as Lambert's."""
        self.path = pathlib.Path(path)
        with open(path, encoding="utf-8") as file:
            self.json = json.load(file)
        self.native = "etendue" in self.json
        self.mirror, self.fujii = mirror, fujii
        self.folder = tempfile.TemporaryDirectory()
        self.materials = {}
        for m in self.json.get("materials", []):
            self.materials.setdefault(m["name"], m)
        self.meshes = {m["name"]: m for m in self.json.get("meshes", [])}
        self.textures = {t["name"]: t for t in self.json.get("textures", [])}
        self.behind = lights.evenly(self.json.get("lights", []))
        self.soups, self.shapes, self.count = {}, {}, 0

    def close(self):
        self.folder.cleanup()

    def bsdf(self, material):
        """The Mitsuba BSDF of one of our materials."""
        kind = material["type"]
        lights.refuse(material, f"material {material.get('name', kind)}", "textures")
        color = {"type": "rgb", "value": material.get("color", [1, 1, 1])}
        if kind == "black":
            return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0, 0, 0]}}}
        if kind == "reflective":
            if self.mirror is not None:
                color = {"type": "rgb", "value": [self.mirror] * 3}
            mirror = {"type": "conductor", "material": "none", "specular_reflectance": color}
            return {"type": "twosided", "bsdf": mirror}
        if kind != "diffuse":
            return materials.bsdf(material, self.materials)
        brdf = material.get("brdf", "lambertian")
        if brdf == "lambertian" or self.fujii == "lambertian":
            return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": color}}
        albedo = backend.mitsuba().ScalarColor3f(material["color"])
        if brdf == "oren-nayar":
            return {"type": "etendue_fujii", "albedo": albedo, "roughness": float(material["roughness"])}
        if brdf == "oren-nayar-qualitative":
            return {"type": "etendue_oren_nayar", "albedo": albedo, "sigma": math.radians(material["sigmaDeg"])}
        raise Unsupported(f"brdf {brdf}")

    def add_shape(self, shape, material, emission):
        """Adds a shape; `material` None is black."""
        if material is None:
            shape["bsdf"] = self.bsdf({"type": "black"})
        else:
            shape["bsdf"] = {"type": "ref", "id": f"material_{material}"}
        if emission is not None:
            shape["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": list(emission)}}
        self.shapes[f"shape_{self.count}"] = shape
        self.count += 1

    def add_mesh(self, positions, normals, triangles, matrix, smooth, material, emission, uvs=None):
        """Adds a mesh already read, placed by `matrix`."""
        positions = positions @ matrix[:3, :3].T + matrix[:3, 3]
        if np.linalg.det(matrix[:3, :3]) < 0:
            triangles = triangles[:, ::-1]
        if normals is not None and smooth:
            normals = normals @ np.linalg.inv(matrix[:3, :3])
            normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
        else:
            normals = None
        self.add_placed(positions, normals, triangles, smooth, material, emission, uvs)

    def add_placed(self, positions, normals, triangles, smooth, material, emission, uvs=None):
        """Adds a mesh in the world's frame. `normals`: None where it is flat or has none."""
        file = pathlib.Path(self.folder.name) / f"{self.count}.ply"
        write_ply(file, positions, normals, triangles, uvs)
        self.add_shape({"type": "ply", "filename": str(file), "face_normals": not smooth}, material, emission)

    def add_polygon(self, vertices, matrix, material, emission):
        """Collects flat polygons; those alike in material and emission become one mesh.

        Together, because Mitsuba chooses between emitters uniformly and within a mesh by area, and one mesh is faster.
        """
        points = vec(vertices) @ matrix[:3, :3].T + matrix[:3, 3]
        # A mirroring transform moves the vertices; the normal is theirs in the new order, as for a mesh.
        if np.linalg.det(matrix[:3, :3]) < 0:
            points = points[::-1]
        key = (material, None if emission is None else tuple(float(x) for x in emission))
        soup = self.soups.setdefault(key, [])
        soup += [[points[0], points[i], points[i + 1]] for i in range(1, len(points) - 1)]

    def add_surface(self, s):
        kind, material, emission = s["geometry"], s.get("material"), s.get("emission")
        lights.refuse(s, f"surface {kind}", "motion", "steps", "luminance", "temperature")
        matrix = transform_of(s)
        if emission is not None and not any(emission):  # A black emitter would only waste samples.
            emission = None
        if kind in ("triangle", "quad"):
            n = 3 if kind == "triangle" else 4
            self.add_polygon([s[f"vertex-{i + 1}"] for i in range(n)], matrix, material, emission)
        elif kind == "mesh":
            smooth = self.native and s.get("shading", "flat") == "smooth"
            source = self.meshes[s["mesh"]] if "mesh" in s else s
            # Texture coordinates say where the facets' tangents point.
            uvs = vec(source["uvs"]) if "uvs" in source else None
            self.add_mesh(*self.read_mesh(source), matrix @ placement_of(s), smooth, material, emission, uvs)
        elif kind == "sphere":
            a = matrix[:3, :3]
            scale = np.cbrt(abs(np.linalg.det(a)))
            if np.allclose(a.T @ a, scale**2 * np.eye(3), rtol=1e-9):
                centre = a @ vec(s["origin"]) + matrix[:3, 3]
                # Its tangents run around z, ours around the world's y.
                place = np.array([[0, 1, 0, 0], [0, 0, 1, 0], [1, 0, 0, 0], [0, 0, 0, 1]], dtype=np.float64)
                place[:3] *= s["radius"] * scale
                place[:3, 3] = centre
                to_world = backend.mitsuba().ScalarTransform4f(place.tolist())
                shape = {"type": "sphere", "to_world": to_world}
                self.add_shape(shape, material, emission)
            else:
                mesh, local = quadric(s)
                self.add_mesh(*mesh, matrix @ local, True, material, emission)
        else:
            mesh, local = quadric(s)
            self.add_mesh(*mesh, matrix @ local, True, material, emission)

    def read_mesh(self, source):
        """Positions, normals or None, and triangles of a mesh in a file or in place."""
        if "file" not in source:
            normals = source.get("normals")
            normals = None if normals is None else vec(normals)
            return vec(source["positions"]), normals, np.array(source["triangles"], dtype=np.int64)
        file = self.path.parent / source["file"]
        if not file.exists():
            raise Unsupported(f"{file} does not exist; docs/scenes.md says how it is made")
        return read_obj(file)

    def add_light(self, light):
        kind = light["type"]
        if kind == "area":
            color = vec(light.get("color", [1, 1, 1])) * light.get("intensity", 1.0)
            self.add_polygon([light[f"vertex-{i}"] for i in (1, 2, 3)], np.eye(4), light.get("material"), color)
            return
        self.shapes[f"light_{self.count}"] = lights.emitter(light, self.textures, self.path.parent, self.behind)
        self.count += 1

    def sensor(self, resolution):
        """The camera. The report's is a pinhole whose near plane is its view plane."""
        mi = backend.mitsuba()
        width, height = resolution
        c = self.json["camera"]
        view_plane = not self.native or c.get("type") == "view-plane"
        defaults = {"origin": [0, 0, 0], "lookAt": [0, 0, -1], "up": [0, 1, 0]}
        origin, look_at, up = (vec(c.get(key, value)) for key, value in defaults.items())
        near = 1e-4 * max(1.0, np.linalg.norm(look_at - origin))
        keys = {} if view_plane else lights.lens(c, look_at - origin, width / height)
        if view_plane:
            fov = float(c.get("fieldOfView", 90.0))
            w = (look_at - origin) / np.linalg.norm(look_at - origin)
            half = np.linalg.norm(np.cross(w, up)) * math.sqrt(width / height)
            near = half / math.tan(math.radians(fov) / 2)
            origin, look_at = origin - w * near, origin
            keys = {"type": "perspective", "fov": fov, "fov_axis": "x"}
        to_world = mi.ScalarTransform4f().look_at(origin=origin.tolist(), target=look_at.tolist(), up=up.tolist())
        half = keys.pop("half_width", None)
        if half is not None:
            # Mitsuba's image of parallel rays spans [-1, 1] across the width.
            to_world = to_world @ mi.ScalarTransform4f().scale([half, half, 1.0])
        return keys | {
            "near_clip": float(near),
            "far_clip": 1e7,
            "to_world": to_world,
            "film": {
                "type": "hdrfilm",
                "width": int(width),
                "height": int(height),
                "pixel_format": "rgb",
                "component_format": "float32",
                "rfilter": {"type": "box"},
            },
            "sampler": {"type": "independent"},
        }

    def dictionary(self, resolution=None, max_depth=None, sampler="independent"):
        """The scene for `mitsuba.load_dict`. `max_depth` None takes the scene's, -1 cuts nothing."""
        render = self.json.get("render", {})
        resolution = resolution or render.get("resolution", [256, 256])
        integrator = render.get("integrator", "path")
        if isinstance(integrator, dict):
            integrator = integrator["type"]
        if max_depth is None:
            # Ours counts surface hits, Mitsuba path segments: one more for the shadow ray.
            depth = render.get("maxDepth")
            max_depth = -1 if depth is None else depth + 1
            if integrator == "direct":
                max_depth = 2
            elif integrator == "whitted":
                raise Unsupported("Mitsuba has no Whitted integrator")
        sensor = self.sensor(resolution)
        sensor["sampler"] = {"type": sampler}
        result = {"type": "scene", "integrator": {"type": "path", "max_depth": max_depth}, "sensor": sensor}
        for name, material in self.materials.items():
            result[f"material_{name}"] = self.bsdf(material) | {"id": f"material_{name}"}
        for light in self.json.get("lights", []):
            self.add_light(light)
        for surface in self.json.get("surfaces", []):
            self.add_surface(surface)
        for (material, emission), triangles in self.soups.items():
            points = np.array(triangles).reshape(-1, 3)
            faces = np.arange(len(points)).reshape(-1, 3)
            self.add_mesh(points, None, faces, np.eye(4), False, material, emission)
        self.soups = {}
        return result | self.shapes


def load(path, resolution=None, max_depth=None, mirror=None, fujii="fujii", sampler="independent"):
    """A Mitsuba scene in the variant now selected."""
    converter = Converter(path, mirror, fujii)
    try:
        return backend.mitsuba().load_dict(converter.dictionary(resolution, max_depth, sampler))
    except Unsupported as error:
        sys.exit(f"{path}: {error}")
    finally:
        converter.close()


def add_scene_arguments(parser):
    """The options all programs here share."""
    parser.add_argument("scene", help="scene file, native or the report's")
    parser.add_argument("--resolution", type=int, nargs=2, metavar=("W", "H"), help="pixels (default: the scene's)")
    parser.add_argument("--mirror", type=float, help="one reflectance for all mirrors (the report's program: 0.9)")
    parser.add_argument(
        "--fujii", choices=["fujii", "lambertian"], default="fujii", help="how rough diffuse is rendered"
    )
    parser.add_argument("--max-depth", type=int, help="Mitsuba's max_depth (default: the scene's; -1 cuts nothing)")
    parser.add_argument("--threads", type=int, default=2, help="threads; 0 for all cores (default 2)")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    add_scene_arguments(parser)
    parser.add_argument("output", help=".exr, or .png for an sRGB preview")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--variant", default="llvm_ad_rgb")
    args = parser.parse_args()
    mi = backend.mitsuba(args.variant)
    backend.set_threads(args.threads)
    scene = load(args.scene, args.resolution, args.max_depth, args.mirror, args.fujii)
    image = backend.render(mi, scene, args.spp, args.seed)
    print("means", *(f"{x:.5f}" for x in image.mean((0, 1))), "largest", f"{image.max():.3f}")
    (backend.write_png if args.output.endswith(".png") else backend.write_exr)(args.output, image)


if __name__ == "__main__":
    main()
