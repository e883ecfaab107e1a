#!/usr/bin/env python3
"""What denoising by Open Image Denoise (OIDN) 2 does to the error of a render, as a Markdown table for docs/denoising.md.

    scripts/denoise.py HOST [--oidn LIBRARY] [--scenes NAME,...] [--samples N,...] [--reference N] [--size WIDTH HEIGHT]
                       [--threads N] [--pictures FOLDER [--pictured N]]

HOST: the built examples/c/denoise. The error is relMSE against a render b of --reference samples with another seed: the mean over
pixels and channels of (a - b)^2 / (b^2 + e), where e is 1 % of the squared mean of b, less the relMSE that b estimates of itself,
whose noise is independent of every other image. For --pictured samples there is also a row of shared hits (`reuse` on), where a
scene allows them, and --pictures writes a PNG for each scene: noisy, by colour only, prefiltered, reference. Best run with nothing
else running.
"""
import argparse
import array
import re
import struct
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
AUXILIARIES = ["none", "noisy", "prefiltered"]


def read_pfm(path):
    """Width, height and floats of an image, the bottom row first."""
    with open(path, "rb") as file:
        kind, size, scale = (file.readline().split() for _ in range(3))
        values = array.array("f", file.read())
    width, height = map(int, size)
    if kind != [b"PF"] or len(values) != 3 * width * height:
        sys.exit(f"{path} is no PFM of three channels")
    if (float(scale[0]) < 0) != (sys.byteorder == "little"):
        values.byteswap()
    return width, height, values


def rel_mse(image, reference):
    values = reference[2]
    floor = 0.01 * (sum(values) / len(values)) ** 2
    return sum((a - b) ** 2 / (b * b + floor) for a, b in zip(image[2], values)) / len(values)


def srgb(value):
    linear = min(max(value, 0.0), 1.0)
    return round(255 * (12.92 * linear if linear <= 0.0031308 else 1.055 * linear ** (1 / 2.4) - 0.055))


def filtered(row, above):
    """A row of a PNG by the filter that leaves the smallest differences, which deflate packs best."""
    choices = []
    for kind in range(5):
        line = bytearray([kind])
        for i, value in enumerate(row):
            left, corner = (row[i - 3], above[i - 3]) if i >= 3 else (0, 0)
            nearest = min((left, above[i], corner), key=lambda near: abs(left + above[i] - corner - near))
            guess = (0, left, above[i], (left + above[i]) // 2, nearest)[kind]
            line.append((value - guess) % 256)
        choices.append(line)
    return min(choices, key=lambda line: sum(min(byte, 256 - byte) for byte in line[1:]))


def write_png(path, images):
    """Images of one size side by side, two white columns between them."""
    width = sum(image[0] for image in images) + 2 * (len(images) - 1)
    rows, above = bytearray(), bytes(3 * width)
    for y in reversed(range(images[0][1])):
        parts = [bytes(map(srgb, values[3 * across * y : 3 * across * (y + 1)])) for across, _, values in images]
        row = (b"\xff" * 6).join(parts)
        rows += filtered(row, above)
        above = row

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, images[0][1], 8, 2, 0, 0, 0)
    body = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(bytes(rows), 9)) + chunk(b"IEND", b"")
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + body)


class Host:
    def __init__(self, options, work):
        self.work = work
        self.common = [str(options.host.resolve()), "--threads", str(options.threads)]
        self.common += ["--size", *map(str, options.size), "--output", str(work / "image")]
        self.common += ["--oidn", options.oidn] if options.oidn else []

    def run(self, scene, samples, *arguments):
        """What the host says, or None where it refuses."""
        path = ROOT / "scenes" / f"{scene}.json"
        command = [*self.common, str(path), "--samples", str(samples), *arguments]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0 and "--reuse" in arguments:
            return None
        if done.returncode != 0:
            sys.exit(f"{' '.join(command)}: {done.stderr.strip()}")
        if "denoised in" not in done.stdout:
            print(f"Skipped: {done.stdout.splitlines()[-1]}")
            sys.exit(0)
        return done.stdout

    def image(self, name):
        return read_pfm(self.work / f"image-{name}.pfm")


def seconds(text, done):
    return float(re.search(rf"{done} in ([\d.]+) s", text)[1])


def measure(host, scene, samples, reference, noise, *arguments):
    """The cells of a row after its name, and the images of it: noisy and denoised in each way."""
    errors, rendered, denoised, images = [], [], [], []
    for auxiliary in AUXILIARIES:
        said = host.run(scene, samples, "--auxiliary", auxiliary, *arguments)
        if said is None:
            return None
        rendered.append(seconds(said, "rendered"))
        denoised.append(seconds(said, "denoised"))
        images.append(host.image("denoised"))
        errors.append(rel_mse(images[-1], reference))
    noisy = host.image("noisy")
    images.insert(0, noisy)
    before = rel_mse(noisy, reference)
    before, *errors = (error - noise for error in (before, *errors))
    best = min(before, *errors)
    cells = [f"**{error:.2g}**" if error == best else f"{error:.2g}" for error in [before, *errors]]
    return [f"{min(rendered):.2f}", *cells, *(f"{time:.2f}" for time in (denoised[0], denoised[-1]))], images


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("host", type=Path)
    parser.add_argument("--oidn", help="the library; by default what the host finds")
    parser.add_argument("--scenes", default="cornell,room,mirrors-and-glass,textures")
    parser.add_argument("--samples", default="8,16,64,256")
    parser.add_argument("--reference", type=int, default=1536, help="samples of the reference")
    parser.add_argument("--size", type=int, nargs=2, default=[256, 192])
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--pictures", type=Path, help="folder for PNGs")
    parser.add_argument("--pictured", type=int, default=16, help="samples of the pictures and of shared hits")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        host = Host(options, Path(folder))
        host.run("cornell", 1)  # says whether OIDN is there before anything takes long
        print("| scene | samples | render, s | noisy | colour only | with albedo and normal | both prefiltered "
              "| colour only, s | prefiltered, s |\n|---|---|---|---|---|---|---|---|---|")
        notes = []
        for scene in options.scenes.split(","):
            said = host.run(scene, options.reference, "--seed", "1")
            noise = float(re.search(r"estimated relMSE (\S+)", said)[1])
            notes.append(f"{scene} {noise:.1g}")
            reference = host.image("noisy")
            for samples in map(int, options.samples.split(",")):
                kinds = [(f"{samples}", []), (f"{samples}, shared hits", ["--reuse"])]
                for label, arguments in kinds[: 2 if samples == options.pictured else 1]:
                    measured = measure(host, scene, samples, reference, noise, *arguments)
                    if measured is None:
                        continue
                    cells, images = measured
                    print("|", " | ".join([scene, label, *cells]), "|", flush=True)
                    if options.pictures and samples == options.pictured and not arguments:
                        options.pictures.mkdir(parents=True, exist_ok=True)
                        picture = [images[0], images[1], images[-1], reference]
                        write_png(options.pictures / f"denoising-{scene}.png", picture)
        print(f"\nThe references have {options.reference} samples; their own relMSE, which is taken off: {', '.join(notes)}.")


if __name__ == "__main__":
    main()
