"""Compares region means of one estimate with another's, each with its standard error.

Regions are --grid x --grid equal blocks, or the boxes given. An estimate is several images of independent seeds, whose
scatter gives the error of a region's mean, or one image with NAME.se.pfm beside it (pixels independent). Pixels up to
--margin from one that is black in the second are left out: a particle tracer leaves glass black. Prints the ratio of
the means per region with its error in percent, and z: beyond 4 somewhere, or often beyond 2, is a difference.
"""

import argparse
import pathlib
import sys

import numpy as np

import caustics
import pictures


def estimate(paths):
    """Mean image, and a function from a mask to the mean over it and its standard error."""
    images = np.array([pictures.read_pfm(p) for p in paths])
    error = pathlib.Path(paths[0]).with_suffix(".se.pfm")
    if len(paths) < 2 and not error.exists():
        sys.exit(f"{paths[0]}: one image and no {error.name}: its noise is not known")
    squares = pictures.read_pfm(error) ** 2 if len(paths) < 2 else None

    def region(mask):
        values = images[:, mask].mean((1, 2))
        if squares is not None:
            return float(values[0]), float(np.sqrt(squares[mask].sum()) / squares[mask].size)
        return float(values.mean()), float(values.std(ddof=1) / np.sqrt(len(values)))

    return images.mean(0), region


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--a", nargs="+", required=True, help=".pfm images of the first estimate")
    parser.add_argument("--b", nargs="+", required=True, help=".pfm images of the second")
    parser.add_argument("--grid", type=int, default=4)
    parser.add_argument("--box", type=int, nargs=4, action="append", metavar=("X0", "Y0", "X1", "Y1"), help="of pixels")
    parser.add_argument("--margin", type=int, default=2)
    args = parser.parse_args()
    (a, first), (b, second) = estimate(args.a), estimate(args.b)
    if a.shape != b.shape:
        sys.exit("the images have different sizes")
    height, width = a.shape[:2]
    counted = caustics.far_from(b.max(2) <= 0, args.margin)
    n = args.grid
    boxes = args.box or [
        [width * i // n, height * j // n, width * (i + 1) // n, height * (j + 1) // n]
        for j in range(n)
        for i in range(n)
    ]
    print(f"{'box':>20}{'pixels':>8}{'a':>11}{'error':>10}{'b':>11}{'error':>10}{'a / b':>9}{'%':>6}{'z':>7}")
    scores = []

    def row(name, mask):
        (ma, ea), (mb, eb) = first(mask), second(mask)
        z = (ma - mb) / np.hypot(ea, eb)
        share = 100 * np.hypot(ea / ma, eb / mb)
        print(f"{name:>20}{mask.sum():8}{ma:11.5f}{ea:10.5f}{mb:11.5f}{eb:10.5f}{ma / mb:9.4f}{share:6.2f}{z:7.2f}")
        return z

    for x0, y0, x1, y1 in boxes:
        mask = np.zeros((height, width), dtype=bool)
        mask[y0:y1, x0:x1] = True
        mask &= counted
        if mask.any():
            scores.append(row(f"{x0} {y0} {x1} {y1}", mask))
    if not scores:
        sys.exit("no pixel is left to compare")
    row("all", counted)
    print(f"root mean square of z: {np.sqrt(np.mean(np.square(scores))):.2f}")


if __name__ == "__main__":
    main()
