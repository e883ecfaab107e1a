"""Renders scenes by us and by all other renderers that are installed, in one run, and measures all by one reference.

For each scene all renderers take turns in rounds, each in another order, every render with its own seed. They have the
same threads and pixels, a box filter, and no cut of depth but their own (see what differs). From two or more budgets of
seconds and a short calibration each renderer gets its samples per pixel, a power of two; what is measured is what it
then took.

relMSE is the mean over pixels and channels of (x - r)^2 / (r^2 + eps), eps = 1% of the squared mean of the reference r,
whose own noise is taken off. The table has the median of relMSE x seconds over the rounds, with the least and the
greatest. For an unbiased renderer that is the same at every budget, and half of it means the same image in half the
time. Biased ones are to be judged by their errors at each time, which are printed too.

Radiometry comes first: the mean of all renders of the largest budget must have the reference's channel means within 1%;
otherwise the row is marked as another picture and its ratio means nothing. The worst of 4 x 4 blocks is printed too.

Scenes with rough diffuse surfaces, which only Mitsuba's JIT variants and we have, are run again with Lambert's in
their place for everybody, against a reference of their own (`--lambert`). A renderer that is missing or cannot draw a
scene is SKIPPED with the reason, and the rest runs. References come from references.py.
"""

import argparse
import datetime
import json
import os
import pathlib
import platform
import statistics
import subprocess
import sys
import tempfile

try:
    import numpy as np
except ImportError as missing:
    sys.exit(f"SKIPPED: numpy is not installed ({missing}). NOTHING WAS COMPARED.")

import ours
import pictures
import references
from adapters import Refused, Skipped, read
from adapters.cycles import Cycles, CyclesGuided
from adapters.etendue import Etendue
from adapters.luxcore import LuxCore
from adapters.mitsuba import Mitsuba
from adapters.ospray import Ospray
from adapters.povray import Povray

SKIPPED = 77
SCENES = ["room", "cornell", "million", "thousand-lights", "caustic", "mirrors-and-glass"]
PEERS = {
    "mitsuba-llvm": lambda: Mitsuba("llvm_ad_rgb"),
    "mitsuba-scalar": lambda: Mitsuba("scalar_rgb"),
    "luxcore": LuxCore,
    "ospray": Ospray,
    "povray": Povray,
    "cycles": Cycles,
    "cycles-guided": CyclesGuided,
}
TOLERANCE = 0.01
"""Of channel means; beyond it a renderer draws another picture."""


def seed_of(level, turn):
    """Far apart: Mitsuba's scalar variants draw related pixels from neighbouring seeds, and are then all too bright."""
    return (1000 * level + turn + 1) * 7368787 % (1 << 31)


def machine():
    """One line on what this ran on."""
    cpu = platform.processor() or "unknown processor"
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            cpu = next(line.split(":", 1)[1].strip() for line in file if line.startswith("model name"))
    except (OSError, StopIteration):
        pass
    load = ", ".join(f"{x:.1f}" for x in os.getloadavg())
    when = datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d %H:%M UTC")
    return f"{cpu}, {os.cpu_count()} cores, {platform.system()} {platform.release()}, {when}, load at start {load}"


