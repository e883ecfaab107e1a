"""Blender's Cycles, by its Python module."""

from adapters import PEERS, Worker


class Cycles(Worker):
    name = "cycles CPU"
    clock = (
        "its own render time, in hundredths: from the first sample (scene synchronised, hierarchy built) to the last, without"
        " the file; cpu has both"
    )
    differs = (
        "scenes of meshes and spheres, which are fine meshes for it, with lamps that are surfaces, or under an environment; tabulated"
        " Sobol samples, its default; masking of facets correlated by height; an environment's image is interpolated across the poles"
        " from one edge to the other; paths end after 1024 hits"
    )
    options = ()

    def command(self, scene, args):
        return [
            args.cycles_python, PEERS / "cycles" / "worker.py", scene,
            "--threads", args.threads, "--resolution", *args.resolution,
            *self.options,
        ]  # fmt: skip


class CyclesGuided(Cycles):
    name = "cycles CPU guided"
    differs = Cycles.differs + "; with its path guiding, which learns from the first 128 samples of a pixel"
    options = ("--guiding",)
