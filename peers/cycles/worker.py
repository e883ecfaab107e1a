"""Keeps one scene in Cycles (Blender as a Python module) and renders it as often as it is told, for ../bench.py.

A line of JSON in, {"spp", "seed", "output"}, makes a PFM file and a line out, {"spp", "seconds", "cpu"}. The first line out, when
the scene is loaded and was drawn once, has the version.

Scenes of meshes, quadrilaterals, triangles and spheres, which shine or have an environment. Everything is turned so that the
environment's image lies as Blender has it (z up, its middle in the direction +x): Cycles then samples it by its own texels. Spheres are
fine meshes, since Cycles has none.

Seconds are Cycles' own render time, which the file of the picture has among its metadata (in hundredths): from the first sample on,
with the scene synchronised and the hierarchy built, to the last. The picture's way into the file is not in it. Processor seconds
are those of the whole call, so they have both. Without bpy it says SKIPPED and ends with code 77.
"""

import argparse
import json
import math
import os
import pathlib
import re
import sys
import tempfile
import time

try:
    import bpy
    import numpy as np
    import OpenEXR
except ImportError as missing:
    print(f"SKIPPED: {missing} (pip install bpy==5.0.1 numpy OpenEXR, with Python 3.11)", file=sys.stderr)
    sys.exit(77)

HERE = pathlib.Path(__file__).resolve().parent
sys.path += [str(HERE.parent), str(HERE.parent / "mitsuba")]
import lights
import pictures
import scene as ours

DEPTH = 1024
"""Bounces after which paths end, the most that Cycles takes."""

KNOWN = {
    "geometry", "name", "material", "emission", "shading", "transform", "file", "positions", "normals", "triangles", "uvs", "origin",
    "radius", "scale", "rotate",
}  # fmt: skip
"""Keys of surfaces; others are refused."""

