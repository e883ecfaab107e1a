#!/usr/bin/env python3
"""Makes the tables of the sky of Hosek and Wilkie: src/emitter/hosek_wilkie/sky.f32 and sun.f32.

The published datasets are read from the file that Mitsuba 3 has them in: python3 scripts/sky_tables.py FOLDER, the folder of the
Python package `mitsuba`, which also has the colour matching functions of CIE 1931. All numbers are little-endian f32.

sky.f32: [channel 3][albedo 2][turbidity 10][control point 6][9 numbers of the formula, then the radiance], as published for linear
Rec. 709.
sun.f32: [turbidity 10][piece of elevation 45][channel 3][coefficient 4], from the published spectral radiance of the sun: its
wavelengths are interpolated linearly from 360 to 720 nm and weighted as the sky's are (CIE 1931 without normalisation, then the matrix
to Rec. 709), which is linear, so that coefficients can be weighted in place of radiances.
"""

import struct
import sys
from pathlib import Path

import numpy as np

TO_REC_709 = np.array([[3.240479, -1.537150, -0.498535], [-0.969256, 1.875991, 0.041556], [0.055648, -0.204043, 1.057311]])
BANDS = np.arange(320.0, 721.0, 40.0)


def fields(path):
    """The arrays of doubles of a file of tensors."""
    data = path.read_bytes()
    assert data[:12] == b"tensor_file\0"
    (count,) = struct.unpack_from("<I", data, 14)
    at, found = 18, {}
    for _ in range(count):
        (length,) = struct.unpack_from("<H", data, at)
        name = data[at + 2 : at + 2 + length].decode()
        dimensions, kind, offset = struct.unpack_from("<HBQ", data, at + 2 + length)
        at += 13 + length
        shape = struct.unpack_from(f"<{dimensions}Q", data, at)
        at += 8 * dimensions
        assert kind == 11, "doubles are expected"
        found[name] = np.frombuffer(data, "<f8", int(np.prod(shape)), offset).reshape(shape)
    return found


def band_colours(mitsuba):
    """The colour of a radiance of 1 in each band, which falls to 0 at its neighbours."""
    wavelengths = np.arange(360.0, 720.5, 1.0)
    curves = np.array([np.array(mitsuba.cie1931_xyz(float(w))).ravel() for w in wavelengths])
    hats = np.array([np.interp(wavelengths, BANDS, row) for row in np.eye(len(BANDS))])
    return hats @ curves @ TO_REC_709.T


def main():
    package = Path(sys.argv[1])
    sys.path.insert(0, str(package.parent))
    import mitsuba

    mitsuba.set_variant("scalar_rgb")
    data = fields(package / "data/sunsky/sunsky_datasets.bin")
    # Both are [turbidity][albedo][control point][channel] with the numbers last.
    sky = np.concatenate([data["sky_params_rgb"], data["sky_rad_rgb"][..., None]], axis=-1)
    sun = np.einsum("tpbc,bk->tpkc", data["sun_rad_spec"], band_colours(mitsuba))
    folder = Path(__file__).parent.parent / "src/emitter/hosek_wilkie"
    (folder / "sky.f32").write_bytes(sky.transpose(3, 1, 0, 2, 4).astype("<f4").tobytes())
    (folder / "sun.f32").write_bytes(sun.astype("<f4").tobytes())


main()
