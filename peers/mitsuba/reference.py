"""Renders a converged reference: many passes with independent seeds, averaged in double precision.

Writes OUTPUT (.exr or .pfm, scene-linear) and beside it NAME.se.exr (.pfm), the standard error of every pixel and
channel estimated from the scatter of the passes, and NAME.json with what was rendered and how. Nothing is cut
(max_depth -1) unless asked; Mitsuba's Russian roulette stays on, it is unbiased.

`--integrator ptracer` traces from the lights and joins diffuse vertices with the pinhole: it finds the caustics that
are seen directly, which the path tracer hardly does, and leaves black what is seen through glass or in a mirror.
"""

import argparse
import json
import pathlib
import time

import backend  # First, for its message when something is missing.
import numpy as np
import scene as converter


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    converter.add_scene_arguments(parser)
    parser.add_argument("output", help="image to write")
    parser.add_argument("--spp", type=int, default=8192, help="samples per pixel in all")
    parser.add_argument("--pass-spp", type=int, default=64, help="samples per pixel of one pass")
    parser.add_argument("--seconds", type=float, help="stop early after this time")
    parser.add_argument("--integrator", choices=["path", "ptracer"], default="path")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--variant", default="llvm_ad_rgb")
    args = parser.parse_args()
    mi = backend.mitsuba(args.variant)
    backend.set_threads(args.threads)
    depth = -1 if args.max_depth is None else args.max_depth
    scene = converter.load(args.scene, args.resolution, depth, args.mirror, args.fujii)
    integrator = mi.load_dict({"type": args.integrator, "max_depth": depth})

    start, mean, scatter, count = time.perf_counter(), 0.0, 0.0, 0
    while count * args.pass_spp < args.spp:
        seed = (args.seed * 1000003 + count) % 2**32
        image = np.array(mi.render(scene, integrator=integrator, spp=args.pass_spp, seed=seed), dtype=np.float64)
        # Welford's update, per pixel.
        count += 1
        step = image - mean
        mean = mean + step / count
        scatter = scatter + step * (image - mean)
        if args.seconds is not None and count >= 2 and time.perf_counter() - start > args.seconds:
            break
    error = np.sqrt(scatter / max(count - 1, 1) / count)

    output = pathlib.Path(args.output)
    backend.write_exr(output, mean)
    backend.write_exr(output.with_suffix(".se" + output.suffix), error)
    # Standard error of each channel's mean over the image; pixels are independent.
    summary = {
        "scene": pathlib.Path(args.scene).name,
        "resolution": [mean.shape[1], mean.shape[0]],
        "spp": count * args.pass_spp,
        "passes": count,
        "mirror": args.mirror,
        "fujii": args.fujii,
        "max_depth": depth,
        "mitsuba": mi.__version__,
        "variant": args.variant,
        "integrator": args.integrator,
        "mean": mean.mean((0, 1)).tolist(),
        "mean_se": (np.sqrt((error**2).sum((0, 1))) / (mean.shape[0] * mean.shape[1])).tolist(),
        "relative_variance_left": float(np.mean(error**2 / (mean**2 + backend.epsilon(mean)))),
        "seconds": round(time.perf_counter() - start, 2),
    }
    output.with_suffix(".json").write_text(json.dumps(summary, indent=2) + "\n", encoding="utf-8")
    print(json.dumps(summary, indent=2))


if __name__ == "__main__":
    main()
