"""Times Mitsuba and our command line on one scene, in turns, and measures both images against one reference.

For an unbiased renderer error times time stays the same whatever the samples, so "relMSE x s" compares renderers that
were given different budgets: half of it means the same image in half the time. Both images are measured by one formula,
the mean over pixels and channels of (x - r)^2 / (r^2 + eps) with eps = 1% of the squared mean of r, and the noise left
in the reference (NAME.se.exr beside it) is taken off.

Seconds are render time: Mitsuba's from the call of the renderer to the pixels in memory, warm (scene loaded, kernels
compiled by a run that is not counted), ours from the summary line of `etendue render`. "process" is our whole process,
with start, scene and file; Mitsuba's start and compilation are not counted at all. All take turns in every round, so
that a change of the machine's speed meets all; the table has the median of the rounds.
"""

import argparse
import json
import pathlib
import shlex
import statistics
import subprocess
import sys
import tempfile
import time

import backend  # First, for its message when something is missing.
import numpy as np
import scene as converter

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import ours


class Mitsuba:
    """One variant with the scene loaded."""

    def __init__(self, mi, variant, args, resolution):
        self.mi, self.variant, self.name = mi, variant, f"mitsuba {variant}"
        backend.select(mi, variant)
        self.scene = converter.load(
            args.scene, resolution, args.max_depth, args.mirror, args.fujii, args.mitsuba_sampler
        )

    def warm(self, spp):
        self.render(spp, 999983)

    def render(self, spp, seed):
        """Image, render seconds, process seconds (none)."""
        self.mi.set_variant(self.variant)
        start = time.perf_counter()
        image = backend.render(self.mi, self.scene, spp, seed)
        return image, time.perf_counter() - start, None


