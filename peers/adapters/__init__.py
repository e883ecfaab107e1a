"""One file for each renderer that bench.py compares, and what they have in common."""

import json
import math
import pathlib
import resource
import subprocess

import pictures
from ours import Refused

PEERS = pathlib.Path(__file__).resolve().parent.parent


def cpu_of_children():
    """Processor seconds of all processes that were started and have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class Skipped(Exception):
    """A renderer is not installed; says what is missing."""


class Contestant:
    """A renderer with one scene at a time.

    `clock`: what its seconds count. `differs`: how its model is another than ours. Both are printed.
    """

    name, clock, differs, version = "", "", "", ""
    seeded = True
    """Whether a seed changes the image; where not, one round tells everything about its error."""

    def open(self, scene, args):
        """Loads a scene; raises `Refused` where it cannot be drawn, `Skipped` where the renderer is missing."""
        raise NotImplementedError

    def render(self, spp, seed, output):
        """Renders to a PFM file; a record with `seconds`, `cpu` (processor seconds) and `spp`."""
        raise NotImplementedError

    def close(self):
        """Forgets the scene."""

    def samples(self, budgets, output):
        """Samples per pixel for each budget (s): the nearest power of two by short renders, which warm up as well.

        More than one, for the fixed part of the time (maps, caches, launches) is not to be taken for samples.
        """
        self.render(1, 1, output)
        spp, seconds, each = 1, self.render(1, 2, output)["seconds"], None
        while (seconds < 0.25 or each is None) and seconds < 0.5 * max(budgets) and spp < 1 << 14:
            longer = self.render(4 * spp, 2 + spp, output)["seconds"]
            each = max((longer - seconds) / (3 * spp), longer / (16 * spp))
            spp, seconds = 4 * spp, longer
        each = each or seconds / spp
        fixed = max(seconds - spp * each, 0.0)
        return [2 ** max(0, round(math.log2(max(budget - fixed, each) / each))) for budget in budgets]

    def about(self):
        return f"{self.name} {self.version}".strip()


class Worker(Contestant):
    """A renderer in a process that keeps the scene: a line of JSON in for every render, one out when it is done."""

    process = None

    def command(self, scene, args):
        raise NotImplementedError

    def environment(self, args):
        return None

    def open(self, scene, args):
        command = [str(x) for x in self.command(scene, args)]
        try:
            self.process = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
                env=self.environment(args),
            )
        except OSError as error:
            raise Skipped(f"{command[0]}: {error.strerror}") from None
        self.version = self.answer().get("version", "")

    def answer(self):
        line = self.process.stdout.readline()
        if line:
            return json.loads(line)
        said = self.process.stderr.read().strip().splitlines() or ["no message"]
        code = self.process.wait()
        reason = next((x for x in said if "error" in x or "SKIPPED" in x), said[-1])
        self.close()
        raise (Skipped if code == 77 else Refused)(reason)

    def render(self, spp, seed, output):
        self.process.stdin.write(json.dumps({"spp": spp, "seed": seed, "output": str(output)}) + "\n")
        self.process.stdin.flush()
        return self.answer()

    def close(self):
        if self.process is not None:
            self.process.stdin.close()
            self.process.wait()
            self.process.stdout.close()
            self.process.stderr.close()
            self.process = None


def read(output):
    return pictures.read_pfm(output)
