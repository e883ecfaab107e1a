#!/usr/bin/env python3
"""What `--target-error` says against the truth, as the Markdown table of docs/error-estimates.md.

    scripts/target_error.py ETENDUE [--error E] [--seeds N] [--size PIXELS] SCENE...

ETENDUE: the built command line. Each scene is rendered by path tracing with N seeds until it says that its relMSE is E. The truth needs
no reference: the renders are independent and have no bias, so their scatter is their error. relMSE of it: the mean over pixels and channels
of the variance over (m^2 + e), where m is the mean of the renders and e is 1 % of the squared mean of all values.
"""
import argparse
import array
import json
import subprocess
import tempfile
from pathlib import Path


def read_pfm(path):
    with open(path, "rb") as file:
        file.readline(), file.readline(), file.readline()
        return array.array("f", file.read())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("etendue")
    parser.add_argument("scenes", nargs="+")
    parser.add_argument("--error", type=float, default=5e-3)
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--size", type=int, default=128)
    args = parser.parse_args()
    print("| scene | said | true | true / said | samples |\n|---|---|---|---|---|")
    for scene in args.scenes:
        images, told, samples = [], [], []
        with tempfile.TemporaryDirectory() as folder:
            image, stats = f"{folder}/image.pfm", f"{folder}/stats.json"
            for seed in range(args.seeds):
                subprocess.run(
                    [args.etendue, "render", scene, "--integrator", "path", "--resolution", f"{args.size}x{args.size}",
                     "--target-error", str(args.error), "--seed", str(100 + seed), "-o", image, "--stats", stats, "-q"],
                    check=True,
                )  # fmt: skip
                said = json.loads(Path(stats).read_text())
                images.append(read_pfm(image))
                told.append(said["relMSE"]["value"])
                samples.append(said["samples"]["mean"])
        means = [sum(values) / args.seeds for values in zip(*images)]
        floor = 0.01 * (sum(means) / len(means)) ** 2
        scatter = lambda values, mean: sum((value - mean) ** 2 for value in values) / (args.seeds - 1)
        true = sum(scatter(v, m) / (m * m + floor) for v, m in zip(zip(*images), means)) / len(means)
        said = sum(told) / args.seeds
        print(f"| {Path(scene).stem} | {said:.2e} | {true:.2e} | {true / said:.2f} | {sum(samples) / args.seeds:.0f} |", flush=True)


if __name__ == "__main__":
    main()
