"""Our command line, as scripts that compare renderers call it. Needs nothing but Python."""

import json
import pathlib
import re
import shlex
import subprocess
import sys


class Refused(Exception):
    """A renderer did not make an image; says why."""


def run(command):
    """What a command printed, or `Refused` with the reason it gave."""
    done = subprocess.run([str(x) for x in command], capture_output=True, text=True)
    if done.returncode:
        said = (done.stderr.strip() or done.stdout.strip() or "no message").splitlines()
        reason = next((line for line in said if "error" in line or "SKIPPED" in line), said[-1])
        raise Refused(f"exit code {done.returncode}: {reason}")
    return done.stdout + done.stderr


def seconds_of(text):
    """Render seconds from the summary line of `etendue render`."""
    summary = re.search(r"done in (?:(\d+) h )?(?:(\d+) min ?)?(?:([\d.]+) s)?", text)
    if not summary or not any(summary.groups()):
        sys.exit(f"no 'done in ... s' in the output of our command:\n{text}")
    hours, minutes, seconds = (float(x or 0) for x in summary.groups())
    return 3600 * hours + 60 * minutes + seconds


def render(program, scene, output, threads, seed, *options):
    """Renders once; render seconds from `--stats` where the program has it, else from its summary line."""
    command = [program, "render", scene, "--threads", threads, "--seed", seed, "--output", output, *options]
    if not has_stats(program):
        return seconds_of(run(command))
    stats = pathlib.Path(output).with_suffix(".stats.json")
    run([*command, "--stats", stats])
    return float(json.loads(stats.read_text(encoding="utf-8"))["seconds"]["render"])


def has_stats(program, known={}):  # noqa: B006 (asked once for every program)
    if program not in known:
        known[program] = "--stats" in run([program, "render", "--help"])
    return known[program]


def find(program):
    """The program's path, or the end of the script."""
    if not pathlib.Path(program).exists():
        sys.exit(f"{program} does not exist: cargo build --release --example etendue")
    return program


def lambert(path, output):
    """Writes our scene with Lambert's surfaces for rough ones; files of meshes by their whole names."""
    path = pathlib.Path(path)
    scene = json.loads(path.read_text(encoding="utf-8"))
    for m in scene.get("materials", []):
        if m["type"] == "diffuse":
            for key in ("brdf", "roughness", "sigmaDeg"):
                m.pop(key, None)
    for part in scene.get("surfaces", []) + scene.get("meshes", []):
        if "file" in part:
            part["file"] = str((path.parent / part["file"]).resolve())
    pathlib.Path(output).write_text(json.dumps(scene), encoding="utf-8")


def is_rough(path):
    """Whether a scene has diffuse materials other than Lambert's."""
    materials = json.loads(pathlib.Path(path).read_text(encoding="utf-8")).get("materials", [])
    return any(m.get("brdf", "lambertian") != "lambertian" for m in materials)


def options_of(text):
    return shlex.split(text or "")
