"""Images and their measures, for what compares us with more than one renderer. Needs numpy, and OpenEXR
for files of that kind.

Images are float64 [height][width][3], row 0 on top, scene-linear.
"""

import numpy as np


def read_pfm(path):
    """A colour PFM file of either byte order."""
    with open(path, "rb") as file:
        if file.readline().strip() != b"PF":
            raise ValueError(f"{path} is not a colour PFM file")
        width, height = (int(x) for x in file.readline().split())
        order = "<" if float(file.readline()) < 0 else ">"
        data = np.frombuffer(file.read(12 * width * height), dtype=order + "f4")
    return data.reshape(height, width, 3)[::-1].astype(np.float64)


def write_pfm(path, image):
    """32-bit floating point, little-endian, rows from the bottom as the format wants."""
    height, width = image.shape[:2]
    with open(path, "wb") as file:
        file.write(f"PF\n{width} {height}\n-1.0\n".encode())
        file.write(np.ascontiguousarray(image[::-1]).astype("<f4").tobytes())


def read_exr(path, prefix=""):
    """Three channels of an EXR file, those of a layer with its prefix (`variance.`); None if they are not there."""
    import OpenEXR

    channels = OpenEXR.File(str(path), separate_channels=True).parts[0].channels
    names = [prefix + c for c in "RGB"]
    if not all(name in channels for name in names):
        return None
    return np.stack([channels[name].pixels for name in names], 2).astype(np.float64)


def rel_mse(image, reference, where=None, noise=None):
    """Mean over pixels and channels of (x - r)^2 / (r^2 + eps), eps = 1% of the squared mean of the reference.

    `where`: a mask [height][width] of the pixels to count; eps is that of the whole reference all the same. `noise`:
    the reference's standard error per pixel, whose expected share is taken off.
    """
    weight = 1.0 / (reference**2 + 1e-2 * float(reference.mean()) ** 2)
    error = ((image - reference) ** 2 - (0.0 if noise is None else noise**2)) * weight
    return float(np.mean(error if where is None else error[where]))


def blocks(image, count):
    """Means [count][count] over equal regions and the channels; what does not divide evenly is left out."""
    height, width = (n // count * count for n in image.shape[:2])
    return image[:height, :width].reshape(count, height // count, count, width // count, 3).mean((1, 3, 4))


def write_png(path, image):
    """Values clamped to [0, 1], sRGB; None and a word where Pillow is missing."""
    try:
        from PIL import Image
    except ImportError:
        return None
    x = np.clip(image, 0.0, 1.0)
    x = np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
    Image.fromarray(np.round(255 * x).astype(np.uint8)).save(path)
    return path
