#!/usr/bin/env python3
"""Makes the table of measured metals: src/spectrum/tables/metals.f32.

The numbers are the optical constants of IMD (Windt 1998), most of which are those of Palik 1985, as files NAME.eta.spd and NAME.k.spd of
two columns, wavelength in nm and value: python3 scripts/metal_tables.py FOLDER. They are interpolated linearly.

metals.f32: [metal in the order of METALS][wavelength 360 to 830 nm by 5 nm][n, k], little-endian f32.
"""

import sys
from pathlib import Path

import numpy as np

METALS = ["Ag", "Al", "Au", "Cr", "Cu", "Hg", "Ir", "Ni_palik", "Rh", "TiN", "W"]


def main():
    folder = Path(sys.argv[1])
    wavelengths = np.arange(360, 831, 5)
    rows = []
    for metal in METALS:
        columns = []
        for part in ("eta", "k"):
            lines = (folder / f"{metal}.{part}.spd").read_text().splitlines()
            pairs = np.array([line.split() for line in lines if line.strip() and not line.startswith("#")], float)
            assert pairs[0, 0] < 400 and pairs[-1, 0] > 800, (metal, pairs[0, 0], pairs[-1, 0])
            columns.append(np.interp(wavelengths, pairs[:, 0], pairs[:, 1]))
        rows.append(np.stack(columns, 1))
    out = Path(__file__).parent.parent / "src" / "spectrum" / "tables" / "metals.f32"
    np.array(rows, "<f4").tofile(out)
    at = {nm: i for i, nm in enumerate(wavelengths)}
    for metal, row in zip(METALS, rows, strict=True):
        print(metal, *(np.round(row[at[nm]], 4) for nm in (650, 550, 450)))


if __name__ == "__main__":
    main()
