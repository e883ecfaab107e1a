"""POV-Ray 3.7: radiosity, its own method for light between diffuse surfaces."""

import json
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

import ours
import pictures
from adapters import PEERS, Contestant, Refused, Skipped, cpu_of_children

SETTINGS = [
    ("--count 50 --error-bound 0.5", "+A0.1 +AM2 +R2"),
    ("--count 100 --error-bound 0.35", "+A0.05 +AM2 +R2"),
]
"""Options of pov.py and of POV-Ray for the first budget, and for all after it."""

LIMIT = 60.0
"""Seconds after which a render is given up."""
LARGEST = 10_000_000
"""Bytes of mesh files; more is not written as POV-Ray's text."""


def mesh_bytes(scene):
    description = json.loads(pathlib.Path(scene).read_text(encoding="utf-8"))
    parts = description.get("surfaces", []) + description.get("meshes", [])
    files = {pathlib.Path(scene).parent / part["file"] for part in parts if "file" in part}
    return sum(file.stat().st_size for file in files)


class Povray(Contestant):
    name = "povray radiosity"
    clock = "its own photon, radiosity and trace times; parsing is left out"
    differs = (
        "biased and without a seed: one round, two settings, no budgets; light by radiosity from glowing lamps, 16"
        " diffuse bounces, 30 mirrors and glasses; adaptive anti-aliasing; 16-bit floats; no rough diffuse surfaces,"
        " smooth meshes or glowing spheres"
    )
    seeded = False

    def open(self, scene, args):
        if shutil.which("povray") is None:
            raise Skipped("povray is not installed (apt-get install povray)")
        said = subprocess.run(["povray", "--version"], capture_output=True, text=True)
        self.version = re.search(r"(\d+\.\d+[\d.]*)", said.stdout + said.stderr).group(1)
        if ours.is_rough(scene):
            raise Refused("it has no rough diffuse surface")
        if mesh_bytes(scene) > LARGEST:
            raise Refused("a large mesh: to write and parse it as POV-Ray's text takes longer than all renders")
        self.scene, self.args = scene, args
        self.folder = tempfile.TemporaryDirectory()
        self.files = [self.write(index, options) for index, (options, _) in enumerate(SETTINGS)]

    def write(self, index, options):
        file = pathlib.Path(self.folder.name) / f"{index}.pov"
        command = [sys.executable, PEERS / "povray" / "pov.py", self.scene, file, *options.split()]
        command += ["--resolution", *self.args.resolution]
        done = subprocess.run([str(x) for x in command], capture_output=True, text=True)
        if done.returncode:
            raise Refused(done.stderr.strip().splitlines()[-1])
        return file

    def samples(self, budgets, output):
        return list(range(len(budgets)))

    def render(self, spp, seed, output):
        level, output = min(spp, len(SETTINGS) - 1), pathlib.Path(output)
        image = output.with_suffix(".exr")
        width, height = (str(n) for n in self.args.resolution)
        command = ["povray", self.files[level], "+W" + width, "+H" + height, f"+WT{self.args.threads}", "+FE", "-D"]
        command += [f"+O{image}", *SETTINGS[level][1].split()]
        before = cpu_of_children()
        try:
            done = subprocess.run([str(x) for x in command], capture_output=True, text=True, timeout=LIMIT)
        except subprocess.TimeoutExpired:
            raise Refused(f"given up after {LIMIT:g} s with {shlex.join(SETTINGS[level])}") from None
        cpu = cpu_of_children() - before
        if done.returncode:
            raise Refused(done.stderr.strip()[-200:])
        times = re.findall(r"(?:Photon|Radiosity|Trace) Time:.*\(([\d.]+) seconds\)", done.stdout + done.stderr)
        if not times:
            raise Refused("POV-Ray printed no times")
        pictures.write_pfm(output, pictures.read_exr(image))
        image.unlink()
        return {"seconds": sum(map(float, times)), "spp": None, "cpu": cpu}
