"""Daylight in a room by Étendue and by Radiance, point by point.

Radiance comes with the package pyradiance (BSD-style licence): python3 -m venv rad && rad/bin/pip install pyradiance. The room is that of the
accuracy cases: 4 m x 4 m x 3 m with z up, a façade opening of 2 m x 1 m, but of reflectance 0.5 and 0.8 so that light is reflected. The sky is
given to both by the same formula (ISO 15469): Radiance's own overcast sky, of gensky, is another one. Radiance converts watts to lux by
179 lm/W and Étendue by 683 lm/W; both skies have 1000 cd/m2 at the zenith, so the efficacies cancel. Radiance's ambient cache is switched off
(-aa 0), so that its values have noise and no interpolation.

The table goes to standard output: lux of both, their standard errors (Radiance's from the scatter of its runs) and the difference.
"""

import argparse
import json
import math
import pathlib
import subprocess
import sys
import tempfile

try:
    import pyradiance
except ImportError:
    print("SKIPPED: there is no pyradiance")
    sys.exit(77)

RADIANCE_EFFICACY, OUR_EFFICACY, ZENITH = 179.0, 683.0, 1000.0
SUN = (0.48, -0.36, 0.8)
SKIES = {1: (4.0, -0.70, 0.0, -1.0, 0.0), 5: (0.0, -1.0, 0.0, -1.0, 0.0), 12: (-1.0, -0.32, 10.0, -3.0, 0.45)}
WINDOW = ((-1.0, 1.0), (1.0, 2.0))


def surfaces(reflectance):
    """Quads of the room, their normals inwards."""
    (x0, x1), (z0, z1) = WINDOW
    wall = lambda xs, zs: [(xs[0], -2, zs[0]), (xs[0], -2, zs[1]), (xs[1], -2, zs[1]), (xs[1], -2, zs[0])]
    quads = [
        [(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)],
        [(-2, -2, 3), (-2, 2, 3), (2, 2, 3), (2, -2, 3)],
        [(-2, 2, 0), (2, 2, 0), (2, 2, 3), (-2, 2, 3)],
        [(-2, -2, 0), (-2, 2, 0), (-2, 2, 3), (-2, -2, 3)],
        [(2, -2, 0), (2, -2, 3), (2, 2, 3), (2, 2, 0)],
        wall((-2, x0), (0, 3)),
        wall((x1, 2), (0, 3)),
        wall((x0, x1), (0, z0)),
        wall((x0, x1), (z1, 3)),
    ]
    return [(quad, reflectance) for quad in quads]


def points():
    """Points of a working plane and of a wall, each with its normal."""
    plane = [((x, y, 0.8), (0, 0, 1)) for y in (-1.5, -0.5, 0.5, 1.5) for x in (-1.0, 0.5)]
    return plane + [((1.99, -0.5, 1.2), (-1, 0, 0)), ((0.3, 1.99, 1.5), (0, -1, 0))]


def ours(program, folder, number, reflectance, error):
    scene = {
        "etendue": 1,
        "camera": {"origin": [0, 0, 1.5], "lookAt": [1, 0, 1.5], "up": [0, 0, 1]},
        "materials": [{"name": "wall", "type": "diffuse", "color": [reflectance] * 3}],
        "lights": [
            {"type": "sky", "cie": number, "sun": SUN, "up": [0, 0, 1], "unit": "cd/m2", "intensity": ZENITH}
        ],
        "surfaces": [
            {"geometry": "quad", "material": "wall"} | {f"vertex-{i + 1}": list(p) for i, p in enumerate(quad)}
            for quad, _ in surfaces(reflectance)
        ],
    }
    grid = {"name": "points", "type": "points", "points": [p for p, _ in points()], "normals": [n for _, n in points()]}
    (folder / "room.json").write_text(json.dumps(scene), encoding="utf-8")
    (folder / "grid.json").write_text(json.dumps({"grids": [grid]}), encoding="utf-8")
    command = [program, "lux", folder / "room.json", "--grid", folder / "grid.json", "--error", str(error)]
    subprocess.run([*command, "-o", folder / "lux.json", "--quiet"], check=True, stdout=subprocess.DEVNULL)
    found = json.loads((folder / "lux.json").read_text(encoding="utf-8"))["grids"][0]
    return list(zip(found["values"], found["standardErrors"]))


