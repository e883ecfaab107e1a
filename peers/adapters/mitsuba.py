"""Mitsuba 3's path tracer, in one of its variants."""

from adapters import PEERS, Worker


class Mitsuba(Worker):
    clock = "from the call of the renderer to the pixels in memory; scene loaded, kernels compiled by renders before"

    def __init__(self, variant):
        self.name, self.variant = f"mitsuba {variant}", variant
        self.differs = (
            "independent sampler (its default); one light sample, emitters chosen uniformly; roulette after 5 hits;"
            " Oren-Nayar after Fujii added in Python"
            + (", which scalar variants cannot run" if variant.startswith("scalar") else "")
        )

    def command(self, scene, args):
        return [
            args.mitsuba_python, PEERS / "mitsuba" / "worker.py", scene, "--variant", self.variant,
            "--threads", args.threads, "--resolution", *args.resolution, "--max-depth", -1,
        ]  # fmt: skip
