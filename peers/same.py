"""Are the pictures of two renderers the same but for noise? Both are rendered several times, with seeds of their own."""

import math

import numpy as np

import pictures

BLOCK = 16
"""Side of the blocks, pixels."""

MEAN_BOUND = 0.003
"""Largest relative difference of a channel's mean."""


def normal_of_t(t, freedom):
    """The standard normal number with the same probability as Student's t (Wallace 1959, good to 0.01 up to |t| = 6)."""
    return np.sign(t) * (8 * freedom + 1) / (8 * freedom + 3) * np.sqrt(freedom * np.log1p(t * t / freedom))


def mean_and_variance(images):
    """Mean of independent images, and the variance of this mean."""
    images = np.stack(images)
    return images.mean(0), images.var(0, ddof=1) / len(images)


def z_of(a, b):
    """Differences of means as standard normal numbers, by Welch's test. 0 where nothing varies and nothing differs."""
    (ma, va), (mb, vb) = mean_and_variance(a), mean_and_variance(b)
    total = np.maximum(va + vb, 1e-300)
    n = len(a)
    freedom = total**2 / np.maximum((va**2 + vb**2) / (n - 1), 1e-300)
    difference = ma - mb
    # What is only emission has no noise but rounding to single precision.
    difference = np.where(np.abs(difference) <= 2e-6 * np.abs(mb), 0.0, difference)
    return normal_of_t(difference / np.sqrt(total), np.clip(freedom, n - 1, 2 * n - 2)), ma, mb, np.sqrt(total)


def blocks(image):
    h, w = (n // BLOCK for n in image.shape[:2])
    return image[: h * BLOCK, : w * BLOCK].reshape(h, BLOCK, w, BLOCK, 3).mean((1, 3))


class Result:
    """What the comparison of one picture found."""

    def __init__(self, name, mine, theirs):
        z, ma, mb, error = z_of([i.mean((0, 1)) for i in mine], [i.mean((0, 1)) for i in theirs])
        self.name, self.off, self.error = name, ma / mb - 1.0, error / mb
        self.z = z
        found, _, mean, wide = z_of([blocks(i) for i in mine], [blocks(i) for i in theirs])
        noisy = wide > np.maximum(1e-7 * mean, 1e-100)
        self.blocks = found[noisy]
        self.noise = float(np.median(wide[noisy] / mean[noisy]))
        # Channels of a path share its noise; blocks do not. So the number of independent z is that of blocks at least.
        self.count = int(noisy.any(-1).sum())
        self.square = float(np.mean(self.blocks**2))

    def worst(self):
        return float(np.abs(self.blocks).max())

    def differences(self):
        """In what the pictures differ by more than noise."""
        found = []
        if np.abs(self.off).max() > MEAN_BOUND:
            found.append("means")
        if self.worst() > 4.5:
            found.append("a block")
        if abs(self.square - 1.0) > 4.0 * math.sqrt(2.0 / self.count):
            found.append("spread of the blocks")
        return found

    def wrong(self):
        """What is wrong, or an empty string."""
        noisy = ["means too noisy to tell"] if self.error.max() > MEAN_BOUND / 3.0 else []
        return ", ".join(self.differences() + noisy)

    def row(self):
        means = " / ".join(f"{100 * x:+.3f}" for x in self.off)
        return (
            f"| {self.name} | {means} | {100 * self.error.max():.3f} | {np.abs(self.z).max():.1f} | {100 * self.noise:.2f}"
            f" | {self.square:.2f} | {self.worst():.1f} | {self.wrong() or 'same'} |"
        )


class Picture(Result):
    """What the comparison of one picture found, with its 4 x 4 regions."""

    def __init__(self, name, mine, theirs):
        super().__init__(name, mine, theirs)
        z, a, b, error = z_of([pictures.blocks(i, 4) for i in mine], [pictures.blocks(i, 4) for i in theirs])
        # Dark regions count as a twentieth of the mean at least.
        scale = np.maximum(b, 0.05 * b.mean())
        off = (a - b) / scale
        at = np.unravel_index(np.argmax(np.abs(off)), off.shape)
        self.region, self.region_error, self.region_z = off[at], (error / scale)[at], float(np.abs(z).max())

    @staticmethod
    def head(what, whose):
        """The head of the table, in which `what` names the rows and `whose` the pictures that ours are compared with."""
        return (
            f"| {what} | means R / G / B, ours over {whose}, % | ± % | largest z | worst of 4 x 4 regions, % | largest z of a region"
            " | mean z² of blocks | largest z of a block | |\n|---|---|--:|--:|--:|--:|--:|--:|---|"
        )

    def differences(self):
        found = super().differences()
        if np.abs(self.z).max() > 3.0 and "means" not in found:
            found.append("means beyond noise")
        return found

    def row(self):
        means = " / ".join(f"{100 * x:+.3f}" for x in self.off)
        return (
            f"| {self.name} | {means} | {100 * self.error.max():.3f} | {np.abs(self.z).max():.1f}"
            f" | {100 * self.region:+.2f} ± {100 * self.region_error:.2f} | {self.region_z:.1f}"
            f" | {self.square:.2f} | {self.worst():.1f} | {self.wrong() or 'same'} |"
        )