class Ours:
    """Our command line."""

    def __init__(self, command, args, resolution, folder):
        self.name, self.command, self.args, self.resolution = "etendue", command, args, resolution
        self.output = pathlib.Path(folder) / "ours.exr"

    def warm(self, spp):
        # A cold disk cache is the only thing to warm up.
        self.render(1, 1)

    def render(self, spp, seed):
        """Image, render seconds from the summary line, process seconds."""
        values = {
            "scene": shlex.quote(self.args.scene),
            "output": shlex.quote(str(self.output)),
            "spp": spp,
            "seed": seed,
            "threads": self.args.threads,
            "width": self.resolution[0],
            "height": self.resolution[1],
        }
        start = time.perf_counter()
        run = subprocess.run(shlex.split(self.command.format(**values)), capture_output=True, text=True)
        process = time.perf_counter() - start
        if run.returncode:
            sys.exit(f"{self.command.format(**values)}\nended with {run.returncode}: {run.stderr.strip()}")
        return backend.read_exr(self.output), ours.seconds_of(run.stdout + run.stderr), process


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    converter.add_scene_arguments(parser)
    parser.add_argument("reference", help="EXR from reference.py, of the same resolution and options")
    parser.add_argument("--spp", type=int, nargs="+", default=[16, 64, 256], help="samples per pixel to try")
    parser.add_argument("--rounds", type=int, default=3, help="repetitions, each with seeds of its own")
    parser.add_argument("--variants", nargs="*", default=["llvm_ad_rgb", "scalar_rgb"], help="Mitsuba variants")
    parser.add_argument("--mitsuba-sampler", default="independent", help="or multijitter, orthogonal, ...")
    parser.add_argument("--etendue", default="target/release/examples/etendue", help="our program; '' leaves it out")
    parser.add_argument(
        "--command",
        default="{program} render {scene} --output {output} --spp {spp} --seed {seed} --threads {threads}"
        " --resolution {width}x{height} --filter box",
        help="how to call it; {program} is --etendue",
    )
    parser.add_argument("--json", help="also write every single run here")
    args = parser.parse_args()
    mi = backend.mitsuba("llvm_ad_rgb" if any(v.startswith("llvm") for v in args.variants) else "scalar_rgb")
    backend.set_threads(args.threads)

    reference = backend.read_exr(args.reference)
    noise_file = pathlib.Path(args.reference).with_suffix(".se.exr")
    noise = backend.read_exr(noise_file) if noise_file.exists() else None
    height, width = reference.shape[:2]
    if args.resolution and tuple(args.resolution) != (width, height):
        sys.exit(f"the reference is {width}x{height}, not {args.resolution[0]}x{args.resolution[1]}")

    with open(args.scene, encoding="utf-8") as file:
        rough = [m for m in json.load(file).get("materials", []) if m.get("brdf", "lambertian") != "lambertian"]
    renderers, skipped = [], []
    with tempfile.TemporaryDirectory() as folder:
        if args.etendue:
            if not pathlib.Path(args.etendue).exists():
                sys.exit(f"{args.etendue} does not exist: cargo build --release --example etendue")
            command = args.command.replace("{program}", shlex.quote(args.etendue))
            renderers.append(Ours(command, args, (width, height), folder))
        for variant in args.variants:
            if variant.startswith("scalar") and rough and args.fujii == "fujii":
                skipped.append(f"mitsuba {variant}: SKIPPED, it cannot run the rough diffuse model of this scene")
                continue
            renderers.append(Mitsuba(mi, variant, args, (width, height)))

        runs = []
        for spp in args.spp:
            for renderer in renderers:
                renderer.warm(spp)
            for turn in range(args.rounds):
                # Another order each time, so that nobody always follows the same neighbour.
                order = renderers[turn % len(renderers) :] + renderers[: turn % len(renderers)]
                for renderer in order:
                    image, seconds, process = renderer.render(spp, 1000 * spp + turn)
                    if image.shape != reference.shape:
                        made = f"{image.shape[1]}x{image.shape[0]}"
                        sys.exit(f"{renderer.name} made {made}, the reference is {width}x{height}")
                    error = backend.rel_mse(image, reference, noise)
                    means = image.mean((0, 1)).tolist()
                    runs.append(
                        {"renderer": renderer.name, "spp": spp, "round": turn, "relMSE": error, "seconds": seconds}
                        | {"process": process, "mean": means}
                    )

    # What is left of the reference's own noise limits which errors can be told apart.
    if noise is not None:
        floor = float(np.mean(noise**2 / (reference**2 + backend.epsilon(reference))))
        print(f"noise of the reference, subtracted: {floor:.2e}")
    threads = args.threads or "all"
    print(f"{width}x{height}, {threads} threads, {args.rounds} rounds, Mitsuba's sampler: {args.mitsuba_sampler}")
    head = f"{'':24}{'spp':>6}{'relMSE':>12}{'seconds':>10}{'process':>10}{'relMSE x s':>13}{'ratio':>8}"
    print(head + "  mean / reference")
    for spp in args.spp:
        first = None
        for renderer in renderers:
            mine = [r for r in runs if r["renderer"] == renderer.name and r["spp"] == spp]
            error = statistics.fmean(r["relMSE"] for r in mine)
            seconds = statistics.median(r["seconds"] for r in mine)
            process = statistics.median(r["process"] for r in mine) if mine[0]["process"] is not None else None
            product = error * seconds
            first = product if first is None else first
            means = np.mean([r["mean"] for r in mine], axis=0) / reference.mean((0, 1))
            print(
                f"{renderer.name:24}{spp:6}{error:12.3e}{seconds:10.3f}"
                + (f"{process:10.3f}" if process is not None else f"{'-':>10}")
                + f"{product:13.3e}{product / first:8.2f}  "
                + " ".join(f"{m:.4f}" for m in means)
            )
    for line in skipped:
        print(line)
    print(f"ratio: relMSE x s over that of {renderers[0].name} at the same spp; above 1 takes longer to the same error")
    if args.json:
        pathlib.Path(args.json).write_text(json.dumps(runs, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
