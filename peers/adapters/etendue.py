"""Ours: the command line, with any options."""

import ours
from adapters import Contestant, cpu_of_children


class Etendue(Contestant):
    clock = "`seconds` of --stats, or the summary line: rendering, without start, scene and files"
    differs = "nothing: it is the model of the reference"

    def __init__(self, name, options):
        """`options` may name --spp or --time themselves; `{budget}` in them becomes the budget's seconds."""
        self.name, self.options = f"etendue {name}", ours.options_of(options)
        if "irradiance_cache" in self.options or "caustic" in self.options or "photon" in " ".join(self.options):
            self.differs = "biased: relMSE x s is no constant; see the errors at each time"

    def open(self, scene, args):
        self.scene, self.program, self.threads = scene, ours.find(args.etendue), args.threads
        self.size = "x".join(str(n) for n in args.resolution)
        self.version = ours.run([self.program, "--version"]).split()[-1]

    def own_budget(self):
        return "--time" in self.options or "--spp" in self.options

    def samples(self, budgets, output):
        return list(budgets) if self.own_budget() else super().samples(budgets, output)

    def render(self, spp, seed, output):
        options = [o.replace("{budget}", f"{spp:g}") for o in self.options]
        options += ["--resolution", self.size, "--filter", "box", "--max-depth", "none"]
        if not self.own_budget():
            options += ["--spp", spp]
        before = cpu_of_children()
        seconds = ours.render(self.program, self.scene, output, self.threads, seed, *options)
        cpu = cpu_of_children() - before
        return {"seconds": seconds, "cpu": cpu, "spp": None if self.own_budget() else spp}
