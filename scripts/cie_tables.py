#!/usr/bin/env python3
"""Makes the tables of colorimetry: src/spectrum/tables/observer.f32, daylight.f32 and fluorescent.f32.

The numbers are those that the CIE publishes, read from the Python package `colour-science`: python3 scripts/cie_tables.py FOLDER, the
folder of that package's `colour`. All numbers are little-endian f32.

observer.f32: [wavelength 360 to 830 nm by 1 nm][x, y, z], the colour matching functions of the standard observer of 1931 for 2 degrees
(DOI 10.25039/CIE.DS.xvudnb9b).
daylight.f32: [wavelength 300 to 830 nm by 10 nm][S0, S1, S2], the components of daylight (CIE 015:2018, table 6). Between them they are
linear, as CIE's own values by 5 nm are.
fluorescent.f32: [lamp FL1 to FL12][wavelength 380 to 780 nm by 5 nm], relative spectral power (CIE 15:2004, table T.6.1).
"""

import ast
import sys
from pathlib import Path

import numpy as np


def table(path, name):
    """The dictionary that a module assigns to `name`."""
    for statement in ast.parse(path.read_text()).body:
        target = getattr(statement, "target", None) or (getattr(statement, "targets", None) or [None])[0]
        if isinstance(target, ast.Name) and target.id == name:
            return ast.literal_eval(statement.value)
    raise SystemExit(f"{path} has no {name}")


def main():
    datasets = Path(sys.argv[1]) / "colorimetry" / "datasets"
    observer = table(datasets / "cmfs.py", "DATA_CMFS_STANDARD_OBSERVER")["CIE 1931 2 Degree Standard Observer"]
    daylight = table(datasets / "illuminants" / "sds_d_illuminant_series.py", "DATA_BASIS_FUNCTIONS_CIE_ILLUMINANT_D_SERIES")
    illuminants = table(datasets / "illuminants" / "sds.py", "DATA_ILLUMINANTS_CIE")
    lamps = [illuminants[f"FL{number}"] for number in range(1, 13)]
    assert all(sorted(lamp) == list(range(380, 781, 5)) for lamp in lamps)
    tables = {
        "observer.f32": [observer[nm] for nm in range(360, 831)],
        "daylight.f32": [[daylight[part][nm] for part in ("S0", "S1", "S2")] for nm in range(300, 831, 10)],
        "fluorescent.f32": [[lamp[nm] for nm in range(380, 781, 5)] for lamp in lamps],
    }
    for nm in range(305, 830, 10):
        for part in ("S0", "S1", "S2"):
            middle = (daylight[part][nm - 5] + daylight[part][nm + 5]) / 2
            assert abs(daylight[part][nm] - middle) < 0.006, (nm, part)
    for name, rows in tables.items():
        np.array(rows, "<f4").tofile(Path(__file__).parent.parent / "src" / "spectrum" / "tables" / name)


if __name__ == "__main__":
    main()
