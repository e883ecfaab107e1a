"""Keeps one scene in Cycles (Blender as a Python module) and renders it as often as it is told, for ../bench.py.

A line of JSON in, {"spp", "seed", "output"}, makes a PFM file and a line out, {"spp", "seconds", "cpu"}. The first line out, when
the scene is loaded and was drawn once, has the version.

Scenes of meshes, quadrilaterals and triangles under an environment. Everything is turned so that the environment's image lies as
Blender has it (z up, its middle in the direction +x): Cycles then samples it by its own texels.

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

TO_BLENDER = np.array([[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""From the frame of our images (middle -z, right +x, up +y) to that of Blender's (middle +x, right -y, up +z)."""


def node(tree, kind, **inputs):
    made = tree.nodes.new(kind)
    for name, value in inputs.items():
        made.inputs[name].default_value = value
    return made


def material_of(m):
    """Cycles' material with the same meaning, or the end of the script."""
    made = bpy.data.materials.new(m["name"])
    tree = made.node_tree
    tree.nodes.clear()
    if m["type"] == "diffuse" and m.get("brdf", "lambertian") == "lambertian":
        shader = node(tree, "ShaderNodeBsdfDiffuse", Color=(*m["color"], 1.0), Roughness=0.0)
    elif m["type"] == "conductor" and "eta" in m and not m.get("anisotropy") and m.get("multipleScattering", True) is False:
        shader = tree.nodes.new("ShaderNodeBsdfMetallic")
        shader.fresnel_type = "PHYSICAL_CONDUCTOR"  # First, for it makes the inputs.
        for name, value in (("IOR", m["eta"]), ("Extinction", m["k"]), ("Roughness", m.get("roughness", 0.0))):
            shader.inputs[name].default_value = value
        shader.distribution = {"ggx": "GGX", "beckmann": "BECKMANN"}[m.get("distribution", "ggx")]
    else:
        sys.exit(f"error: material {m['name']}: only Lambert's surfaces, and metals with eta and k and without multiple scattering")
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return made


class Scene:
    """One of our scenes in Blender."""

    def __init__(self, path, resolution, threads):
        self.path, self.count = pathlib.Path(path), 0
        self.json = json.loads(self.path.read_text(encoding="utf-8"))
        for thing in list(bpy.data.objects):
            bpy.data.objects.remove(thing)
        self.scene = bpy.context.scene
        self.turn = TO_BLENDER @ self.sky().T
        self.materials = {m["name"]: material_of(m) for m in self.json.get("materials", [])}
        for surface in self.json.get("surfaces", []):
            self.add(surface)
        self.camera(resolution)
        self.settings(resolution, threads)

    def sky(self):
        """Makes the world's light; from the frame of its image to our world."""
        found = self.json.get("lights", [])
        if len(found) != 1 or found[0]["type"] != "environment":
            sys.exit("error: only scenes that are lit by an environment alone")
        light = found[0]
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

    def add(self, s):
        kind = s["geometry"]
        if s.get("emission") or s.get("motion") or s.get("steps") or s.get("shading", "flat") != "flat":
            sys.exit(f"error: a {kind} that shines, moves or is smooth")
        matrix = ours.transform_of(s)
        if kind in ("quad", "triangle"):
            points = np.array([s[f"vertex-{i + 1}"] for i in range(4 if kind == "quad" else 3)], dtype=np.float64)
            triangles = np.array([[0, 1, 2], [0, 2, 3]][: len(points) - 2])
        elif kind == "mesh" and "file" in s:
            points, _, triangles = ours.read_obj(self.path.parent / s["file"])
            matrix = matrix @ ours.placement_of(s)
        elif kind == "mesh" and "positions" in s:
            points, triangles = np.array(s["positions"], dtype=np.float64), np.array(s["triangles"])
            matrix = matrix @ ours.placement_of(s)
        else:
            sys.exit(f"error: surface {kind}: only meshes, quadrilaterals and triangles")
        points = (points @ matrix[:3, :3].T + matrix[:3, 3]) @ self.turn.T
        mesh = bpy.data.meshes.new(f"mesh {self.count}")
        mesh.from_pydata(points.tolist(), [], triangles.tolist())
        mesh.polygons.foreach_set("use_smooth", np.zeros(len(mesh.polygons), dtype=bool))
        mesh.materials.append(self.materials[s["material"]])
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

    def settings(self, resolution, threads):
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
        cycles.use_adaptive_sampling = cycles.use_denoising = cycles.use_fast_gi = cycles.use_guiding = False
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
    args = parser.parse_args()
    # Blender tells of its files on the standard output, which is for JSON here.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    scene = Scene(args.scene, args.resolution, args.threads)
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
