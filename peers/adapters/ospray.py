"""OSPRay 3's path tracer, in a small host of our own."""

import pathlib
import subprocess
import sys
import tempfile

from adapters import PEERS, Refused, Skipped, Worker


class Ospray(Worker):
    name = "ospray pathtracer"
    clock = "from the first frame asked for to the pixels mapped; scene committed, one frame drawn before"
    differs = (
        "no seed: rounds take the frames that follow; lamps are luminous meshes (flat ones with a black back, spheres"
        " of 1000 triangles); one light sample; shadow rays go straight through glass, so caustics differ; no rough"
        " diffuse surfaces"
    )
    host = None

    def build(self):
        """The host's executable, compiled once."""
        if Ospray.host is None:
            folder = tempfile.mkdtemp()
            program = pathlib.Path(folder) / "host_bench"
            command = ["cc", "-std=c99", "-O2", PEERS / "ospray" / "host_bench.c", "-o", program, "-lospray"]
            done = subprocess.run(command, capture_output=True, text=True)
            if done.returncode:
                said = next((x for x in done.stderr.splitlines() if "error" in x or "cannot find" in x), done.stderr)
                raise Skipped(f"the host does not build (Debian 13: libospray-dev): {said}")
            Ospray.host = program
        return Ospray.host

    def command(self, scene, args):
        self.folder = tempfile.TemporaryDirectory()
        dump = [sys.executable, PEERS / "ospray" / "dump.py", scene, self.folder.name, "--resolution", *args.resolution]
        done = subprocess.run([str(x) for x in dump], capture_output=True, text=True)
        if done.returncode:
            raise (Skipped if done.returncode == 77 else Refused)(done.stderr.strip().splitlines()[-1])
        return [self.build(), self.folder.name, args.threads]