class Scene:
    """One table: a scene file, its reference, and the runs."""

    def __init__(self, args, path, lambert, work):
        self.args, self.path, self.lambert = args, path, lambert
        self.name = references.name_of(path, lambert)
        self.input, self.work = path, work
        self.reference, self.error, self.record = references.load(args.references, path, lambert)
        if list(self.reference.shape[:2]) != [args.resolution[1], args.resolution[0]]:
            sys.exit(f"the reference of {self.name} has not the resolution asked for")
        if lambert:
            self.input = work / f"{self.name}.json"
            ours.lambert(path, self.input)
        self.runs, self.skipped, self.sums, self.spp = [], {}, {}, {}

    def skip(self, name, reason):
        self.skipped[name] = str(reason)
        print(f"{self.name}: SKIPPED {name}: {reason}", flush=True)

    def run(self, contestants):
        """All rounds; opens those that can draw it and closes them again."""
        able, output = [], self.work / "image.pfm"
        try:
            for c in contestants:
                try:
                    c.open(self.input, self.args)
                    self.spp[c.name] = c.samples(self.args.budgets, output)
                    able.append(c)
                except (Refused, Skipped) as reason:
                    c.close()
                    self.skip(c.name, reason)
            for turn in range(self.args.rounds):
                # Another order each time, so that nobody always follows the same neighbour.
                for c in [*able[turn % len(able) :], *able[: turn % len(able)]] if able else []:
                    if turn > 0 and not c.seeded:
                        continue
                    for level, spp in enumerate(self.spp[c.name]):
                        self.measure(c, level, spp, turn, output)
                print(f"{self.name}: round {turn + 1} of {self.args.rounds}", flush=True)
        finally:
            for c in able:
                c.close()

    def measure(self, c, level, spp, turn, output):
        try:
            record = c.render(spp, seed_of(level, turn), output)
        except Refused as reason:
            self.skip(c.name, reason)
            return
        image = read(output)
        if not np.isfinite(image).all():
            print(f"{self.name}: {c.name}: {np.sum(~np.isfinite(image).all(2))} pixels are not finite, taken as 0")
            image = np.where(np.isfinite(image), image, 0.0)
        row = {
            "renderer": c.name,
            "scene": self.name,
            "spp": record["spp"],
            "budget": self.args.budgets[level],
            "seconds": record["seconds"],
            "cpu": record["cpu"],
            "relMSE": pictures.rel_mse(image, self.reference, noise=self.error),
            "round": turn,
            "mean": image.mean((0, 1)).tolist(),
        }
        if level == len(self.args.budgets) - 1:
            total, count = self.sums.get(c.name, (0.0, 0))
            self.sums[c.name] = (total + image, count + 1)
            if turn == 0 and self.args.png is not None:
                row["png"] = str(pictures.write_png(self.args.png / f"{self.name}-{c.name.replace(' ', '-')}.png", image))
        self.runs.append(row)

    def of(self, name, level):
        return [r for r in self.runs if r["renderer"] == name and r["budget"] == self.args.budgets[level]]

    def radiometry(self, name):
        """How far the worst channel's mean is off, with its standard error, and the worst block."""
        total, count = self.sums[name]
        image, wanted = total / count, self.reference.mean((0, 1))
        # Pixels are independent; where the picture is another one, its difference counts as noise here: harmless.
        noise = (image - self.reference).std(axis=(0, 1)) / np.sqrt(image[..., 0].size)
        # They are not in every renderer with few samples, so rounds that scatter more have the last word.
        rounds = np.array([r["mean"] for r in self.of(name, -1)])
        if count > 2:
            noise = np.maximum(noise, rounds.std(axis=0, ddof=1) / np.sqrt(count))
        worst = int(np.argmax(np.abs(image.mean((0, 1)) / wanted - 1)))
        there = pictures.blocks(self.reference, 4)
        off = (pictures.blocks(image, 4) - there) / np.maximum(there, 0.05 * there.mean())
        mean, block = image.mean((0, 1))[worst] / wanted[worst] - 1, off.flat[np.argmax(np.abs(off))]
        return float(mean), float(noise[worst] / wanted[worst]), float(block)

    def rows(self, contestants):
        """What the table says of each renderer, as plain data."""
        result, first = [], None
        for c in contestants:
            if not self.of(c.name, -1):
                continue
            off, error, block = self.radiometry(c.name)
            curve = []
            for level, budget in enumerate(self.args.budgets):
                runs = self.of(c.name, level)
                product = [r["relMSE"] * r["seconds"] for r in runs]
                curve.append(
                    {
                        "budget": budget,
                        "spp": runs[0]["spp"],
                        "seconds": statistics.median(r["seconds"] for r in runs),
                        "cpu": statistics.median(r["cpu"] for r in runs),
                        "relMSE": statistics.median(r["relMSE"] for r in runs),
                        "product": statistics.median(product),
                        "least": min(product),
                        "greatest": max(product),
                        "rounds": len(runs),
                    }
                )
            first = curve[-1]["product"] if first is None else first
            result.append(
                {
                    "scene": self.name,
                    "renderer": c.name,
                    "same_picture": abs(off) <= TOLERANCE or abs(off) <= 3 * error,
                    "mean_deviation": off,
                    "mean_error": error,
                    "worst_block": block,
                    "ratio": curve[-1]["product"] / first,
                    "curve": curve,
                }
            )
        return result

    def table(self, contestants):
        """Markdown."""
        noise = float(np.mean(self.error**2 / (self.reference**2 + 1e-2 * self.reference.mean() ** 2)))
        rows = self.rows(contestants)
        least = min((r["curve"][-1]["relMSE"] for r in rows), default=float("nan"))
        lambert = " All rough diffuse surfaces are Lambert's." if self.lambert else ""
        lines = [
            f"### {self.name}",
            "",
            f"Reference: {self.record.get('renderer', 'mitsuba ' + self.record.get('integrator', ''))},"
            f" {self.record['spp']} samples per pixel; its noise, taken off, is a relMSE of {noise:.2e},"
            f" {noise / least:.0%} of the least error here.{lambert}",
            "",
            "| renderer | spp | s | cpu s / thread | relMSE | relMSE x s (least to greatest) | over ours"
            " | relMSE at s, other budgets | mean off | worst block |",
            "|---|---|---|---|---|---|---|---|---|---|",
        ]
        for r in rows:
            main, others = r["curve"][-1], r["curve"][:-1]
            mark = "" if r["same_picture"] else " **other picture**"
            spp = main["spp"] if main["spp"] is not None else "-"
            spread = f" ({main['least']:.2e} to {main['greatest']:.2e})" if main["rounds"] > 1 else ""
            elsewhere = [f"{o['relMSE']:.2e} at {o['seconds']:.2f}" for o in others]
            lines.append(
                f"| {r['renderer']}{mark} | {spp} | {main['seconds']:.2f} | {main['cpu'] / self.args.threads:.2f}"
                f" | {main['relMSE']:.2e}"
                f" | {main['product']:.2e}{spread} | {r['ratio']:.2f}"
                f" | {', '.join(elsewhere)}"
                f" | {100 * r['mean_deviation']:+.2f} ± {100 * r['mean_error']:.2f} %"
                f" | {100 * r['worst_block']:+.1f} % |"
            )
        lines += [""] + [f"SKIPPED {name}: {reason}" + "\n" for name, reason in self.skipped.items()]
        return "\n".join(lines)


