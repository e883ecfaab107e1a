"""Makes references for bench.py: the mean of many renders by our path tracer, each with its own seed.

NAME.pfm is the mean, NAME.se.pfm its standard error per pixel and channel, from the scatter of the renders, and
NAME.json tells of which file, how many samples and how much noise is left. Called again it goes on where it was, scenes
in turns. A record of another state of the scene file is refused. `mitsuba/reference.py` writes the same files by other
code, and bench.py takes either.

The renders are by the unbiased integrator `path`, uncut; a seed is never used by bench.py.
"""

import argparse
import hashlib
import json
import pathlib
import sys
import tempfile
import time

import numpy as np

import ours
import pictures

FIRST_SEED = 1_000_000_007
"""Of the renders that make a reference; those that are compared have small seeds."""


def fingerprint(scene):
    """What the scene file holds."""
    return hashlib.sha256(pathlib.Path(scene).read_bytes()).hexdigest()


def name_of(scene, lambert):
    return pathlib.Path(scene).stem + ("-lambert" if lambert else "")


def load(folder, scene, lambert=False):
    """Reference, its standard error and its record; ends the script where it is missing or of another scene."""
    file = pathlib.Path(folder) / f"{name_of(scene, lambert)}.pfm"
    if not file.exists():
        sys.exit(f"{file} does not exist: make it with peers/references.py")
    record = json.loads(file.with_suffix(".json").read_text(encoding="utf-8"))
    if record.get("sha256", fingerprint(scene)) != fingerprint(scene):
        sys.exit(f"{file} is of another state of {scene}: remove it and make it anew")
    return pictures.read_pfm(file), pictures.read_pfm(file.with_suffix(".se.pfm")), record


class Reference:
    """One reference as it grows."""

    def __init__(self, args, scene, work):
        self.args, self.scene, self.name = args, scene, name_of(scene, args.lambert)
        self.file = args.references / f"{self.name}.pfm"
        self.input = scene
        if args.lambert:
            self.input = work / f"{self.name}.json"
            ours.lambert(scene, self.input)
        self.count, self.mean, self.scatter, self.seconds = 0, 0.0, 0.0, 0.0
        if self.file.exists():
            self.mean, error, record = load(args.references, scene, args.lambert)
            if record.get("spp_each") != args.spp or record["resolution"] != args.resolution:
                sys.exit(f"{self.file} was made with other --spp or --resolution: remove it, or give its own")
            self.count, self.seconds = record["renders"], record["seconds"]
            self.scatter = error**2 * self.count * (self.count - 1)

    def noise(self):
        """Its share in relMSE."""
        if self.count < 2:
            return float("inf")
        weight = 1.0 / (self.mean**2 + 1e-2 * float(self.mean.mean()) ** 2)
        return float(np.mean(self.scatter / (self.count * (self.count - 1)) * weight))

    def add(self, work):
        """Renders once more and writes all files (once there are two)."""
        a, output = self.args, work / f"{self.name}-go.pfm"
        size = "x".join(str(n) for n in a.resolution)
        self.seconds += ours.render(
            a.etendue, self.input, output, a.threads, FIRST_SEED + self.count,
            "--spp", a.spp, "--resolution", size, "--filter", "box", "--integrator", "path", "--max-depth", "none",
        )  # fmt: skip
        step = pictures.read_pfm(output) - self.mean
        # Welford's update, per pixel.
        self.count += 1
        self.mean = self.mean + step / self.count
        self.scatter = self.scatter + step * (step * (1 - 1 / self.count))
        if self.count < 2:
            return
        error = np.sqrt(self.scatter / (self.count * (self.count - 1)))
        pictures.write_pfm(self.file, self.mean)
        pictures.write_pfm(self.file.with_suffix(".se.pfm"), error)
        record = {
            "scene": self.scene.name,
            "sha256": fingerprint(self.scene),
            "lambert": a.lambert,
            "resolution": a.resolution,
            "renderer": "etendue path",
            "renders": self.count,
            "spp_each": a.spp,
            "spp": a.spp * self.count,
            "mean": self.mean.mean((0, 1)).tolist(),
            "mean_se": (np.sqrt((error**2).sum((0, 1))) / error[..., 0].size).tolist(),
            "relMSE": self.noise(),
            "seconds": round(self.seconds, 1),
        }
        self.file.with_suffix(".json").write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", type=pathlib.Path, help="native scene files")
    parser.add_argument("--references", type=pathlib.Path, default=pathlib.Path("out/references"), help="folder")
    parser.add_argument("--lambert", action="store_true", help="rough diffuse surfaces become Lambert's")
    parser.add_argument("--resolution", type=int, nargs=2, default=[256, 256], metavar=("W", "H"))
    parser.add_argument("--spp", type=int, default=256, help="samples per pixel of each render (default 256)")
    parser.add_argument("--renders", type=int, default=32, help="so many renders in all (default 32)")
    parser.add_argument("--noise", type=float, default=0.0, help="or enough when the noise's share in relMSE is this")
    parser.add_argument("--seconds", type=float, default=float("inf"), help="start no render after this time")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--etendue", default="target/release/examples/etendue")
    args = parser.parse_args()
    ours.find(args.etendue)
    args.references.mkdir(parents=True, exist_ok=True)
    start = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        open_ones = [Reference(args, scene, work) for scene in args.scenes]
        while True:
            open_ones = [r for r in open_ones if r.count < args.renders and r.noise() > args.noise]
            if not open_ones or time.perf_counter() - start > args.seconds:
                break
            next_one = min(open_ones, key=lambda r: r.count)
            next_one.add(work)
            print(f"{next_one.name}: {next_one.count} renders, noise {next_one.noise():.2e}", flush=True)


if __name__ == "__main__":
    main()
