"""Renders scenes of caustics by us and by LuxCore in one run, for equal times, and measures all by one reference.

A row: renderer, its seconds, relMSE over all pixels, relMSE and mean over the reference's mean outside the caustic, and
the same inside. relMSE is the mean over pixels and channels of (x - r)^2 / (r^2 + eps), eps = 1% of the squared mean of
the reference. Pixels up to --margin away from one where the reference is black or not finite are not counted: a
particle tracer leaves glass black, and its edge too dark.

Inside the caustic is where the reference's luminance is more than --threshold times that of the scene without caustics.
The latter is the pixel-wise median of many short renders of our path tracer, which finds a caustic only by chance in
less than every second of them; it is made once and kept in --work.

The reference of scenes/NAME.json is REFERENCES/NAME.pfm, and NAME.se.pfm its standard error, if it is there: its share
of relMSE is taken off. Renderers take turns; run it with nothing else running.
"""

import argparse
import json
import pathlib
import statistics
import sys

try:
    import numpy as np
except ImportError as missing:
    sys.exit(f"SKIPPED: numpy is not installed ({missing}). NOTHING WAS COMPARED.")

import ours
import pictures

SKIPPED = 77
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def etendue(args, scene, integrator, budget, seed, output, spp=None):
    """Renders with our command line; the seconds of its summary."""
    budget = ["--spp", spp] if spp else ["--time", budget]
    return ours.render(args.etendue, scene, output, args.threads, seed, "--integrator", integrator, *budget)


def luxcore(args, scene, integrator, budget, seed, output):
    """Renders with LuxCore; its seconds, preparation of the photon map included."""
    script = pathlib.Path(__file__).parent / "luxcore" / "render.py"
    command = [args.luxcore_python, script, scene, output, "--integrator", integrator, "--time", budget]
    command += ["--seed", seed, "--threads", args.threads, *args.luxcore_options.split()]
    return json.loads(ours.run(command).strip().splitlines()[0])["seconds"]


def without_caustics(args, scene, work):
    """Luminance [height][width] of what the path tracer finds reliably."""
    file = work / f"{scene.stem}-without.npy"
    if not file.exists() or file.stat().st_mtime < scene.stat().st_mtime:
        images = []
        for turn in range(args.median_renders):
            output = work / "without.pfm"
            etendue(args, scene, "path", None, 7001 + turn, output, spp=args.median_spp)
            images.append(pictures.read_pfm(output) @ LUMINANCE)
        np.save(file, np.median(images, axis=0))
    return np.load(file)


