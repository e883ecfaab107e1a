"""Renders one of our scenes in LuxCore for a given time, or as many samples, and writes scene-linear radiance.

The time runs from the start of the session, so it includes LuxCore's own preparation: acceleration structure,
visibility map and the photon map. Loading the scene is outside. Box filter, no clamping, no denoiser, no tone mapping.
What differs from our model is in ../README.md.
"""

import argparse
import json
import math
import os
import pathlib
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "mitsuba"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))

SKIPPED = 77
"""Exit code of a script that could not run because LuxCore is missing (the code test drivers read as "skipped")."""


def skip(reason):
    """Ends the script with `SKIPPED`, loudly."""
    print(
        f"SKIPPED: {reason}. NOTHING WAS RENDERED.\n"
        "Install what is missing with: python3 -m venv peer && peer/bin/pip install pyluxcore numpy",
        file=sys.stderr,
    )
    sys.exit(SKIPPED)


try:
    import numpy as np
except ImportError as missing:
    skip(f"numpy is not installed ({missing})")
# The module tells on standard output which libraries it found; only our own record belongs there.
sys.stdout.flush()
record_to = os.dup(1)
os.dup2(2, 1)
try:
    import pyluxcore
except ImportError as missing:
    skip(f"LuxCore is not installed ({missing})")

import pictures
import scene as reader

MAX_DEPTH = 64
"""Longest path, in hits, in place of none: at albedo 0.7 what is cut is 1e-10 of the light."""


class Converter(reader.Converter):
    """One scene on its way into LuxCore's properties. Every surface becomes a mesh in a PLY file."""

    def __init__(self, path):
        super().__init__(path)
        self.lines = []

    def set(self, key, *values):
        self.lines.append((key, [v.item() if isinstance(v, np.generic) else v for v in values]))

    def bsdf(self, material):
        """Overrides the Mitsuba BSDF; `properties` names materials itself."""
        return None

    def material(self, name, m):
        """Properties of one of our materials."""
        key, color = f"scene.materials.{name}", m.get("color", [1, 1, 1])
        if m["type"] == "black":
            color = [0, 0, 0]
        if m["type"] in ("diffuse", "black"):
            if m.get("brdf", "lambertian") != "lambertian":
                raise reader.Unsupported(f"brdf {m['brdf']}: LuxCore has another rough diffuse model")
            self.set(f"{key}.type", "matte")
            self.set(f"{key}.kd", *map(float, color))
        elif m["type"] == "reflective":
            self.set(f"{key}.type", "mirror")
            self.set(f"{key}.kr", *map(float, color))
        elif m["type"] == "refractive":
            self.set(f"{key}.type", "glass")
            self.set(f"{key}.kr", 1.0, 1.0, 1.0)
            self.set(f"{key}.kt", 1.0, 1.0, 1.0)
            self.set(f"{key}.interiorior", float(m["refractionIndex"]))
            self.set(f"{key}.exteriorior", float(m.get("exteriorIndex", 1.0)))
        else:
            raise reader.Unsupported(f"material type {m['type']}")

    def add_shape(self, shape, material, emission):
        if shape["type"] == "sphere":  # There are no analytic spheres: a fine smooth mesh.
            surface = {"geometry": "sphere", "origin": shape["center"], "radius": shape["radius"]}
            mesh, local = reader.quadric(surface)
            self.add_mesh(*mesh, local, True, material, emission)
            return
        if shape["type"] != "ply":
            raise reader.Unsupported(f"a {shape['type']}")
        name = f"object{self.count}"
        self.count += 1
        self.set(f"scene.shapes.{name}.type", "mesh")
        self.set(f"scene.shapes.{name}.ply", shape["filename"])
        if emission is None:
            used = f"m_{material}"
        else:
            # LuxCore's emission belongs to a material, on the side of the geometric normal.
            used = f"lamp{self.count}"
            self.material(used, {"type": "black"} if material is None else self.materials[material])
            self.set(f"scene.materials.{used}.emission", *map(float, emission))
        self.set(f"scene.objects.{name}.shape", name)
        self.set(f"scene.objects.{name}.material", used)

    def camera(self, resolution):
        """Our pinhole: a field of view of 90 degrees makes LuxCore's screen window one of tangents."""
        width, height = resolution
        c = self.json["camera"]
        if not self.native or c.get("type") == "view-plane":
            raise reader.Unsupported("the view-plane camera")
        half = math.tan(math.radians(c.get("fieldOfView", 90.0)) / 2)
        vertical = c.get("fieldOfViewAxis", "horizontal") == "vertical"
        x, y = (half * width / height, half) if vertical else (half, half * height / width)
        self.set("scene.camera.type", "perspective")
        self.set("scene.camera.lookat.orig", *map(float, c.get("origin", [0, 0, 0])))
        self.set("scene.camera.lookat.target", *map(float, c.get("lookAt", [0, 0, -1])))
        self.set("scene.camera.up", *map(float, c.get("up", [0, 1, 0])))
        self.set("scene.camera.fieldofview", 90.0)
        # LuxCore counts rows from below as height - 1 - y, which puts a sample of row y into the row under it.
        row = 2 * y / height
        self.set("scene.camera.screenwindow", -x, x, -y - row, y - row)
        self.set("scene.camera.autofocus.enable", False)
        self.set("scene.camera.cliphither", 1e-4)

    def properties(self, resolution):
        """Everything of the scene, for `pyluxcore.Scene.Parse`."""
        self.camera(resolution)
        if any(light["type"] == "point" for light in self.json.get("lights", [])):
            raise reader.Unsupported("a point light")
        for name, m in self.materials.items():
            self.material(f"m_{name}", m)
        self.material("m_None", {"type": "black"})
        for light in self.json.get("lights", []):
            self.add_light(light)
        for surface in self.json.get("surfaces", []):
            self.add_surface(surface)
        for (material, emission), triangles in self.soups.items():
            points = np.array(triangles).reshape(-1, 3)
            self.add_mesh(points, None, np.arange(len(points)).reshape(-1, 3), np.eye(4), False, material, emission)
        self.soups = {}
        return self.lines


