"""LuxCore's PATHCPU."""

from adapters import PEERS, Worker


class LuxCore(Worker):
    name = "luxcore PATHCPU"
    clock = "from the start of sampling (scene and hierarchy ready) to the stop of the last thread"
    differs = (
        "spheres are smooth meshes of 256 x 512 quadrilaterals; paths end after 64 hits; lights chosen by the log of"
        " their power; no rough diffuse surfaces"
    )

    def command(self, scene, args):
        return [
            args.luxcore_python, PEERS / "luxcore" / "worker.py", scene,
            "--threads", args.threads, "--resolution", *args.resolution,
        ]  # fmt: skip