def far_from(mask, margin):
    """Pixels more than `margin` pixels away from those of the mask, along rows, columns and diagonals."""
    height, width = mask.shape
    padded = np.pad(mask, margin)
    windows = (padded[y : y + height, x : x + width] for y in range(2 * margin + 1) for x in range(2 * margin + 1))
    return ~np.any(list(windows), axis=0)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", type=pathlib.Path)
    parser.add_argument("--references", type=pathlib.Path, required=True, help="folder of the references, NAME.pfm")
    parser.add_argument("--budgets", type=float, nargs="+", default=[10.0, 30.0], help="seconds (default 10 30)")
    parser.add_argument("--ours", nargs="*", default=["path", "caustic", "sppm", "auto"], help="our integrators")
    parser.add_argument("--luxcore", nargs="*", default=["photongi", "path"], help="its integrators, see render.py")
    parser.add_argument("--luxcore-python", default=sys.executable, help="a Python that has pyluxcore")
    parser.add_argument("--luxcore-options", default="", help="further options for luxcore/render.py, in one string")
    parser.add_argument("--etendue", default="target/release/examples/etendue")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=1, help="repetitions with other seeds; the table has medians")
    parser.add_argument("--threshold", type=float, default=1.5)
    parser.add_argument("--margin", type=int, default=2)
    parser.add_argument("--median-renders", type=int, default=15)
    parser.add_argument("--median-spp", type=int, default=64)
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("out/caustics"), help="folder for images")
    parser.add_argument("--json", help="also write every single run here")
    args = parser.parse_args()
    ours.find(args.etendue)
    args.work.mkdir(parents=True, exist_ok=True)

    contestants = [("etendue", etendue, name) for name in args.ours] + [
        ("luxcore", luxcore, name) for name in args.luxcore
    ]
    runs, refused = [], {}
    for scene in args.scenes:
        file = args.references / f"{scene.stem}.pfm"
        if not file.exists():
            sys.exit(f"{file} does not exist: the reference of {scene}")
        reference, error_file = pictures.read_pfm(file), file.with_suffix(".se.pfm")
        noise = pictures.read_pfm(error_file) if error_file.exists() else None
        counted = far_from(~np.isfinite(reference).all(2) | (reference.max(2) <= 0), args.margin)
        reference = np.where(counted[..., None], reference, 0.0)
        plain = without_caustics(args, scene, args.work)
        if plain.shape != counted.shape:
            sys.exit(f"{file} has not the resolution of {scene}")
        inside = counted & (reference @ LUMINANCE > args.threshold * plain)
        outside = counted & ~inside
        # The constant of relMSE wants the mean of the pixels that count.
        reference[~counted] = reference[counted].mean(0)
        print(
            f"\n{scene.name}: {inside.sum()} pixels inside the caustic, {outside.sum()} outside,"
            f" {(~counted).sum()} not counted"
        )
        print(
            f"{'':26}{'budget':>8}{'seconds':>9}{'relMSE':>11}"
            f"{'outside':>11}{'mean/ref':>10}{'inside':>11}{'mean/ref':>10}"
        )
        for budget in args.budgets:
            for turn in range(args.rounds):
                shift = turn % len(contestants) if contestants else 0
                for label, renderer, name in contestants[shift:] + contestants[:shift]:
                    output = args.work / f"{scene.stem}-{label}-{name}-{budget:g}-{turn}.pfm"
                    try:
                        seconds = renderer(args, scene, name, budget, 1 + turn, output)
                    except ours.Refused as reason:
                        refused[f"{label} {name}"] = str(reason)
                        continue
                    image = pictures.read_pfm(output)
                    image = np.where(np.isfinite(image), image, 0.0)
                    row = {"scene": scene.name, "renderer": f"{label} {name}", "budget": budget, "seconds": seconds}
                    row["relMSE"] = pictures.rel_mse(image, reference, counted, noise)
                    for region, mask in (("outside", outside), ("inside", inside)):
                        row[f"relMSE {region}"] = (
                            pictures.rel_mse(image, reference, mask, noise) if mask.any() else None
                        )
                        row[f"mean {region}"] = (
                            float(image[mask].mean() / reference[mask].mean()) if mask.any() else None
                        )
                    runs.append(row)
            for label, _, name in contestants:
                mine = [
                    r
                    for r in runs
                    if (r["scene"], r["renderer"], r["budget"]) == (scene.name, f"{label} {name}", budget)
                ]
                if mine:
                    columns = ["seconds", "relMSE", "relMSE outside", "mean outside", "relMSE inside", "mean inside"]
                    values = [[r[c] for r in mine if r[c] is not None] for c in columns]
                    s, e, eo, mo, ei, mi = (statistics.median(v) if v else float("nan") for v in values)
                    print(
                        f"{label + ' ' + name:26}{budget:8g}{s:9.2f}{e:11.3e}{eo:11.3e}{mo:10.4f}{ei:11.3e}{mi:10.4f}",
                        flush=True,
                    )
    for name, reason in refused.items():
        print(f"{name}: NOT COMPARED, {reason}")
    if args.json:
        pathlib.Path(args.json).write_text(json.dumps(runs, indent=1) + "\n", encoding="utf-8")
    if not runs:
        sys.exit(SKIPPED)


if __name__ == "__main__":
    main()