def variants(texts):
    """Our rows from NAME='options'."""
    result = []
    for text in texts or ["path=--integrator path"]:
        name, _, options = text.partition("=")
        result.append(Etendue(name, options))
    return result


def report(about, scenes, contestants):
    """The whole page, in Markdown."""
    lines = [f"Machine: {about['machine']}", "", about["how"], ""]
    lines += [scene.table(contestants) for scene in scenes if scene.runs or scene.skipped]
    lines += ["### What is counted, and what differs", "", "| renderer | seconds | differs |", "|---|---|---|"]
    lines += [f"| {c.about()} | {c.clock} | {c.differs} |" for c in contestants if c.version]
    lines += [
        "",
        f"*Other picture*: a channel's mean is more than {TOLERANCE:.0%} and three standard errors off the reference's,"
        " for the reasons above; its ratio is not a comparison. *Mean off*: the worst channel, with its standard error."
        " *Worst block*: the largest deviation of one of 4 x 4 blocks of the picture.",
    ]
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    default = [pathlib.Path("scenes") / f"{name}.json" for name in SCENES]
    parser.add_argument("scenes", nargs="*", type=pathlib.Path, default=default, help="native scene files")
    parser.add_argument("--references", type=pathlib.Path, default=pathlib.Path("out/references"), help="their folder")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--budgets", type=float, nargs="+", default=[0.75, 3.0], help="seconds, the last for the table")
    parser.add_argument("--lambert", choices=["also", "only", "no"], default="also", help="rough scenes with Lambert's")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--resolution", type=int, nargs=2, default=[256, 256], metavar=("W", "H"))
    parser.add_argument("--peers", nargs="*", choices=list(PEERS), default=list(PEERS), help="which of the others")
    parser.add_argument("--etendue", default="target/release/examples/etendue", help="our program")
    parser.add_argument(
        "--etendue-args", action="append", metavar="NAME=OPTIONS",
        help="a row of ours with these options of `render`, such as cache='--integrator irradiance_cache'; may be given"
        " many times; the first is what ratios are over (default: path='--integrator path')",
    )  # fmt: skip
    parser.add_argument("--mitsuba-python", default=sys.executable, help="a Python that has mitsuba")
    parser.add_argument("--luxcore-python", default=sys.executable, help="a Python that has pyluxcore")
    parser.add_argument("--cycles-python", default=sys.executable, help="a Python that has bpy")
    parser.add_argument("--json", type=pathlib.Path, help="write every run here")
    parser.add_argument("--markdown", type=pathlib.Path, help="write the tables here too")
    parser.add_argument("--png", type=pathlib.Path, help="folder for one picture of each renderer and scene")
    args = parser.parse_args()
    args.budgets.sort()
    for folder in (args.png, args.json and args.json.parent, args.markdown and args.markdown.parent):
        if folder is not None:
            folder.mkdir(parents=True, exist_ok=True)
    ours.find(args.etendue)
    about = {
        "machine": machine(),
        "how": f"{args.resolution[0]} x {args.resolution[1]} pixels, {args.threads} threads each, {args.rounds} rounds"
        f" in turns, box filter, no cut of depth unless said; budgets {', '.join(f'{b:g} s' for b in args.budgets)}.",
        "commit": commit(),
    }
    print(f"Machine: {about['machine']}\n{about['how']}", flush=True)
    contestants = variants(args.etendue_args) + [PEERS[name]() for name in args.peers]
    with tempfile.TemporaryDirectory() as folder:
        scenes = []
        for path in args.scenes:
            if not path.exists():
                print(f"SKIPPED: {path} does not exist", flush=True)
                continue
            kinds = (
                {"also": [False, True], "only": [True], "no": [False]}[args.lambert] if ours.is_rough(path) else [False]
            )
            scenes += [Scene(args, path, lambert, pathlib.Path(folder)) for lambert in kinds]
        text = "NOTHING WAS COMPARED."
        for scene in scenes:
            scene.run(contestants)
            # After each scene, so that a run that is stopped leaves what it has.
            text = report(about, scenes, contestants)
            if args.json is not None:
                rows = [row for s in scenes for row in s.rows(contestants)]
                skipped = [{"scene": s.name, "renderer": n, "reason": r} for s in scenes for n, r in s.skipped.items()]
                whole = about | {"rows": rows, "skipped": skipped, "runs": [r for s in scenes for r in s.runs]}
                args.json.write_text(json.dumps(whole, indent=1) + "\n", encoding="utf-8")
            if args.markdown is not None:
                args.markdown.write_text(text, encoding="utf-8")
    print("\n" + text)
    if not any(r["renderer"] != c.name for s in scenes for r in s.runs for c in contestants[:1]):
        sys.exit(SKIPPED)


def commit():
    done = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True)
    return done.stdout.strip()


if __name__ == "__main__":
    main()
