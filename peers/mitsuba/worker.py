"""Keeps one scene in Mitsuba and renders it as often as it is told, for ../bench.py.

A line of JSON in, {"spp", "seed", "output"}, makes a PFM file and a line out, {"spp", "seconds", "cpu"}. The first line
out, when the scene is loaded, has the version. Seconds run from the call of the renderer to the pixels in memory.
"""

import argparse
import json
import pathlib
import sys
import time

import backend  # First, for its message when something is missing.
import scene as converter

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import pictures


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    converter.add_scene_arguments(parser)
    parser.add_argument("--variant", default="llvm_ad_rgb")
    parser.add_argument("--sampler", default="independent")
    args = parser.parse_args()
    mi = backend.mitsuba(args.variant)
    backend.set_threads(args.threads)
    with open(args.scene, encoding="utf-8") as file:
        rough = [m for m in json.load(file).get("materials", []) if m.get("brdf", "lambertian") != "lambertian"]
    if args.variant.startswith("scalar") and rough and args.fujii == "fujii":
        sys.exit(f"error: {args.variant} cannot run the rough diffuse model of this scene")
    scene = converter.load(args.scene, args.resolution, args.max_depth, args.mirror, args.fujii, args.sampler)
    print(json.dumps({"version": mi.__version__}), flush=True)
    warm = set()
    for line in sys.stdin:
        order = json.loads(line)
        # A kernel is compiled for a number of samples per pass, before the clock starts.
        if order["spp"] not in warm and not args.variant.startswith("scalar"):
            next(backend.passes(mi, scene, order["spp"], seed=999983))
            warm.add(order["spp"])
        start, busy = time.perf_counter(), time.process_time()
        image = backend.render(mi, scene, order["spp"], order["seed"])
        seconds, cpu = time.perf_counter() - start, time.process_time() - busy
        pictures.write_pfm(order["output"], image)
        print(json.dumps({"spp": order["spp"], "seconds": seconds, "cpu": cpu}), flush=True)


if __name__ == "__main__":
    main()