def engine(args):
    """Properties of the integrator."""
    p = [
        ("sampler.type", [args.sampler]),
        ("renderengine.seed", [args.seed]),
        ("native.threads.count", [args.threads]),
        ("path.pathdepth.total", [MAX_DEPTH]),
        ("path.pathdepth.diffuse", [MAX_DEPTH]),
        ("path.pathdepth.glossy", [MAX_DEPTH]),
        ("path.pathdepth.specular", [MAX_DEPTH]),
        ("path.clamping.variance.maxvalue", [0.0]),
        ("path.maxdepth", [MAX_DEPTH]),
        ("light.maxdepth", [MAX_DEPTH]),
        ("lightstrategy.type", ["LOG_POWER"]),
    ]
    name = {"bidir": "BIDIRCPU", "bidirvm": "BIDIRVMCPU"}.get(args.integrator, "PATHCPU")
    p.append(("renderengine.type", [name]))
    if args.integrator == "hybrid":
        p += [
            ("path.hybridbackforward.enable", [True]),
            ("path.hybridbackforward.partition", [args.partition]),
        ]
    if args.integrator == "bidirvm":
        p += [
            ("bidirvm.lightpath.count", [args.light_paths]),
            ("bidirvm.startradius.scale", [args.start_radius]),
            ("bidirvm.alpha", [0.95]),
        ]
    if args.integrator == "photongi":
        p += [
            ("path.photongi.sampler.type", [args.photon_sampler]),
            ("path.photongi.photon.maxcount", [args.photon_paths]),
            ("path.photongi.photon.maxdepth", [args.photon_depth]),
            ("path.photongi.visibility.lookup.radius", [args.visibility_radius]),
            ("path.photongi.visibility.targethitrate", [args.visibility_rate]),
            ("path.photongi.caustic.enabled", [True]),
            ("path.photongi.caustic.maxsize", [args.photons]),
            ("path.photongi.caustic.lookup.radius", [args.radius]),
            ("path.photongi.caustic.updatespp", [args.update_spp]),
            ("path.photongi.caustic.updatespp.radiusreduction", [args.radius_reduction]),
            ("path.photongi.caustic.updatespp.minradius", [args.min_radius]),
        ]
    return p


def film(resolution):
    """Pixels averaged over themselves alone, nothing done to them afterwards."""
    return [
        ("film.width", [int(resolution[0])]),
        ("film.height", [int(resolution[1])]),
        ("film.filter.type", ["NONE"]),
        ("film.noiseestimation.warmup", [0]),
        ("film.outputs.0.type", ["RGB"]),
        ("film.outputs.0.filename", ["unused.exr"]),
        ("film.imagepipelines.0.0.type", ["NOP"]),
    ]


def as_properties(lines):
    properties = pyluxcore.Properties()
    for key, values in lines:
        properties.Set(pyluxcore.Property(key, values))
    return properties


def load(args):
    """The scene in LuxCore, and the size of its image."""
    converter = Converter(args.scene)
    resolution = args.resolution or converter.json.get("render", {}).get("resolution", [256, 256])
    try:
        lines = converter.properties(resolution)
        scene = pyluxcore.Scene()
        scene.Parse(as_properties(lines))
    except reader.Unsupported as error:
        sys.exit(f"{args.scene}: error: {error}")
    finally:
        converter.close()
    return scene, resolution


