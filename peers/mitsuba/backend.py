"""What every script here shares: finding Mitsuba, reading and writing images, one measure of error."""

import glob
import os
import re
import sys

SKIPPED = 77
"""Exit code of a script that could not run because Mitsuba is missing (the code test drivers read as "skipped")."""


def skip(reason):
    """Ends the script with `SKIPPED`, loudly."""
    print(
        f"SKIPPED: {reason}. NOTHING WAS COMPARED.\n"
        "Install what is missing with: python3 -m venv peer && peer/bin/pip install mitsuba numpy",
        file=sys.stderr,
    )
    sys.exit(SKIPPED)


# This module is the first that scripts import, so that they end here and not with a traceback.
try:
    import numpy as np
except ImportError as missing:
    skip(f"numpy is not installed ({missing})")


def find_llvm():
    """Points DRJIT_LIBLLVM_PATH at the newest LLVM >= 17 in the usual folders, unless the variable is set already."""
    if "DRJIT_LIBLLVM_PATH" in os.environ:
        return
    found = []
    for pattern in ("/usr/lib/*/libLLVM*.so*", "/usr/lib/llvm-*/lib/libLLVM*.so*", "/usr/lib64/libLLVM*.so*"):
        for path in glob.glob(pattern):
            version = re.search(r"LLVM(?:-|\.so\.)(\d+)", path)
            if version and int(version.group(1)) >= 17:
                found.append((int(version.group(1)), path))
    if found:
        os.environ["DRJIT_LIBLLVM_PATH"] = max(found)[1]


def mitsuba(variant=None):
    """Imports Mitsuba and selects a variant, or ends the script with `SKIPPED` and says what to install."""
    find_llvm()
    try:
        import mitsuba as mi
    except ImportError as error:
        skip(f"Mitsuba 3 is not installed ({error})")
    if variant is not None:
        select(mi, variant)
    return mi


def select(mi, variant):
    """Selects a variant and makes our BSDFs known in it."""
    try:
        mi.set_variant(variant)
    except ImportError as error:
        hint = "; it needs LLVM >= 17, set DRJIT_LIBLLVM_PATH to libLLVM.so" if variant.startswith("llvm") else ""
        skip(f"variant {variant} does not start ({error}){hint}")
    import models

    models.register(mi)


def set_threads(count):
    """Limits Mitsuba to `count` threads; 0 leaves all cores."""
    if count:
        import drjit as dr

        dr.set_thread_count(count)


def read_exr(path):
    """An image as float64 [height][width][3], row 0 on top."""
    mi = mitsuba()
    if mi.variant() is None:
        mi.set_variant("scalar_rgb")
    # A file with further layers is split into them; the image itself is the root layer.
    bitmap = dict(mi.Bitmap(str(path)).split())["<root>"].convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, srgb_gamma=False)
    return np.array(bitmap, dtype=np.float64)


def write_exr(path, image):
    """Writes [height][width][3] as 32-bit floating point RGB."""
    mi = mitsuba()
    if mi.variant() is None:
        mi.set_variant("scalar_rgb")
    mi.Bitmap(np.ascontiguousarray(image, dtype=np.float32)).write(str(path))


def write_png(path, image):
    """Writes values in [0, 1], scene-linear, as an 8-bit sRGB PNG (clamped)."""
    mi = mitsuba()
    if mi.variant() is None:
        mi.set_variant("scalar_rgb")
    x = np.clip(image, 0.0, 1.0)
    x = np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
    mi.Bitmap(np.round(255 * x).astype(np.uint8)).write(str(path))


def epsilon(reference):
    """The constant that keeps relMSE finite in black pixels: 1% of the squared mean of the reference."""
    return 1e-2 * float(reference.mean()) ** 2


def rel_mse(image, reference, error=None):
    """Mean over pixels and channels of (x - r)^2 / (r^2 + eps), with eps from `epsilon`.

    `error`: the reference's standard error per pixel; its expected share is subtracted (it is independent of `image`).
    """
    weight = 1.0 / (reference**2 + epsilon(reference))
    value = float(np.mean((image - reference) ** 2 * weight))
    if error is not None:
        value -= float(np.mean(error**2 * weight))
    return value


def passes(mi, scene, spp, seed=0, wavefront=1 << 22):
    """Yields images of at most `wavefront` paths each, `spp` samples per pixel in all, every one with its own seed."""
    width, height = scene.sensors()[0].film().size()
    # Scalar variants keep no wavefront in memory, so nothing is gained by cutting there.
    most = spp if mi.variant().startswith("scalar") else max(1, wavefront // (int(width) * int(height)))
    done, index = 0, 0
    while done < spp:
        n = min(most, spp - done)
        # Seeds far apart for different runs; consecutive for the passes of one.
        yield n, np.array(mi.render(scene, spp=n, seed=(seed * 100003 + index) % 2**32), dtype=np.float64)
        done, index = done + n, index + 1


def render(mi, scene, spp, seed=0):
    """One image of `spp` samples per pixel in float64, passes averaged."""
    total = 0.0
    for n, image in passes(mi, scene, spp, seed):
        total = total + n * image
    return total / spp