TO_BLENDER = np.array([[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""From the frame of our images (middle -z, right +x, up +y) to that of Blender's (middle +x, right -y, up +z)."""


def node(tree, kind, **inputs):
    made = tree.nodes.new(kind)
    for name, value in inputs.items():
        made.inputs[name].default_value = value
    return made


def bsdf_of(tree, m):
    """Cycles' shader of a material with the same meaning, or the end of the script."""
    if m.keys() & {"emission", "luminance", "temperature", "spectra", "textures", "bump", "normalMap", "opacity"}:
        sys.exit(f"error: material {m['name']}: shines, or has textures or spectra")
    color = (*m.get("color", [1, 1, 1]), 1.0)
    if m["type"] == "diffuse" and m.get("brdf", "lambertian") == "lambertian":
        return node(tree, "ShaderNodeBsdfDiffuse", Color=color, Roughness=0.0)
    if m["type"] == "reflective":
        return node(tree, "ShaderNodeBsdfAnisotropic", Color=color, Roughness=0.0)
    if m["type"] == "refractive" and m.get("exteriorIndex", 1.0) == 1.0 and color[:3] == (1, 1, 1):
        return node(tree, "ShaderNodeBsdfGlass", Color=color, Roughness=0.0, IOR=m["refractionIndex"])
    if m["type"] == "conductor" and "eta" in m and not m.get("anisotropy") and m.get("multipleScattering", True) is False:
        shader = tree.nodes.new("ShaderNodeBsdfMetallic")
        shader.fresnel_type = "PHYSICAL_CONDUCTOR"  # First, for it makes the inputs.
        for name, value in (("IOR", m["eta"]), ("Extinction", m["k"]), ("Roughness", m.get("roughness", 0.0))):
            shader.inputs[name].default_value = value
        shader.distribution = {"ggx": "GGX", "beckmann": "BECKMANN"}[m.get("distribution", "ggx")]
        return shader
    sys.exit(f"error: material {m['name']}: only Lambert's surfaces, mirrors, glass, and metals with eta and k and without multiple scattering")


def emission_of(tree, radiance):
    """A shader that emits this radiance on the side of the normal."""
    peak = max(radiance)
    side = tree.nodes.new("ShaderNodeNewGeometry")
    front = tree.nodes.new("ShaderNodeMath")
    front.operation = "MULTIPLY_ADD"  # Strength x (1 - back).
    front.inputs[1].default_value, front.inputs[2].default_value = -peak, peak
    tree.links.new(side.outputs["Backfacing"], front.inputs[0])
    shader = node(tree, "ShaderNodeEmission", Color=(*(x / peak for x in radiance), 1.0))
    tree.links.new(front.outputs[0], shader.inputs["Strength"])
    return shader


def material_of(name, m, radiance):
    """Cycles' material of a surface that has our material `m`, or none, and emits `radiance`, or nothing."""
    made = bpy.data.materials.new(name)
    tree = made.node_tree
    tree.nodes.clear()
    shaders = [] if m is None else [bsdf_of(tree, m)]
    if radiance:
        shaders.append(emission_of(tree, radiance))
        made.cycles.emission_sampling = "FRONT"
    if not shaders:
        shaders.append(node(tree, "ShaderNodeBsdfDiffuse", Color=(0.0, 0.0, 0.0, 1.0), Roughness=0.0))
    shader = shaders[0]
    if len(shaders) > 1:
        shader = tree.nodes.new("ShaderNodeAddShader")
        for k in range(2):
            tree.links.new(shaders[k].outputs[0], shader.inputs[k])
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return made


def sphere(around):
    """Points of the unit sphere, which are its normals, and triangles of them."""
    rows = around // 2
    theta, phi = np.linspace(0, math.pi, rows + 1)[1:-1], np.linspace(0, 2 * math.pi, around, endpoint=False)
    x, y = (np.outer(np.sin(theta), f(phi)) for f in (np.cos, np.sin))
    ring = np.stack([x, y, np.outer(np.cos(theta), np.ones(around))], 2).reshape(-1, 3)
    points = np.concatenate([ring, [[0, 0, 1], [0, 0, -1]]])
    j = np.arange(around)
    following = (j + 1) % around
    first, last = 0, (rows - 2) * around
    triangles = [np.stack([np.full(around, len(ring)), first + j, first + following], 1)]
    for row in range(rows - 2):
        a, b = row * around, (row + 1) * around
        triangles += [np.stack([a + j, b + j, b + following], 1), np.stack([a + j, b + following, a + following], 1)]
    triangles.append(np.stack([np.full(around, len(ring) + 1), last + following, last + j], 1))
    return points, np.concatenate(triangles)


class Scene:
    """One of our scenes in Blender."""

    def __init__(self, path, resolution, threads, guiding):
        self.path, self.count = pathlib.Path(path), 0
        self.json = json.loads(self.path.read_text(encoding="utf-8"))
        for thing in list(bpy.data.objects):
            bpy.data.objects.remove(thing)
        self.scene = bpy.context.scene
        self.turn = TO_BLENDER @ self.sky().T
        self.materials, self.polygons = {}, {}
        for surface in self.json.get("surfaces", []):
            self.add(surface)
        # Those alike are one mesh, as for the others.
        for (material, radiance), polygons in self.polygons.items():
            points = np.concatenate(polygons)
            self.add_mesh(points, np.arange(len(points)).reshape(-1, 3), None, self.material(material, radiance))
        self.camera(resolution)
        self.settings(resolution, threads, guiding)

    def sky(self):
        """Makes the world's light; from the frame of its image to our world."""
        found = self.json.get("lights", [])
        if len(found) > 1 or any(light["type"] != "environment" for light in found):
            sys.exit("error: only scenes that are lit by surfaces and an environment")
        light = found[0] if found else {"intensity": 0.0}
        world = bpy.data.worlds.new("sky")
        tree = world.node_tree
        tree.nodes.clear()
        color = np.array(light.get("color", [1, 1, 1]), dtype=np.float64) * light.get("intensity", 1.0)
        if len(set(color.tolist())) != 1 or light.get("visible", True) is not True:
            sys.exit("error: an environment with a colour of its own, or one that is not visible")
        background = node(tree, "ShaderNodeBackground", Strength=float(color[0]))
        if "texture" in light:
            texture = next(t for t in self.json["textures"] if t["name"] == light["texture"])
            image = bpy.data.images.load(str((self.path.parent / texture["file"]).resolve()))
            image.colorspace_settings.name = "Linear Rec.709"
            picture = tree.nodes.new("ShaderNodeTexEnvironment")
            picture.image, picture.interpolation, picture.projection = image, "Linear", "EQUIRECTANGULAR"
            tree.links.new(picture.outputs["Color"], background.inputs["Color"])
        else:
            background.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
        output = tree.nodes.new("ShaderNodeOutputWorld")
        tree.links.new(background.outputs[0], output.inputs["Surface"])
        self.scene.world = world
        return lights.turn_to(light.get("up", [0, 1, 0])) @ lights.about_y(light.get("rotation", 0.0))

    def material(self, name, radiance):
        """The material of this name in our scene, for surfaces that emit `radiance`."""
        key = (name, radiance)
        if key not in self.materials:
            found = next((m for m in self.json.get("materials", []) if m["name"] == name), None)
            self.materials[key] = material_of(f"{name} {len(self.materials)}", found, radiance)
        return self.materials[key]

    def add(self, s):
        kind = s["geometry"]
        radiance = tuple(float(x) for x in s.get("emission", []))
        radiance = radiance if any(radiance) else ()
        for key in s.keys() - KNOWN:
            if not key.startswith("vertex-"):
                sys.exit(f"error: a {kind} with the key {key}")
        matrix, normals = ours.transform_of(s), None
        if kind in ("quad", "triangle"):
            points = np.array([s[f"vertex-{i + 1}"] for i in range(4 if kind == "quad" else 3)], dtype=np.float64)
            points = points[[0, 1, 2, 0, 2, 3][: 3 * (len(points) - 2)]]
            points = (points @ matrix[:3, :3].T + matrix[:3, 3]) @ self.turn.T
            self.polygons.setdefault((s.get("material"), radiance), []).append(points)
            return
        if kind == "sphere":
            points, triangles = sphere(48 if radiance else 384)
            a, b, c = (points[triangles[:, k]] for k in range(3))
            area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
            # As large as the sphere, so that a lamp has its power.
            size = s["radius"] * (math.sqrt(4 * math.pi / area) if radiance else 1.0)
            points, normals = points * size + np.array(s["origin"], dtype=np.float64), points
        elif kind == "mesh" and "file" in s:
            points, normals, triangles = ours.read_obj(self.path.parent / s["file"])
            matrix = matrix @ ours.placement_of(s)
        elif kind == "mesh" and "positions" in s:
            points, triangles = np.array(s["positions"], dtype=np.float64), np.array(s["triangles"])
            normals = np.array(s["normals"], dtype=np.float64) if "normals" in s else None
            matrix = matrix @ ours.placement_of(s)
        else:
            sys.exit(f"error: surface {kind}: only meshes, quadrilaterals, triangles and spheres")
        if kind == "mesh" and s.get("shading", "flat") == "flat":
            normals = None
        elif normals is None:
            sys.exit("error: a smooth mesh without normals")
        if np.linalg.det(matrix[:3, :3]) < 0:
            triangles = triangles[:, ::-1]
        points = (points @ matrix[:3, :3].T + matrix[:3, 3]) @ self.turn.T
        if normals is not None:
            normals = normals @ np.linalg.inv(matrix[:3, :3]) @ self.turn.T
            normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
        self.add_mesh(points, triangles, normals, self.material(s.get("material"), radiance))

    def add_mesh(self, points, triangles, normals, material):
        """Adds a mesh in Blender's frame; `normals` of its vertices, or None where it is flat."""
        mesh = bpy.data.meshes.new(f"mesh {self.count}")
        mesh.from_pydata(points.tolist(), [], triangles.tolist())
        mesh.polygons.foreach_set("use_smooth", np.full(len(mesh.polygons), normals is not None, dtype=bool))
        if normals is not None:
            mesh.normals_split_custom_set_from_vertices(normals.tolist())
        mesh.materials.append(material)
        thing = bpy.data.objects.new(f"surface {self.count}", mesh)
        thing.shadow_terminator_geometry_offset = thing.shadow_terminator_shading_offset = 0.0
        self.scene.collection.objects.link(thing)
        self.count += 1

    def camera(self, resolution):
        c = self.json["camera"]
        if c.get("type", "perspective") != "perspective" or c.get("lensRadius") or c.get("fStop") or c.get("motion"):
            sys.exit("error: only a pinhole camera")
        defaults = {"origin": [0, 0, 0], "lookAt": [0, 0, -1], "up": [0, 1, 0]}
        origin, look_at, up = (self.turn @ np.array(c.get(key, value), dtype=np.float64) for key, value in defaults.items())
        back = (origin - look_at) / np.linalg.norm(origin - look_at)
        right = np.cross(up, back)
        right = right / np.linalg.norm(right)
        place = np.eye(4)
        place[:3, 0], place[:3, 1], place[:3, 2], place[:3, 3] = right, np.cross(back, right), back, origin
        data = bpy.data.cameras.new("camera")
        vertical = c.get("fieldOfViewAxis", "horizontal") == "vertical"
        data.sensor_fit = "VERTICAL" if vertical else "HORIZONTAL"
        data.lens_unit = "FOV"
        half = math.tan(math.radians(c.get("fieldOfView", 90.0)) / 2)
        data.lens = (data.sensor_height if vertical else data.sensor_width) / (2 * half)
        data.clip_start, data.clip_end = 1e-3, 1e6
        thing = bpy.data.objects.new("camera", data)
        thing.matrix_world = place.T.tolist()
        self.scene.collection.objects.link(thing)
        self.scene.camera = thing

    def settings(self, resolution, threads, guiding):
        render, cycles = self.scene.render, self.scene.cycles
        render.engine = "CYCLES"
        render.resolution_x, render.resolution_y, render.resolution_percentage = *resolution, 100
        render.pixel_aspect_x = render.pixel_aspect_y = 1.0
        render.threads_mode, render.threads = "FIXED", threads
        # The scene stays synchronised between renders.
        render.use_persistent_data = True
        render.use_compositing = render.use_sequencer = render.film_transparent = render.use_motion_blur = False
        render.image_settings.file_format = "OPEN_EXR"
        render.image_settings.color_mode, render.image_settings.color_depth = "RGB", "32"
        render.image_settings.exr_codec = "NONE"
        self.scene.view_settings.view_transform = "Raw"
        cycles.device = "CPU"
        cycles.use_adaptive_sampling = cycles.use_denoising = cycles.use_fast_gi = False
        cycles.use_guiding = guiding
        cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = cycles.light_sampling_threshold = 0.0
        cycles.caustics_reflective = cycles.caustics_refractive = cycles.use_light_tree = True
        for kind in ("max", "diffuse", "glossy", "transmission", "transparent_max"):
            setattr(cycles, f"{kind}_bounces", DEPTH)
        cycles.pixel_filter_type = "BOX"
        cycles.time_limit = 0.0
        cycles.use_auto_tile = False

    def render(self, spp, seed, output):
        """Renders to a file; the seconds that Cycles says it took."""
        self.scene.cycles.samples, self.scene.cycles.seed = spp, seed % (1 << 31)
        self.scene.render.filepath = str(output)
        bpy.ops.render.render(write_still=True)
        header = OpenEXR.File(str(output)).parts[0].header
        told = next(str(value) for key, value in header.items() if re.fullmatch(r"cycles\..*\.render_time", key))
        seconds = 0.0
        for part in told.split(":"):
            seconds = 60.0 * seconds + float(part)
        return seconds


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--resolution", type=int, nargs=2, default=[256, 256], metavar=("W", "H"))
    parser.add_argument("--guiding", action="store_true", help="with Cycles' path guiding")
    args = parser.parse_args()
    # Blender tells of its files on the standard output, which is for JSON here.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    scene = Scene(args.scene, args.resolution, args.threads, args.guiding)
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "image.exr"
        scene.render(1, 1, file)
        print(json.dumps({"version": bpy.app.version_string}), file=answers, flush=True)
        for line in sys.stdin:
            order = json.loads(line)
            busy = time.process_time()
            seconds = scene.render(order["spp"], order["seed"], file)
            cpu = time.process_time() - busy
            image = pictures.read_exr(file)
            pictures.write_pfm(order["output"], image)
            print(json.dumps({"spp": order["spp"], "seconds": seconds, "cpu": cpu}), file=answers, flush=True)


if __name__ == "__main__":
    main()