def render(args, scene, resolution, poll=0.1):
    """Image [height][width][3], seconds, those of them before the first sample, samples per pixel."""
    session = pyluxcore.RenderSession(pyluxcore.RenderConfig(as_properties(engine(args) + film(resolution)), scene))
    start = time.perf_counter()
    # Returns when the acceleration structure and the photon map are made and the threads have started.
    session.Start()
    prepared = time.perf_counter() - start
    while True:
        # The caustic cache is renewed by samples per pixel, which LuxCore counts when asked for its statistics.
        session.UpdateStats()
        samples = session.GetStats().Get("stats.renderengine.pass").GetInt()
        elapsed = time.perf_counter() - start
        if elapsed >= args.time or (args.spp is not None and samples >= args.spp):
            break
        # Asking merges the threads' films, which costs a tenth and more if done often: seldom while there is far to go.
        ahead = 0.7 * elapsed * (args.spp - samples) / samples if args.spp is not None and samples else 0.0
        time.sleep(min(max(poll, ahead), args.time - elapsed))
    session.UpdateStats()
    samples = session.GetStats().Get("stats.renderengine.pass").GetInt()
    # Stopping waits for the passes under way; what they add is in the image, so their time counts.
    session.Stop()
    seconds = time.perf_counter() - start
    width, height = (int(x) for x in resolution)
    buffer = np.zeros(width * height * 3, dtype=np.float32)
    session.GetFilm().GetOutputFloat(pyluxcore.FilmOutputType.RGB, buffer, 0)
    return buffer.reshape(height, width, 3)[::-1], seconds, prepared, samples


def arguments():
    """The options of all programs here."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene", help="native scene file")
    parser.add_argument("--integrator", choices=["path", "photongi", "hybrid", "bidir", "bidirvm"], default="photongi")
    parser.add_argument("--resolution", type=int, nargs=2, metavar=("W", "H"), help="pixels (default: the scene's)")
    parser.add_argument("--time", type=float, default=10.0, help="seconds (default 10)")
    parser.add_argument("--spp", type=int, help="stop at so many samples per pixel, if before --time")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--sampler", choices=["SOBOL", "RANDOM", "METROPOLIS"], default="SOBOL")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--verbose", action="store_true", help="LuxCore's own log, to standard error")
    photons = parser.add_argument_group("caustic cache (photongi)")
    photons.add_argument("--photons", type=int, default=50000, help="photons stored")
    photons.add_argument("--photon-paths", type=int, default=20_000_000, help="light paths at most")
    photons.add_argument("--photon-depth", type=int, default=16)
    photons.add_argument("--photon-sampler", choices=["METROPOLIS", "RANDOM"], default="METROPOLIS")
    photons.add_argument("--radius", type=float, default=0.01, help="of look-ups, scene units")
    photons.add_argument("--radius-reduction", type=float, default=0.96)
    photons.add_argument("--min-radius", type=float, default=0.003)
    photons.add_argument("--visibility-radius", type=float, default=0.1, help="0 lets LuxCore find one, in seconds")
    photons.add_argument("--visibility-rate", type=float, default=0.95, help="hit rate at which the map is complete")
    photons.add_argument("--update-spp", type=int, default=8, help="samples per pixel between updates; 0 for none")
    others = parser.add_argument_group("others")
    others.add_argument("--partition", type=float, default=0.8, help="hybrid: share of eye paths")
    others.add_argument("--light-paths", type=int, default=16384, help="bidirvm: light paths per pass")
    others.add_argument("--start-radius", type=float, default=0.003, help="bidirvm: radius over the scene's")
    return parser


def main():
    parser = arguments()
    parser.add_argument("output", help=".pfm to write")
    args = parser.parse_args()
    log = (lambda line: print(line, file=sys.stderr)) if args.verbose else (lambda line: None)
    pyluxcore.Init(log)
    image, seconds, _, samples = render(args, *load(args))
    pictures.write_pfm(args.output, image)
    record = {
        "renderer": f"luxcore {pyluxcore.Version()} {args.integrator}",
        "scene": pathlib.Path(args.scene).name,
        "seconds": round(seconds, 2),
        "spp": samples,
        "mean": [round(float(x), 6) for x in image.mean((0, 1), dtype=np.float64)],
    }
    os.write(record_to, (json.dumps(record) + "\n").encode())
    # LuxCore 2.11 crashes when Python takes its module apart; everything is written by now.
    os._exit(0)


if __name__ == "__main__":
    main()
