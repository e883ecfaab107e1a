"""Compares two images of one scene: are they the same picture but for noise?

Prints the ratio of the channel means with standard errors, and asks of the difference whether it looks like noise: it
is cut into blocks, each block's mean difference is divided by its standard error, and these z should be N(0, 1)
(standard deviation 1, 0.27% beyond 3); neighbouring pixels' differences should be uncorrelated. Bias shows as wide z
and as correlation. Writes a picture of the signed difference: red where A is brighter, blue where B is.
"""

import argparse
import math
import pathlib
import sys

import backend  # First, for its message when something is missing.
import numpy as np


def standard_error(path, given):
    """NAME.se.exr beside NAME.exr, or the file given; None if there is none."""
    file = pathlib.Path(given) if given else pathlib.Path(path).with_suffix(".se.exr")
    return backend.read_exr(file) if file.exists() else None


def blocks(image, size):
    """Sums over size x size blocks; an incomplete border is left out."""
    h, w = image.shape[0] // size, image.shape[1] // size
    return image[: h * size, : w * size].reshape(h, size, w, size, -1).sum((1, 3))


def smooth(image, radius):
    """Mean over the square of this radius around every pixel, cut at the border.

    A variance taken from single differences would follow them, and dividing by it would correlate its neighbours.
    """

    def running(x, axis):
        x = np.moveaxis(x, axis, 0)
        total = np.concatenate([np.zeros_like(x[:1]), np.cumsum(x, 0)])
        low = np.maximum(np.arange(len(x)) - radius, 0)
        high = np.minimum(np.arange(len(x)) + radius + 1, len(x))
        return np.moveaxis((total[high] - total[low]) / (high - low).reshape(-1, *[1] * (x.ndim - 1)), 0, axis)

    return np.maximum(running(running(image, 0), 1), 0.0)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("a", help="EXR")
    parser.add_argument("b", help="EXR, usually the reference")
    parser.add_argument("--se-a", help="standard error of A (default: NAME.se.exr beside it, if there)")
    parser.add_argument("--se-b", help="standard error of B (default: NAME.se.exr beside it, if there)")
    parser.add_argument("--block", type=int, default=16, help="side of the blocks in pixels")
    parser.add_argument("--difference", help="PNG of the signed difference")
    parser.add_argument(
        "--fail", type=float, metavar="Z", help="exit 1 if a channel mean differs by more than Z errors"
    )
    args = parser.parse_args()
    a, b = backend.read_exr(args.a), backend.read_exr(args.b)
    if a.shape != b.shape:
        sys.exit(f"sizes differ: {a.shape[1]}x{a.shape[0]} and {b.shape[1]}x{b.shape[0]}")
    difference = a - b

    # Without error images the noise is taken from the difference itself: half the mean squared step between neighbours,
    # local to a block. That is blind to bias of single pixels but not to bias of areas.
    errors = [standard_error(args.a, args.se_a), standard_error(args.b, args.se_b)]
    if all(e is not None for e in errors):
        variance, source = errors[0] ** 2 + errors[1] ** 2, "both error images"
    else:
        step = np.zeros_like(difference)
        step[:, 1:] += 0.25 * (difference[:, 1:] - difference[:, :-1]) ** 2
        step[:, :-1] += 0.25 * (difference[:, 1:] - difference[:, :-1]) ** 2
        step[1:] += 0.25 * (difference[1:] - difference[:-1]) ** 2
        step[:-1] += 0.25 * (difference[1:] - difference[:-1]) ** 2
        neighbours = np.full(difference.shape[:2], 4.0)
        neighbours[[0, -1]] -= 1
        neighbours[:, [0, -1]] -= 1
        variance, source = smooth(2.0 * step / neighbours[..., None], 4), "steps between neighbouring pixels"
    pixels = a.shape[0] * a.shape[1]
    se = np.sqrt(variance.sum((0, 1))) / pixels

    print(f"noise from {source}")
    print("channel      mean A      mean B     A / B   +- error        z")
    worst = 0.0
    for c, name in enumerate("RGB"):
        ma, mb = a[..., c].mean(), b[..., c].mean()
        z = (ma - mb) / se[c] if se[c] > 0 else math.inf * (ma != mb) if ma != mb else 0.0
        worst = max(worst, abs(z))
        ratio, wide = (ma / mb, se[c] / mb) if mb else (math.nan, math.nan)
        print(f"{name:7} {ma:11.6f} {mb:11.6f} {ratio:9.5f} {wide:10.5f} {z:8.2f}")

    total, spread = blocks(difference, args.block), blocks(variance, args.block)
    known = spread > 0
    z = total[known] / np.sqrt(spread[known])
    if z.size:
        print(
            f"blocks of {args.block}x{args.block}: {z.size} z values, mean {z.mean():+.3f},"
            f" standard deviation {z.std():.3f} (noise: 1), beyond 3: {np.mean(np.abs(z) > 3):.2%} (noise: 0.27%),"
            f" largest {np.abs(z).max():.2f}"
        )
    # Difference over its local error, so that bright regions do not decide alone.
    scaled = np.where(variance > 0, difference / np.sqrt(np.maximum(variance, 1e-300)), 0.0)
    scaled = np.clip(scaled, -5, 5)
    norm = np.mean(scaled**2)
    if norm > 0:
        right = np.mean(scaled[:, 1:] * scaled[:, :-1]) / norm
        down = np.mean(scaled[1:] * scaled[:-1]) / norm
        expected = 1 / math.sqrt(scaled.size)
        print(f"correlation with the next pixel: right {right:+.4f}, down {down:+.4f} (noise: 0 +- {expected:.4f})")
    print(f"relMSE of A against B: {backend.rel_mse(a, b):.3e}")

    if args.difference:
        scale = max(np.quantile(np.abs(difference.mean(2)), 0.99), 1e-12)
        d = np.clip(difference.mean(2) / scale, -1, 1)[..., None]
        white, red, blue = np.ones(3), np.array([0.8, 0.0, 0.0]), np.array([0.0, 0.1, 0.8])
        picture = np.where(d > 0, white + d * (red - white), white - d * (blue - white))
        backend.write_png(args.difference, picture)
        print(f"{args.difference}: full colour at +-{scale:.3g}")
    if args.fail is not None and worst > args.fail:
        sys.exit(1)


if __name__ == "__main__":
    main()
