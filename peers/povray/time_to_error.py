"""Times POV-Ray 3.7 on one scene for several settings and measures its images by a reference of ours.

Every --try is a string of options of pov.py, and after `--` of POV-Ray (anti-aliasing, say). The seconds are those of
the whole process; "cpu / threads" is what they would be on a machine with nothing else to do: its processor
time divided by the threads. relMSE is the mean over pixels and channels of (x - r)^2 / (r^2 + eps), eps = 1% of the
squared mean of the reference; the noise left in the reference, known from its layer "variance", is taken off.
"""

import argparse
import pathlib
import resource
import shlex
import shutil
import subprocess
import sys
import tempfile
import time

SKIPPED = 77
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))

if shutil.which("povray") is None:
    print("SKIPPED: povray is not installed (apt-get install povray). NOTHING WAS COMPARED.", file=sys.stderr)
    sys.exit(SKIPPED)
try:
    import numpy as np
    import OpenEXR  # noqa: F401 (what `pictures` reads with)
except ImportError as missing:
    print(f"SKIPPED: {missing} (pip install numpy OpenEXR). NOTHING WAS COMPARED.", file=sys.stderr)
    sys.exit(SKIPPED)

import pictures
import pov as converter


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument(
        "reference", help="EXR of the same scene by `etendue render`, Lambert's surfaces for rough ones"
    )
    parser.add_argument("--try", dest="tries", action="append", help="settings, may be given many times")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--limit", type=float, default=300.0, help="seconds after which a render is given up")
    parser.add_argument("--keep", help="folder for the images")
    args = parser.parse_args()
    reference, variance = pictures.read_exr(args.reference), pictures.read_exr(args.reference, "variance.")
    height, width = reference.shape[:2]
    weight = 1.0 / (reference**2 + 1e-2 * float(reference.mean()) ** 2)
    noise = 0.0 if variance is None else float(np.mean(variance * weight))
    print(f"{width}x{height}, {args.threads} threads, noise of the reference, taken off: {noise:.2e}")
    print(f"{'seconds':>8}{'cpu / threads':>15}{'relMSE':>11}  mean / reference, 4 x 4 regions: least and greatest")
    folder = pathlib.Path(args.keep or tempfile.mkdtemp())
    folder.mkdir(parents=True, exist_ok=True)
    for index, text in enumerate(args.tries or ["-- +A0.05 +AM2 +R2"]):
        ours, _, theirs = text.partition("--" + " ") if text.startswith("-- ") else text.partition(" -- ")
        options = argparse.ArgumentParser()
        converter.add_arguments(options)
        pov, image = folder / f"{index}.pov", folder / f"{index}.exr"
        converter.write(args.scene, pov, [width, height], options.parse_args(shlex.split(ours)))
        command = ["povray", str(pov), f"+W{width}", f"+H{height}", f"+WT{args.threads}", "+FE", "-V", "-D", "-GA"]
        command += [f"+O{image}", *shlex.split(theirs)]
        before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=args.limit)
        except subprocess.TimeoutExpired:
            print(f"{'> ' + format(args.limit, 'g'):>8}  given up: {text}", flush=True)
            continue
        seconds, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
        if done.returncode:
            sys.exit(f"{shlex.join(command)}\nended with {done.returncode}: {done.stderr.strip()[-2000:]}")
        cpu = (after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime) / args.threads
        x = pictures.read_exr(image)
        error = float(np.mean((x - reference) ** 2 * weight)) - noise
        ratio = pictures.blocks(x, 4) / pictures.blocks(reference, 4)
        means = " ".join(f"{m:.4f}" for m in x.mean((0, 1)) / reference.mean((0, 1)))
        print(
            f"{seconds:8.1f}{cpu:15.1f}{error:11.3e}  {means}, {ratio.min():.3f} {ratio.max():.3f}  {text}", flush=True
        )


if __name__ == "__main__":
    main()