def theirs(folder, number, reflectance, runs, ambient):
    programs = pathlib.Path(pyradiance.BINPATH)
    a, b, c, d, e = SKIES[number]
    formula = f"""
chi = Acos(Dx*{SUN[0]} + Dy*{SUN[1]} + Dz*{SUN[2]});
Acos(x) : acos(if(x-1, 1, if(-1-x, -1, x)));
phi(z) : 1 + {a}*exp({b}/z);
ind(x) : 1 + {c}*(exp({d}*x) - exp({d}*{math.pi / 2})) + {e}*cos(x)*cos(x);
skyb = if(Dz-1e-6, phi(Dz)*ind(chi) / (phi(1)*ind({math.acos(SUN[2])})), 0);
"""
    (folder / "sky.cal").write_text(formula, encoding="utf-8")
    level = ZENITH / RADIANCE_EFFICACY
    lines = [
        "void brightfunc skyfunc 2 skyb sky.cal 0 0",
        f"skyfunc glow sky_glow 0 0 4 {level} {level} {level} 0",
        "sky_glow source sky 0 0 4 0 0 1 180",
        f"void plastic wall 0 0 5 {reflectance} {reflectance} {reflectance} 0 0",
    ]
    for i, (quad, _) in enumerate(surfaces(reflectance)):
        lines.append(f"wall polygon quad{i} 0 0 12 " + " ".join(str(x) for p in quad for x in p))
    (folder / "room.rad").write_text("\n".join(lines) + "\n", encoding="utf-8")
    octree = subprocess.run([programs / "oconv", "room.rad"], cwd=folder, check=True, stdout=subprocess.PIPE).stdout
    (folder / "room.oct").write_bytes(octree)
    rays = "".join(" ".join(str(x) for x in (*p, *n)) + "\n" for p, n in points())
    options = ["-I+", "-h", "-u+", "-ab", "60", "-aa", "0", "-as", "0", "-ad", str(ambient), "-lw", "1e-9", "-lr", "-60"]
    sums, squares = [0.0] * len(points()), [0.0] * len(points())
    # Each line once more is another sample: rays with -u+ are random and not the same.
    run = subprocess.run(
        [programs / "rtrace", *options, "room.oct"], cwd=folder, input=(rays * runs).encode(), check=True, stdout=subprocess.PIPE
    )
    values = [float(line.split()[1]) * RADIANCE_EFFICACY for line in run.stdout.decode().strip().splitlines()]
    assert len(values) == runs * len(points()), "a value for each ray"
    for i, value in enumerate(values):
        sums[i % len(points())] += value
        squares[i % len(points())] += value * value
    means = [total / runs for total in sums]
    return [(m, math.sqrt(max(q / runs - m * m, 0) / (runs - 1))) for m, q in zip(means, squares)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--etendue", default="target/release/examples/etendue", help="our program")
    parser.add_argument("--error", type=float, default=0.003, help="our relative error (default 0.003)")
    parser.add_argument("--runs", type=int, default=32, help="Radiance's samples of each point (default 32)")
    parser.add_argument("--ambient", type=int, default=2048, help="Radiance's ambient divisions (default 2048)")
    args = parser.parse_args()
    program = pathlib.Path(args.etendue).resolve()
    print(f"Radiance of pyradiance {pyradiance.__version__}, -ad {args.ambient}, {args.runs} runs")
    print("| sky | reflectance | point | Étendue, lx | Radiance, lx | difference | standard errors |")
    print("|---|---|---|--:|--:|--:|--:|")
    for number in SKIES:
        for reflectance in (0.0, 0.5, 0.8):
            with tempfile.TemporaryDirectory() as name:
                folder = pathlib.Path(name)
                mine = ours(program, folder, number, reflectance, args.error)
                other = theirs(folder, number, reflectance, args.runs, args.ambient)
            for (p, _), (a, ea), (b, eb) in zip(points(), mine, other):
                where = ", ".join(str(x) for x in p)
                off = (a - b) / math.hypot(ea, eb) if ea or eb else 0.0
                difference = f"{100 * (a / b - 1):+.2f} %" if b > 0 else "-"
                row = f"{a:.2f} ± {ea:.2f} | {b:.2f} ± {eb:.2f} | {difference} | {off:+.1f}"
                print(f"| {number} | {reflectance} | {where} | {row} |", flush=True)


if __name__ == "__main__":
    main()
