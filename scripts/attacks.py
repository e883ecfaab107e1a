#!/usr/bin/env python3
"""Attacks on the command line program: kills, full disks, signals, limits, and files that are large, odd or damaged.

    attacks.py BINARY SCENES [--seed N] [--only NAME,...] [--folder DIR] [--verbose]

Every attack has to end with a documented exit code and, where it fails, with one line on standard error that names the
file or value and the cause. It must not panic, crash, hang or take memory without bounds, and an old output file stays
whole. Prints a line for each attack and the number of violations; exits with 1 if there are any.
"""

import argparse
import json
import math
import os
import random
import re
import resource
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import zlib

IS_ROOT = os.geteuid() == 0
MIB = 1 << 20

# What a Rust program prints when it panics or aborts, and what must not be seen by a user.
BAD_WORDS = ("panicked", "RUST_BACKTRACE", "internal error", "stack overflow", "memory allocation of",
             "terminate called", "SIGSEGV", "Segmentation")


class Run:
    """What came of one run of the program."""

    def __init__(self, code, out, err, seconds, peak, hung, greedy):
        self.code, self.out, self.err = code, out, err
        self.seconds, self.peak, self.hung, self.greedy = seconds, peak, hung, greedy


def memory_of(pid):
    """Resident memory of a process [bytes], 0 where it is not known."""
    try:
        with open(f"/proc/{pid}/statm", "rb") as file:
            return int(file.read().split()[1]) * resource.getpagesize()
    except (OSError, IndexError, ValueError):
        return 0


class Attacks:
    def __init__(self, options):
        self.binary = os.path.abspath(options.binary)
        self.scenes = os.path.abspath(options.scenes)
        self.random = random.Random(options.seed)
        self.seed = options.seed
        self.verbose = options.verbose
        self.violations = []
        self.count = 0
        self.root = tempfile.mkdtemp(prefix="attacks-", dir=options.folder)
        self.mounts = []
        # Backtraces would be more than the one line that is asked for.
        self.environment = {name: value for name, value in os.environ.items() if not name.startswith("RUST_")}

    # Helpers

    def scene(self, name):
        return os.path.join(self.scenes, name)

    def path(self, *names):
        path = os.path.join(self.root, *names)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        return path

    def write(self, name, data):
        path = self.path(name)
        with open(path, "wb") as file:
            file.write(data if isinstance(data, bytes) else data.encode())
        return path

    def native(self, name, surfaces=None, **keys):
        """A small native scene with a lamp and the given surfaces."""
        lamp = {"geometry": "sphere", "origin": [0, 3, 0], "radius": 0.5, "emission": [9, 9, 9]}
        scene = {"etendue": 1, "camera": {"origin": [0, 1, 5], "lookAt": [0, 1, 0]},
                 "render": {"resolution": [16, 12], "samples": 1},
                 "materials": [{"name": "grey", "type": "diffuse", "color": [0.5, 0.5, 0.5]}],
                 "surfaces": [lamp] + (surfaces or [])}
        scene.update(keys)
        return self.write(name, json.dumps(scene))

    def mount(self, name, options):
        """A file system in memory, or None where that is not allowed."""
        path = self.path(name, "")
        if not IS_ROOT:
            return None
        done = subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", path], stderr=subprocess.DEVNULL)
        if done.returncode != 0:
            return None
        self.mounts.append(path)
        return path

    def unmount(self, path):
        subprocess.run(["umount", "-l", path], stderr=subprocess.DEVNULL)
        self.mounts.remove(path)

    def start(self, args, limits=(), user=None, stdout=None, stderr=None, cwd=None):
        """Starts the program; returns it with the files that its output goes to."""
        out = tempfile.TemporaryFile() if stdout is None else stdout
        err = tempfile.TemporaryFile() if stderr is None else stderr

        def prepare():
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            os.nice(5)
            if user is not None:
                os.setgid(user)
                os.setuid(user)
            for which, value in limits:
                resource.setrlimit(which, (value, value))

        process = subprocess.Popen([self.binary] + args, stdin=subprocess.DEVNULL, stdout=out, stderr=err,
                                   preexec_fn=prepare, cwd=cwd or self.root, env=self.environment)
        return process, out, err

    @staticmethod
    def has_ended(started):
        """Whether a run is over; its exit code is still to be fetched."""
        return os.waitid(os.P_PID, started[0].pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is not None

    def finish(self, started, timeout=20.0, most=2048 * MIB):
        """Waits for the end of a run, and ends it where it takes too long or too much memory."""
        process, out, err = started
        began = time.monotonic()
        peak, hung, greedy = 0, False, False
        while True:
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
            if pid:
                break
            peak = max(peak, memory_of(process.pid))
            if time.monotonic() - began > timeout or peak > most:
                hung, greedy = peak <= most, peak > most
                os.kill(process.pid, signal.SIGKILL)
                _, status, usage = os.wait4(process.pid, 0)
                break
            time.sleep(0.002 if time.monotonic() - began < 0.5 else 0.02)
        seconds = time.monotonic() - began
        process.returncode = code = os.waitstatus_to_exitcode(status)
        peak = max(peak, usage.ru_maxrss * 1024)

        def text(file):
            if not hasattr(file, "seek"):
                return ""
            try:
                file.seek(0)
                return file.read(1 << 20).decode("utf-8", "replace")
            except (OSError, ValueError):
                return ""

        return Run(code, text(out), text(err), seconds, peak, hung, greedy or peak > most)

    def run(self, *args, timeout=20.0, most=2048 * MIB, **how):
        return self.finish(self.start([str(arg) for arg in args], **how), timeout, most)

    def faults(self, run, codes=(0, 1, 2), names=(), silent=False):
        """What is wrong with the end of a run; `names` are words that an error message has to contain."""
        wrong = []
        if run.hung:
            return [f"hangs for {run.seconds:.0f} s"]
        if run.greedy:
            return [f"takes {run.peak / MIB:.0f} MiB"]
        if run.code < 0:
            wrong.append(f"dies of signal {-run.code}")
        elif run.code not in codes:
            wrong.append(f"exit code {run.code}, expected {'/'.join(map(str, codes))}")
        word = next((word for word in BAD_WORDS if word in run.err), None)
        if word:
            wrong.append(f"says '{word}'")
        if run.code in (1, 2) and not silent:
            lines = [line for line in run.err.splitlines() if line.strip() and not line.startswith("warning: ")]
            is_usage = run.code == 2 and "--help" in run.err
            if not lines or not lines[0].startswith("error: ") or (len(lines) > 1 and not is_usage):
                wrong.append("is not one line of error")
            elif len(lines[0]) > 6000:
                wrong.append(f"has a message of {len(lines[0])} characters")
            else:
                wrong += [f"does not name '{name}'" for name in names if str(name) not in lines[0]]
        return wrong

    def report(self, attack, run=None, wrong=(), note=""):
        """Prints the line of an attack."""
        self.count += 1
        what = "VIOLATION" if wrong else "ok"
        parts = []
        if run is not None:
            message = next((line for line in run.err.splitlines() if line.startswith("error")), "")
            if not message and (wrong or self.verbose):
                message = " / ".join(run.err.splitlines()[-3:])
            parts.append(f"code {run.code}, {run.seconds:.1f} s, {run.peak / MIB:.0f} MiB")
            if message:
                parts.append(message.replace(self.root, "")[:240])
        if note:
            parts.append(note)
        if wrong:
            self.violations.append(f"{attack}: {'; '.join(wrong)}")
            parts.insert(0, "; ".join(wrong))
        print(f"{what:9} {attack}: {' | '.join(parts)}", flush=True)

    def skip(self, attack, why):
        print(f"skipped   {attack}: {why}", flush=True)

    def attack(self, name, *args, codes=(0, 1, 2), names=(), silent=False, **how):
        """Runs the program once and reports; returns the run."""
        run = self.run(*args, **how)
        self.report(name, run, self.faults(run, codes, names, silent))
        return run

    def is_whole(self, path):
        """Whether an image, a JSON file or a checkpoint is complete."""
        with open(path, "rb") as file:
            data = file.read()
        if path.endswith(".png"):
            return data[:8] == b"\x89PNG\r\n\x1a\n" and data[-8:-4] == b"IEND"
        if path.endswith(".pfm"):
            parts = data.split(b"\n", 3)
            width, height = map(int, parts[1].split())
            return len(parts[3]) == 12 * width * height
        if path.endswith(".json"):
            try:
                json.loads(data)
                return True
            except ValueError:
                return False
        if path.endswith(".exr"):
            return self.run("compare", path, path, "--no-flip").code == 0
        # merge --checkpoint keeps all of the state, so a part that is missing is found.
        return self.run("merge", path, "--output", self.path("whole", "merged.pfm"), "--quiet").code == 0

    def leftovers(self, folder):
        return sorted(name for name in os.listdir(folder) if ".tmp" in name)

    # The attacks

    def kills(self):
        """SIGKILL at random moments while files are written over old ones."""
        folder = self.path("kills", "")
        files = {kind: os.path.join(folder, "old." + kind) for kind in ("exr", "png", "pfm", "json", "state")}
        base = ["render", self.scene("cornell.json"), "--resolution", "96x72", "--quiet"]
        state = ["--checkpoint", files["state"], "--checkpoint-every", "0.01", "--stats", files["json"]]
        images = ["--output", files["exr"], files["png"], files["pfm"], "--progressive"]
        first = self.run(*base, "--spp", "2", *state, *images)
        if first.code != 0:
            self.report("kills: first render", first, ["fails"])
            return
        wrong, killed, samples = [], 0, 2
        for _ in range(50):
            samples += 1
            args = base + ["--spp", str(samples + 200), "--resume", files["state"]] + state + images
            started = self.start(args)
            time.sleep(self.random.uniform(0.0, 0.3))
            os.kill(started[0].pid, signal.SIGKILL)
            killed += self.finish(started).code == -signal.SIGKILL
            parts = [kind for kind, path in files.items() if not os.path.exists(path) or not self.is_whole(path)]
            if parts:
                wrong.append(f"{', '.join(parts)} not whole after a kill")
                break
        left = self.leftovers(folder)
        self.report("kills: 50 times SIGKILL while five files are written", None, wrong,
                    f"{killed} killed in time, {len(left)} temporary files left")
        again = self.run(*base, "--spp", "2", "--output", files["exr"], files["png"], files["pfm"])
        after = self.leftovers(folder)
        wrong = self.faults(again, (0,)) + ([f"{len(after)} temporary files of killed runs stay"] if after else [])
        self.report("kills: the next render in that folder", again, wrong)
        # The same at the moment of writing alone, of a larger file.
        path = os.path.join(folder, "large.exr")
        args = ["render", self.scene("cornell.json"), "--resolution", "400x300", "--spp", "1", "--output", path, "--quiet"]
        self.run(*args)
        usual = self.run(*args).seconds
        wrong = []
        for _ in range(10):
            started = self.start(args)
            time.sleep(usual * self.random.uniform(0.6, 1.0))
            os.kill(started[0].pid, signal.SIGKILL)
            self.finish(started)
            if not self.is_whole(path):
                wrong = ["image not whole"]
        self.report("kills: SIGKILL while a larger EXR is written", None, wrong, f"{len(self.leftovers(folder))} temporary files left")
        # A running render must keep its temporary files when another render in the folder ends.
        long = self.start(base + ["--time", "2", "--output", os.path.join(folder, "long.exr"), "--progressive"])
        wrong = []
        while not self.has_ended(long) and not wrong:
            other = self.run(*base, "--spp", "1", "--output", os.path.join(folder, "short.png"))
            wrong = self.faults(other, (0,))
        run = self.finish(long)
        self.report("kills: two renders in one folder at a time", run, wrong + self.faults(run, (0,)))

    def commands(self, folder, old=True):
        """The commands that write files, with their outputs in a folder: name, arguments, outputs."""
        cornell, path = self.scene("cornell.json"), lambda name: os.path.join(folder, name)
        small = ["--resolution", "200x150", "--spp", "1", "--quiet"]
        found = [(f"render {kind}", ["render", cornell, "--output", path("a." + kind)] + small, ["a." + kind])
                 for kind in ("exr", "png", "pfm")]
        aside = self.path("aside", "a.pfm")
        found.append(("render --stats", ["render", cornell, "--output", aside, "--stats", path("a.json")] + small, ["a.json"]))
        found.append(("render --checkpoint", ["render", cornell, "--checkpoint", path("a.state")] + small, []))
        found.append(("bake", ["bake", cornell, "--output", path("b"), "--resolution", "192", "--spp", "1", "--spacing", "20",
                               "--quiet"], ["b.exr", "b.obj", "b.ply", "b.json"]))
        mesh = os.path.join(self.scenes, "meshes", "teapot.obj")
        found.append(("convert", ["convert", mesh, path("c.json"), "--quiet"], ["c.json"]))
        found.append(("photons", ["photons", cornell, "--photons", "30000", "--output", path("p.csv"), path("p.ply"), "--quiet"],
                      ["p.csv", "p.ply"]))
        found.append(("lux", ["lux", cornell, "--plane", "10,10,10", "0,0,500", "500,0,0", "100x120", "--spp", "1",
                              "--output", path("l.csv"), path("l.json"), "--quiet"], ["l.csv", "l.json"]))
        state = self.path("aside", "whole.state")
        if not os.path.exists(state):
            self.run("render", cornell, "--checkpoint", state, *small)
        found.append(("merge", ["merge", state, "--output", path("m.exr"), "--checkpoint", path("m.state"), "--quiet"],
                      ["m.exr", "m.state"]))
        return found

    def full_disk(self):
        """Folders that are full, or have no room for another file."""
        for size in ("64k", "256k", "1m", "inodes"):
            options = "size=4m,nr_inodes=16" if size == "inodes" else f"size={size}"
            folder = self.mount("small-" + size, options)
            if folder is None:
                self.skip(f"full disk of {size}", "mounting needs root")
                continue
            for name, args, outputs in self.commands(folder):
                for entry in os.listdir(folder):
                    whole = os.path.join(folder, entry)
                    shutil.rmtree(whole) if os.path.isdir(whole) else os.remove(whole)
                for output in outputs:
                    with open(os.path.join(folder, output), "wb") as file:
                        file.write(b"old " + output.encode())
                if size == "inodes":
                    number = 0
                    try:
                        while True:
                            open(os.path.join(folder, f"fill{number}"), "x").close()
                            number += 1
                    except OSError:
                        pass
                elif name in ("render --stats", "render png", "convert"):
                    # Small outputs: nothing at all is left for them.
                    with open(os.path.join(folder, "fill"), "wb", buffering=0) as file:
                        try:
                            while True:
                                file.write(bytes(4096))
                        except OSError:
                            pass
                run = self.run(*args)
                wrong = self.faults(run, (0, 1, 2), [os.path.basename(folder.rstrip("/"))])
                for output in outputs:
                    whole = os.path.join(folder, output)
                    if not os.path.exists(whole):
                        wrong.append(f"{output} is gone")
                        continue
                    with open(whole, "rb") as file:
                        head = file.read(64)
                    if run.code != 0 and head != b"old " + output.encode() and output == outputs[0] and len(outputs) == 1:
                        wrong.append(f"{output} has changed")
                    if head != b"old " + output.encode() and output.split(".")[1] in ("exr", "png", "pfm", "json", "state") and not self.is_whole(whole):
                        wrong.append(f"{output} is a part")
                wrong += [f"leaves {left}" for left in self.leftovers(folder)]
                if name == "convert" and run.code != 0:
                    wrong += [f"leaves {entry} in c.files" for entry in self.inside(folder, "c.files")]
                self.report(f"full disk of {size}: {name}", run, wrong)
            self.unmount(folder)

    @staticmethod
    def inside(folder, name):
        whole = os.path.join(folder, name)
        return sorted(os.listdir(whole)) if os.path.isdir(whole) else []

    def places(self):
        """Outputs at places where nothing can be written."""
        folder = self.mount("fixed", "size=1m")
        if folder is None:
            self.skip("read-only folder", "mounting needs root")
        else:
            subprocess.run(["mount", "-o", "remount,ro", folder], check=False)
            for name, args, _ in self.commands(folder):
                self.attack(f"read-only folder: {name}", *args, codes=(2,), names=["fixed"])
            self.unmount(folder)
        missing = os.path.join(self.root, "missing", "deeper")
        for name, args, _ in self.commands(missing):
            self.attack(f"missing folder: {name}", *args, codes=(2,), names=["missing"])
        folder = self.path("taken", "")
        for name, args, outputs in self.commands(folder):
            for output in outputs or ["a.state"]:
                os.makedirs(os.path.join(folder, output, "inner"), exist_ok=True)
            self.attack(f"a folder has the name: {name}", *args, codes=(2,), names=["taken"])
        below = self.write("plain", "x")
        for name, args, _ in self.commands(below):
            self.attack(f"a file in place of the folder: {name}", *args, codes=(2,), names=["plain"])
        cornell = ["render", self.scene("cornell.json"), "--resolution", "16x12", "--spp", "1", "--quiet"]
        for device in ("/dev/full", "/dev/null", "/dev/zero", "/proc/self/mem"):
            self.attack(f"{device} as image", *cornell, "--output", device, codes=(2,), names=[device])
            self.attack(f"{device} as --stats", *cornell, "--output", self.path("aside", "d.png"), "--stats", device, codes=(2,), names=[device])
            self.attack(f"{device} as --checkpoint", *cornell, "--checkpoint", device, codes=(2,), names=[device])
            link = self.path("links", os.path.basename(device) + ".png")
            os.symlink(device, link)
            self.attack(f"a link to {device} as image", *cornell, "--output", link, codes=(2,), names=[link])
        os.mkfifo(self.path("links", "fifo.png"))
        self.attack("a FIFO as image", *cornell, "--output", self.path("links", "fifo.png"), codes=(2,), names=["fifo.png"])
        link = self.path("links", "round.png")
        os.symlink(link, link)
        self.attack("a link to itself as image", *cornell, "--output", link, names=["round.png"])
        self.path("links", "far", "")
        link, target = self.path("links", "new.png"), self.path("links", "far", "new.png")
        os.symlink(target, link)
        run = self.run(*cornell, "--output", link)
        wrong = self.faults(run, (0,))
        if not os.path.islink(link):
            wrong.append("the link to a file that is to be made is replaced, not followed")
        self.report("a link to a missing file as image", run, wrong)
        name = "n" * 300 + ".png"
        self.attack("a name of 300 characters", *cornell, "--output", self.path("links", name), codes=(2,), names=["nnn"])
        self.attack("a path of 5000 characters", *cornell, "--output", "/".join(["d" * 99] * 50) + ".png", codes=(2,))
        run = self.run(*cornell, "--output", os.fsencode(self.path("links", "")).decode() + "\udcff.png")
        self.report("a name that is not UTF-8", run, self.faults(run, (0, 2)))
        for where in ("/proc/x.png", "/sys/x.png", "/dev/fd/x.png"):
            self.attack(f"image at {where}", *cornell, "--output", where, codes=(2,), names=[where])
        inputs = self.path("inputs", "teapot.obj")
        shutil.copy(os.path.join(self.scenes, "meshes", "teapot.obj"), inputs)
        before = open(inputs, "rb").read()
        scene = self.native("inputs/own.json", [{"geometry": "mesh", "file": "teapot.obj", "material": "grey"}])
        run = self.run("bake", scene, "--output", self.path("inputs", "teapot"), "--resolution", "32", "--spp", "1")
        wrong = self.faults(run, (2,), ["teapot.obj"])
        if open(inputs, "rb").read() != before:
            wrong.append("the mesh is written over")
        self.report("an output over a mesh that is read", run, wrong)

    def closed(self):
        """Standard output and error that are closed, full, or read no more."""
        cornell = self.scene("cornell.json")
        image = self.path("closed", "a.png")
        render = ["render", cornell, "--resolution", "64x48", "--spp", "4", "--output", image]
        for name, args, codes in (("info", ["info", cornell], (0,)), ("render", render, (0,)), ("compare", ["compare", image, image], (0,)),
                                  ("help", ["--help"], (0,)), ("bad usage", ["render"], (2,)), ("missing scene", ["info", "none.json"], (2,))):
            for which in ("stdout", "stderr"):
                reading, writing = os.pipe()
                os.close(reading)
                run = self.run(*args, **{which: writing})
                os.close(writing)
                self.report(f"{which} without a reader: {name}", run, self.faults(run, codes, silent=True))
            with open("/dev/full", "wb", buffering=0) as full:
                run = self.run(*args, stdout=full)
                wrong = self.faults(run, tuple(set(codes) | {1}))
                if name in ("info", "compare", "help") and run.code == 0:
                    wrong.append("exit code 0 although nothing could be written")
                self.report(f"stdout on /dev/full: {name}", run, wrong)
                run = self.run(*args, stderr=full)
                self.report(f"stderr on /dev/full: {name}", run, self.faults(run, codes, silent=True))
            for closing in (">&-", "2>&-", "<&- >&- 2>&-"):
                line = " ".join("'" + str(part).replace("'", "'\\''") + "'" for part in [self.binary] + args)
                began = time.monotonic()
                done = subprocess.run(["sh", "-c", f"exec {line} {closing}"], capture_output=True, timeout=60)
                run = Run(done.returncode, "", done.stderr.decode("utf-8", "replace"), time.monotonic() - began, 0, False, False)
                allowed = codes if closing != ">&-" else tuple(set(codes) | {1})
                self.report(f"closed with {closing}: {name}", run, self.faults(run, allowed, silent=True))
        if os.path.exists(image):
            self.report("the image after these renders", None, [] if self.is_whole(image) else ["is not whole"])

    def signals(self):
        """Signals while a scene is read and built, while photons are traced, and while samples are taken."""
        big = self.big_mesh()
        image = self.path("signals", "a.exr")
        out = ["--output", image, "--quiet"]
        cornell, room = self.scene("cornell.json"), self.scene("caustic-room.json")
        phases = [
            ("reading and building", ["render", big, "--spp", "1", "--resolution", "32x24"] + out, (0.05, 1.5), 8),
            ("building an acceleration structure", ["render", self.scene("million.json"), "--spp", "1", "--resolution", "32x24"] + out, (0.02, 1.2), 8),
            ("info", ["info", self.scene("million.json")], (0.02, 1.0), 4),
            ("photon maps", ["render", room, "--integrator", "photon", "--photons", "20000000", "--caustic-photons", "20000000", "--spp", "1"] + out, (0.1, 1.5), 4),
            ("progressive photon maps", ["render", room, "--integrator", "sppm", "--photons", "3000000", "--spp", "999"] + out, (0.1, 2.0), 4),
            ("irradiance cache", ["render", cornell, "--integrator", "irradiance_cache", "--resolution", "1024x1024"] + out, (0.1, 1.0), 2),
            ("radiosity", ["render", cornell, "--integrator", "radiosity", "--element-size", "2", "--spp", "4"] + out, (0.1, 1.0), 4),
            ("sampling", ["render", cornell, "--spp", "99999", "--checkpoint", self.path("signals", "s.state")] + out, (0.1, 1.0), 6),
            ("wavelengths in layers", ["render", cornell, "--spp", "8", "--spectral", "--spectral-layers", "60"] + out, (0.2, 1.5), 2),
            ("bake", ["bake", cornell, "--output", self.path("signals", "b"), "--spp", "9999", "--quiet"], (0.1, 1.0), 3),
            ("bake by radiosity", ["bake", cornell, "--method", "radiosity", "--resolution", "1024", "--output", self.path("signals", "r"), "--quiet"], (0.1, 1.0), 3),
            ("lux", ["lux", cornell, "--plane", "10,10,10", "0,0,500", "500,0,0", "40x40", "--spp", "999999", "--output", self.path("signals", "l.csv")], (0.1, 1.0), 2),
            ("photons", ["photons", room, "--photons", "9000000", "--output", self.path("signals", "p.csv")], (0.1, 1.0), 3),
            ("bench", ["bench", cornell, "--output", self.path("signals", "bench"), "--runs", "2", "--spp", "64"], (0.1, 1.0), 2),
        ]
        kinds = [signal.SIGTERM, signal.SIGHUP, signal.SIGINT]
        for name, args, (first, last), times in phases:
            wrong, codes, slowest, run = [], [], 0.0, None
            for number in range(times):
                kind = kinds[number % 3]
                state = self.path("signals", "s.state")
                if os.path.exists(state):
                    os.remove(state)
                started = self.start(args)
                time.sleep(first + (last - first) * self.random.random())
                # A run that has ended already has no signal to obey.
                if self.has_ended(started):
                    run = self.finish(started)
                    codes.append(run.code)
                    wrong += self.faults(run, (0,))
                    continue
                os.kill(started[0].pid, kind)
                run = self.finish(started, timeout=15, most=6144 * MIB)
                codes.append(run.code)
                slowest = max(slowest, run.seconds)
                # A command that writes nothing may leave a signal to the system.
                if run.code != -kind or name != "info":
                    wrong += [f"{signal.Signals(kind).name}: {fault}" for fault in self.faults(run, (0, 130))]
                if run.seconds > 5:
                    wrong.append(f"{signal.Signals(kind).name}: ends only after {run.seconds:.1f} s")
                if os.path.exists(image) and not self.is_whole(image):
                    wrong.append("image not whole")
            left = self.leftovers(os.path.dirname(image))
            for entry in left:
                os.remove(os.path.join(os.path.dirname(image), entry))
            if left:
                wrong.append(f"leaves {len(left)} temporary files")
            self.report(f"signals: {name}", run, list(dict.fromkeys(wrong)), f"codes {codes}, slowest end {slowest:.2f} s")
        # Two signals at once, many times: the second ends the program while threads are at work.
        wrong, codes = [], []
        for _ in range(20):
            started = self.start(["render", cornell, "--spp", "99999"] + out)
            time.sleep(self.random.uniform(0.0, 0.3))
            os.kill(started[0].pid, signal.SIGTERM)
            time.sleep(self.random.uniform(0.0, 0.02))
            os.kill(started[0].pid, signal.SIGINT)
            run = self.finish(started, timeout=15)
            codes.append(run.code)
            if run.code not in (130, -signal.SIGTERM, -signal.SIGINT):
                wrong.append(f"ends with {run.code}")
        early = sum(code < 0 for code in codes)
        self.report("signals: two at a time, 20 times", None, wrong, f"{codes.count(130)} with code 130, {early} before handlers were there")

    def big_mesh(self):
        """A mesh of 1.1 million triangles."""
        path = self.path("big", "big.obj")
        if not os.path.exists(path):
            side = 740
            rows = [f"v {i / side:.4f} {j / side:.4f} {0.05 * math.sin(i * 0.1) * math.cos(j * 0.13):.4f}\n"
                    for i in range(side + 1) for j in range(side + 1)]
            for i in range(side):
                for j in range(side):
                    a = i * (side + 1) + j + 1
                    rows.append(f"f {a} {a + 1} {a + side + 1}\nf {a + 1} {a + side + 2} {a + side + 1}\n")
            with open(path, "w") as file:
                file.writelines(rows)
        return path

    def limits(self):
        """Little memory, few files, small stacks and few threads; and jobs that are too large."""
        big = self.big_mesh()
        cornell, room = self.scene("cornell.json"), self.scene("caustic-room.json")
        out = ["--output", self.path("limits", "a.exr"), "--quiet"]
        lamp = self.native("limits/lamp.json", [{"geometry": "mesh", "file": big, "material": "grey", "emission": [1, 2, 3]}])
        radiosity = ["render", cornell, "--integrator", "radiosity", "--spp", "1", "--resolution", "32x24"] + out
        jobs = [
            ("a mesh of a million triangles", ["info", big]),
            ("million.json", ["render", self.scene("million.json"), "--spp", "1", "--resolution", "32x24"] + out),
            ("20000 x 20000 pixels", ["render", cornell, "--spp", "1", "--resolution", "20000x20000"] + out),
            ("8192 x 8192 pixels", ["render", cornell, "--time", "0.01", "--resolution", "8192x8192"] + out),
            ("4000 x 4000 pixels", ["render", cornell, "--time", "0.01", "--resolution", "4000x4000"] + out),
            ("2^29 photons", ["render", room, "--integrator", "photon", "--photons", str(1 << 29), "--spp", "1", "--resolution", "32x24"] + out),
            ("50 million photons, sppm", ["render", room, "--integrator", "sppm", "--photons", "50000000", "--spp", "1", "--resolution", "32x24"] + out),
            ("photons 2^29", ["photons", cornell, "--photons", str(1 << 29), "--output", self.path("limits", "p.ply")]),
            ("radiosity, elements of 0.01", radiosity + ["--element-size", "0.01", "--radiosity-error", "0.000001"]),
            ("bake 8192", ["bake", cornell, "--output", self.path("limits", "b"), "--resolution", "8192", "--spp", "1", "--quiet"]),
            ("bake, tiny spacing", ["bake", cornell, "--output", self.path("limits", "b"), "--only", "vertices", "--spacing", "0.01", "--spp", "1", "--quiet"]),
            ("lux 100000 x 100000", ["lux", cornell, "--plane", "1,1,1", "0,0,5", "5,0,0", "100000x100000", "--spp", "1"]),
        ]
        for size in (300, 500, 1000):
            for name, args in jobs:
                # Under a limit of memory, a job of much work is only watched until it has had time to fail.
                run = self.run(*args, limits=[(resource.RLIMIT_AS, size * MIB)], timeout=4)
                if run.hung:
                    self.report(f"{size} MB of memory: {name}", run, [], "still at work after 4 s, ended")
                    continue
                self.report(f"{size} MB of memory: {name}", run, self.faults(run, (0, 1, 2)))
        wrong = []
        for size in range(186, 212, 2):
            # Little is missing here: a thread cannot be started, or a small table does not fit.
            run = self.run("info", cornell, limits=[(resource.RLIMIT_AS, size * MIB)], timeout=3)
            wrong += [f"{size} MB: {fault}" for fault in self.faults(run)]
        self.report("186 to 210 MB of memory: cornell.json", None, wrong)
        for size, name, args in (
                (280, "lux 500 x 500", ["lux", cornell, "--plane", "10,10,10", "0,0,500", "500,0,0", "500x500", "--spp", "1", "--quiet"]),
                (400, "lux 500 x 500", ["lux", cornell, "--plane", "10,10,10", "0,0,500", "500,0,0", "500x500", "--spp", "1", "--quiet"]),
                (480, "700 x 700 pixels", ["render", room, "--resolution", "700x700", "--spp", "1", "--light-paths"] + out),
                (340, "a million photons", ["render", room, "--integrator", "photon", "--photons", "1000000", "--spp", "1", "--resolution", "32x24"] + out),
                (360, "convert a large mesh", ["convert", big, self.path("limits", "c.json"), "--quiet"]),
                (200, "a mesh of a million triangles", ["info", big]),
                (600, "a lamp of a million triangles", ["info", lamp]),
                (360, "two million photons", ["photons", cornell, "--photons", "2000000", "--output", self.path("limits", "p.ply"), "--quiet"]),
                (1060, "1500 x 1500 pixels", ["render", room, "--resolution", "1500x1500", "--time", "1", "--light-paths"] + out),
                (300, "lux 500 x 500 to a file", ["lux", cornell, "--plane", "10,10,10", "0,0,500", "500,0,0", "500x500", "--spp", "1", "--quiet",
                                                  "--output", self.path("limits", "l.json")])):
            self.attack(f"{size} MB of memory: {name}", *args, limits=[(resource.RLIMIT_AS, size * MIB)], timeout=6)
        for size in (16, 40, 60, 80, 100):
            self.attack(f"{size} MB of memory: cornell.json", "render", cornell, "--resolution", "32x24", "--spp", "1", *out,
                        limits=[(resource.RLIMIT_AS, size * MIB)], codes=(0, 1, 2, 127))
        small = ["render", cornell, "--resolution", "32x24", "--spp", "1"] + out
        for size in (128, 256, 1024):
            self.attack(f"a stack of {size} KiB", *small, limits=[(resource.RLIMIT_STACK, size * 1024)], codes=(0, 1, 2))
            deep = self.write("limits/deep.json", "[" * 100000)
            self.attack(f"a stack of {size} KiB: deep nesting", "info", deep, limits=[(resource.RLIMIT_STACK, size * 1024)], codes=(2,), names=["deep.json"])
        textures = self.scene("textures.json")
        for number in (16, 10, 8, 7, 6, 5, 4, 3):
            self.attack(f"{number} open files", "render", textures, "--resolution", "32x24", "--spp", "1", *out,
                        limits=[(resource.RLIMIT_NOFILE, number)], codes=(0, 1, 2, 127))
        self.attack("files of 1000 bytes at most", *small, limits=[(resource.RLIMIT_FSIZE, 1000)], codes=(1, 2), names=["a.exr"])
        if IS_ROOT:
            os.chmod(self.root, 0o755)
            os.chmod(self.path("limits", ""), 0o777)
            copy = self.path("limits", "program")
            shutil.copy(self.binary, copy)
            public = self.path("limits", "cornell.json")
            shutil.copy(cornell, public)
            os.chmod(copy, 0o755)
            own, self.binary = self.binary, copy
            for number in (1, 2, 3):
                output = self.path("limits", f"user{number}.png")
                self.attack(f"{number} processes and threads", "render", public, "--resolution", "32x24", "--spp", "1", "--threads", "8",
                            "--output", output, user=65533, limits=[(resource.RLIMIT_NPROC, number)], codes=(0, 1, 2))
                self.attack(f"{number} processes and threads: info", "info", public, user=65533, timeout=6,
                            limits=[(resource.RLIMIT_NPROC, number)], codes=(0, 1, 2))
            self.binary = own
        else:
            self.skip("few threads", "needs root to become another user")
        for number in ("100000", "1000000", "18446744073709551615"):
            self.attack(f"--threads {number}", *small, "--threads", number, codes=(0, 1, 2))

    def large(self):
        """Scenes and meshes that are very large or deeply nested."""
        head = '{"etendue":1,"camera":{"origin":[0,1,5]},"surfaces":['
        shapes = {
            "blanks": (b"", b" " * MIB, b""),
            "an array of numbers": (b"[1", b",1234567" * (MIB // 8), b"]"),
            "a string": (b'"', b"x" * MIB, b'"'),
            "numbers in a scene": (head.encode() + b"1", b",1234567" * (MIB // 8), b"]}"),
            "objects in a scene": (head.encode() + b"{}", b",{}" * (MIB // 3), b"]}"),
            "positions of a mesh": (head.encode() + b'{"geometry":"mesh","triangles":[[0,1,2]],"positions":[[0,0,1]', b",[1,2,3]" * (MIB // 8), b"]}]}"),
            "one number": (b"", b"1" * MIB, b""),
            "a description": (b'{"etendue":1,"description":"', b"x" * MIB, b'","camera":{"origin":[0,1,5]}}'),
            "an unknown key": (b'{"etendue":1,"' , b"k" * MIB, b'":1}'),
            "the name of a material": (head.encode() + b'{"geometry":"sphere","radius":1,"material":"', b"m" * MIB, b'"}]}'),
            "key after key": (b'{"etendue":1', b',"ab":1' * (MIB // 7), b"}"),
        }
        for name, (first, middle, last) in shapes.items():
            for size in (1024, 300):
                path = self.path("large", "large.json")
                with open(path, "wb") as file:
                    file.write(first)
                    if size == 1024:
                        # Over the limit on the size: the file is refused before it is read, and may have holes.
                        file.truncate(1024 * MIB)
                    else:
                        for _ in range(size):
                            file.write(middle)
                        file.write(last)
                codes = (0, 2) if name == "a description" and size == 300 else (2,)
                self.attack(f"{size} MiB of {name}", "info", path, codes=codes, names=["large.json"] if codes == (2,) else [], most=6144 * MIB, timeout=25)
                os.remove(path)
        for depth in (10**5, 10**6):
            for name, text in (("arrays", "[" * depth + "]" * depth), ("objects", '{"a":' * depth + "1" + "}" * depth),
                               ("open arrays", "[" * depth),
                               ("arrays in a known key", head + "[" * depth + "]" * depth + "]}"),
                               ("arrays in an unknown key", '{"etendue":1,"x":' + "[" * depth + "]" * depth + "}"),
                               ("objects in the camera", '{"etendue":1,"camera":' + '{"origin":' * depth + "1" + "}" * depth + "}"),
                               ("arrays in a scene of the report", '{"surfaces":' + "[" * depth + "]" * depth + "}")):
                path = self.write("large/deep.json", text)
                self.attack(f"{depth} levels of {name}", "info", path, codes=(2,), names=["deep.json"])
            path = self.write("large/deep.gltf", '{"asset":{"version":"2.0"},"extras":' + "[" * depth + "]" * depth + "}")
            self.attack(f"{depth} levels in a glTF file", "info", path, codes=(0, 2), names=["deep.gltf"])
            nodes = ",".join('{"children":[%d]}' % (i + 1) for i in range(depth - 1)) + ",{}"
            path = self.write("large/chain.gltf", '{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[' + nodes + "]}")
            self.attack(f"{depth} nodes in a chain of glTF", "info", path, codes=(0, 2), names=["chain.gltf"])
            data = ('{"asset":{"version":"2.0"},"x":' + "[" * depth + "]" * depth + "}").encode()
            data += b" " * (-len(data) % 4)
            path = self.write("large/deep.glb", b"glTF" + struct.pack("<III", 2, 20 + len(data), len(data)) + b"JSON" + data)
            self.attack(f"{depth} levels in a GLB file", "info", path, codes=(0, 2), names=["deep.glb"])
        loop = '{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"children":[1]},{"children":[0]}]}'
        self.attack("nodes of glTF in a ring", "info", self.write("large/ring.gltf", loop), codes=(2,), names=["ring.gltf"])
        # Each node has the next one as a child twice: 2^40 nodes in all.
        nodes = ",".join('{"children":[%d,%d]}' % (i + 1, i + 1) for i in range(40)) + ",{}"
        twice = '{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[' + nodes + "]}"
        self.attack("nodes of glTF that are shared over and over", "info", self.write("large/twice.gltf", twice), codes=(2,), names=["twice.gltf"])
        accessor = ('{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],'
                    '"accessors":[{"componentType":5126,"count":%d,"type":"VEC3"}]}')
        for count in (3 * 10**9, 2**63, 10**30):
            self.attack(f"a glTF accessor of {count} zeros", "info", self.write("large/zeros.gltf", accessor % count), codes=(2,), names=["zeros.gltf"])
        meshes = {
            "PLY of 4e9 vertices.ply": "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n",
            "binary PLY of 4e9 vertices.ply": "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n0000",
            "PLY of 2^64 faces.ply": "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nelement face 18446744073709551615\nproperty list uchar int vertex_indices\nend_header\n",
            "PLY of 1e18 empty elements.ply": "ply\nformat binary_little_endian 1.0\nelement nothing 1000000000000000000\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
            "PLY with a list of 4e9.ply": b"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uint int vertex_indices\nend_header\n" + bytes(12) + b"\xff\xff\xff\xff\0\0\0\0",
            "PLY with an endless header.ply": "ply\nformat ascii 1.0\n" + "comment x\n" * 2_000_000,
            "PLY with 1e5 properties.ply": "ply\nformat ascii 1.0\nelement vertex 1\n" + "".join(f"property float p{i}\n" for i in range(100000)) + "end_header\n",
            "PLY with 1e6 elements.ply": "ply\nformat ascii 1.0\n" + "".join(f"element e{i} 0\n" for i in range(1000000)) + "end_header\n",
            "STL of 2^32 triangles.stl": bytes(80) + b"\xff\xff\xff\xff" + bytes(50),
            "OBJ of one line.obj": "v " + "1 " * 20_000_000,
            "OBJ of a face with 3e6 corners.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nf " + "1 2 3 " * 1_000_000 + "\n",
            "OBJ of groups.obj": "".join(f"g {i}\nusemtl {i}\n" for i in range(300000)) + "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
            "OBJ with a huge index.obj": "v 0 0 0\nf 1 2 99999999999999999999999\n",
            "OBJ with continued lines.obj": "v 0 0 0 \\\n" * 1_000_000,
        }
        for name, data in meshes.items():
            self.attack(name.rsplit(".", 1)[0], "info", self.write("large/" + name, data), codes=(0, 2), names=[name])

        def chunk(kind, data):
            return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

        def png(width, height, data, kind=2):
            head = struct.pack(">IIBBBBB", width, height, 8, kind, 0, 0, 0)
            return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", data) + chunk(b"IEND", b"")

        def exr(right, bottom, tail=b""):
            box = struct.pack("<iiii", 0, 0, right, bottom)
            attribute = lambda name, kind, data: name + b"\0" + kind + b"\0" + struct.pack("<i", len(data)) + data
            channel = b"".join(c + b"\0" + struct.pack("<iBBBBii", 2, 0, 0, 0, 0, 1, 1) for c in (b"B", b"G", b"R")) + b"\0"
            return (b"\x76\x2f\x31\x01\x02\0\0\0" + attribute(b"channels", b"chlist", channel) + attribute(b"compression", b"compression", b"\0")
                    + attribute(b"dataWindow", b"box2i", box) + attribute(b"displayWindow", b"box2i", box) + attribute(b"lineOrder", b"lineOrder", b"\0")
                    + attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1)) + attribute(b"screenWindowCenter", b"v2f", bytes(8))
                    + attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)) + b"\0" + tail)

        pictures = {
            "PNG of 2^31 x 2^31.png": png(0x7FFFFFFF, 0x7FFFFFFF, zlib.compress(b"\0")),
            "PNG of 60000 x 60000.png": png(60000, 60000, zlib.compress(bytes(100 * MIB // 10), 9)),
            "PNG of 16384 x 16384 that is there.png": png(16384, 16384, zlib.compress(bytes((16384 + 1) * 16384), 1), 0),
            "PNG without data.png": png(16, 16, b""),
            "EXR of 2^31 x 2^31.exr": exr(0x7FFFFFFE, 0x7FFFFFFE),
            "EXR of 30000 x 30000.exr": exr(29999, 29999, bytes(64)),
            "EXR of negative size.exr": exr(-2147483648, -2147483648),
            "EXR of a corner at the end.exr": exr(0x7FFFFFFF, 0),
            "PFM of 1e9 x 1e9.pfm": "PF\n1000000000 1000000000\n-1.0\n0000",
            "PFM of 60000 x 60000.pfm": "PF\n60000 60000\n-1.0\n0000",
            "PFM of negative size.pfm": "PF\n-4 -4\n-1.0\n0000",
            "HDR of 1e9 x 1e9.hdr": "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1000000000 +X 1000000000\n0000",
            "HDR of 30000 x 30000.hdr": "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 30000 +X 30000\n0000",
        }
        for name, data in pictures.items():
            self.write("large/" + name, data)
            scene = self.textured("large/textured.json", name)
            self.attack("texture: " + name, "info", scene, codes=(0, 2), names=[name], most=4096 * MIB)
            path = self.path("large", name)
            if not name.endswith(".hdr"):
                self.attack("compare: " + name, "compare", path, path, "--no-flip", names=[name], limits=[(resource.RLIMIT_AS, 3072 * MIB)], most=4096 * MIB)

    def textured(self, name, file):
        """A scene with a texture of a file."""
        quad = {"geometry": "quad", "vertex-1": [-1, 0, 0], "vertex-2": [1, 0, 0], "vertex-3": [1, 2, 0], "vertex-4": [-1, 2, 0], "material": "map"}
        return self.native(name, [quad], textures=[{"name": "t", "type": "image", "file": file}],
                           materials=[{"name": "map", "type": "diffuse", "color": [1, 1, 1], "textures": {"color": "t"}}])

    def odd_files(self):
        """Things that are not regular files, or are empty, in every place where a file is read."""
        self.path("odd", "")
        things = {"zero": "/dev/zero", "urandom": "/dev/urandom", "null": "/dev/null", "full": "/dev/full", "mem": "/proc/self/mem"}
        plain = self.native("odd/plain.json")
        image = self.path("odd", "plain.png")
        self.run("render", plain, "--output", image, "--quiet")
        report = self.write("odd/report.json", json.dumps({"camera": {"origin": [0, 0, 0], "lookAt": [0, 0, 1], "up": [0, 1, 0]}, "lights": [],
                                                           "materials": [], "surfaces": []}))
        for kind in list(things) + ["fifo", "folder", "empty", "socketless", "loop"]:
            def make(extension):
                path = self.path("odd", f"{kind}.{extension}")
                if not os.path.lexists(path):
                    if kind == "fifo":
                        os.mkfifo(path)
                    elif kind == "folder":
                        os.mkdir(path)
                    elif kind == "empty":
                        open(path, "w").close()
                    elif kind == "loop":
                        os.symlink(path, path)
                    elif kind != "socketless":
                        os.symlink(things[kind], path)
                return path

            for extension in ("json", "gltf", "glb", "obj", "ply", "stl"):
                self.attack(f"{kind} as a scene .{extension}", "info", make(extension), codes=(2,), timeout=5, most=1024 * MIB, names=[f"{kind}.{extension}"])
            for extension in ("obj", "ply", "stl"):
                scene = self.native("odd/mesh.json", [{"geometry": "mesh", "file": f"{kind}.{extension}", "material": "grey"}])
                make(extension)
                self.attack(f"{kind} as a mesh .{extension}", "info", scene, codes=(2,), timeout=5, most=1024 * MIB, names=[f"{kind}.{extension}"])
            for extension in ("png", "exr", "pfm", "hdr", "jpg"):
                make(extension)
                scene = self.textured("odd/texture.json", f"{kind}.{extension}")
                self.attack(f"{kind} as a texture .{extension}", "info", scene, codes=(2,), timeout=5, most=1024 * MIB, names=[f"{kind}.{extension}"])
            make("spd")
            scene = self.native("odd/spectrum.json", lights=[{"type": "point", "origin": [0, 3, 0], "spectrum": {"file": f"{kind}.spd"}}])
            self.attack(f"{kind} as a spectrum", "info", scene, codes=(2,), timeout=5, most=1024 * MIB, names=[f"{kind}.spd"])
            make("ies")
            scene = self.native("odd/web.json", lights=[{"type": "web", "origin": [0, 3, 0], "direction": [0, -1, 0], "file": f"{kind}.ies"}])
            self.attack(f"{kind} as a photometric web", "info", scene, codes=(2,), timeout=5, most=1024 * MIB)
            make("mtl")
            mesh = self.write("odd/own.obj", f"mtllib {kind}.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n")
            self.attack(f"{kind} as materials of a mesh", "info", mesh, codes=(0, 2), timeout=5, most=1024 * MIB)
            make("bin")
            document = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], "buffers": [{"uri": f"{kind}.bin", "byteLength": 36}],
                        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
                        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]}]}
            scene = self.write("odd/buffer.gltf", json.dumps(document))
            self.attack(f"{kind} as a buffer of glTF", "info", scene, codes=(2,), names=["buffer"], timeout=5, most=1024 * MIB)
            self.attack(f"{kind} as results of a benchmark", "bench", "--report-only", make("json"), "--output", self.path("odd", "bench"),
                        codes=(2,), timeout=5, most=1024 * MIB)
            self.attack(f"{kind} as parameters", "info", report, make("json"), codes=(2,), timeout=5, most=1024 * MIB)
            self.attack(f"{kind} as a checkpoint", "render", plain, "--resume", make("state"), "--output", self.path("odd", "x.png"), codes=(2,), timeout=5, most=1024 * MIB, names=[f"{kind}.state"])
            self.attack(f"{kind} as a part", "merge", make("state"), "--output", self.path("odd", "x.png"), codes=(2,), timeout=5, most=1024 * MIB, names=[f"{kind}.state"])
            self.attack(f"{kind} as a picture to compare", "compare", image, make("png"), codes=(2,), timeout=5, most=1024 * MIB, names=[f"{kind}.png"])
            self.attack(f"{kind} as grids", "lux", plain, "--grid", make("json"), codes=(2,), timeout=5, most=1024 * MIB, names=[f"{kind}.json"])
            self.attack(f"{kind} as a suite", "bench", "--suite", make("json"), "--output", self.path("odd", "bench"), codes=(2,), timeout=5, most=1024 * MIB, names=[f"{kind}.json"])

        folder = self.path("odd", "references", "")
        os.mkfifo(os.path.join(folder, "cornell-8x8.exr"))
        os.mkfifo(self.path("odd", "tables.md"))
        self.write("odd/tilted.ies", "IESNA:LM-63-2002\nTILT=tilt.tlt\n1 1000 1 2 1 1 2 0 0 0\n1 1 100\n0 90\n0\n100 50\n")
        os.mkfifo(self.path("odd", "tilt.tlt"))
        scene = self.native("odd/tilted.json", lights=[{"type": "web", "origin": [0, 3, 0], "direction": [0, -1, 0], "file": "tilted.ies"}])
        self.attack("fifo as the tilt of a lamp", "info", scene, codes=(2,), timeout=5)
        bench = ["bench", self.scene("cornell.json"), "--output", self.path("odd", "bench"), "--spp", "1", "--runs", "1", "--resolution", "8x8"]
        self.attack("fifo as a reference picture", *bench, "--references", folder, codes=(1, 2), timeout=5)
        self.attack("fifo as a file of tables", *bench, "--tables", self.path("odd", "tables.md"), codes=(1, 2), timeout=5)

    NUMBER = re.compile(rb"-?\d+\.?\d*(?:[eE][-+]?\d+)?")
    NUMBERS = [b"0", b"-0", b"-1", b"1e300", b"-1e300", b"3.4e38", b"3.5e38", b"1e38", b"1e-45", b"1e-300", b"NaN", b"nan", b"Infinity", b"-inf",
               b"null", b"1e999", b"99999999999999999999", b"4294967296", b"2147483648", b"-2147483649", b"18446744073709551615", b"0.5", b"1e18",
               b"1e19", b"1e10", b"1e-10", b"\"x\"", b"[]", b"{}", b"true"]

    def damage(self, data, is_text):
        """A damaged copy of the bytes of a file."""
        data = bytearray(data)
        pick = self.random
        for _ in range(pick.choice((1, 1, 1, 2, 5))):
            kind = pick.randrange(12 if is_text else 5)
            at = pick.randrange(len(data)) if data else 0
            length = min(pick.choice((1, 4, 16, 64, 300)), len(data))
            if kind == 0 and data:
                data[at] ^= 1 << pick.randrange(8)
            elif kind == 1 and data:
                data[at] = pick.randrange(256)
            elif kind == 2 and pick.random() < 0.5:
                del data[at:]
            elif kind == 3:
                data[at:at] = data[at:at + length]
            elif kind == 4:
                del data[at:at + length]
            else:
                spots = list(self.NUMBER.finditer(data))
                if spots:
                    spot = pick.choice(spots)
                    data[spot.start():spot.end()] = pick.choice(self.NUMBERS)
        return bytes(data)

    def damaged(self):
        """Scenes, meshes and other files with random damage."""
        folder = self.path("damaged", "")
        for name in ("meshes", "textures"):
            if os.path.isdir(self.scene(name)):
                os.symlink(self.scene(name), os.path.join(folder, name))
        scenes = sorted(name for name in os.listdir(self.scenes) if name.endswith(".json"))
        scenes = [name for name in scenes if name not in ("million.json", "thousand-lights.json")]
        mesh = os.path.join(self.scenes, "meshes", "teapot-coarse.obj")
        plain = self.native("damaged/plain.json")
        state = os.path.join(folder, "plain.state")
        pictures = [os.path.join(folder, "plain." + kind) for kind in ("exr", "png", "pfm")]
        self.run("render", plain, "--checkpoint", state, "--output", *pictures, "--quiet")
        bake = os.path.join(folder, "baked")
        self.run("bake", self.scene("cornell.json"), "--output", bake, "--resolution", "64", "--spp", "1", "--quiet")
        triangle = struct.pack("<12fH", 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0)
        stl = self.write("damaged/plain.stl", bytes(80) + struct.pack("<I", 8) + triangle * 8)
        positions = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
        document = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "children": [1]}, {"translation": [0, 0, 2], "mesh": 0}],
                    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}], "materials": [{"emissiveFactor": [1, 1, 1]}],
                    "buffers": [{"byteLength": 42}], "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
                    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
                                  {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}]}
        text = json.dumps(document).encode()
        text += b" " * (-len(text) % 4)
        binary = positions + struct.pack("<3H", 0, 1, 2) + bytes(2)
        glb = self.write("damaged/plain.glb", b"glTF" + struct.pack("<III", 2, 28 + len(text) + len(binary), len(text)) + b"JSON" + text
                         + struct.pack("<I", len(binary)) + b"BIN\0" + binary)
        worst_time, worst_memory, bad, codes = (0.0, ""), (0, ""), 0, {}
        for number in range(self.damage_count):
            kind = number % 10
            if kind < 6:
                source = self.scene(self.random.choice(scenes))
            else:
                source = [self.random.choice((mesh, bake + ".obj")), self.random.choice((stl, bake + ".ply")), glb,
                          self.random.choice([state] + pictures)][kind - 6]
            with open(source, "rb") as file:
                data = file.read()
            extension = os.path.splitext(source)[1]
            path = os.path.join(folder, f"case{number}{extension}")
            with open(path, "wb") as file:
                file.write(self.damage(data, extension in (".json", ".obj", ".ply")))
            output = os.path.join(folder, "out.png")
            render = ["render", path, "--resolution", "16x12", "--spp", "1", "--output", output]
            if extension == ".state":
                runs = [["merge", path, "--output", output], ["render", plain, "--resume", path, "--output", output]]
            elif extension in (".exr", ".png", ".pfm"):
                runs = [["compare", path, path], ["info", self.textured("damaged/textured.json", os.path.basename(path))]]
            elif kind >= 6:
                inner = self.native("damaged/inner.json", [{"geometry": "mesh", "file": os.path.basename(path), "material": "grey"}])
                runs = [["info", path], render] + ([] if extension == ".glb" else [["render", inner] + render[2:]])
            else:
                runs = [["info", path], render]
            found = []
            for args in runs:
                run = self.run(*args)
                codes[run.code] = codes.get(run.code, 0) + 1
                worst_time = max(worst_time, (run.seconds, path))
                worst_memory = max(worst_memory, (run.peak, path))
                wrong = self.faults(run)
                if wrong:
                    self.report(f"damaged file {number} ({os.path.basename(source)}): {args[0]}", run, wrong, f"seed {self.seed}")
                    found += wrong
            bad += bool(found)
            if not found:
                os.remove(path)
            elif self.keep:
                shutil.copy(path, self.keep)
        self.report(f"damaged files: {self.damage_count}", None, [],
                    f"{bad} with violations; codes {dict(sorted(codes.items()))}; slowest {worst_time[0]:.1f} s, most memory {worst_memory[0] / MIB:.0f} MiB")

    ALL = ["kills", "full_disk", "places", "closed", "signals", "limits", "large", "odd_files", "damaged"]

    def close(self):
        for path in list(self.mounts):
            self.unmount(path)
        shutil.rmtree(self.root, ignore_errors=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("binary", help="the program")
    parser.add_argument("scenes", help="the folder of scenes")
    parser.add_argument("--seed", type=int, default=1, help="seed of all random choices")
    parser.add_argument("--only", help="names of groups of attacks, separated by commas: " + ", ".join(Attacks.ALL))
    parser.add_argument("--damaged", type=int, default=300, help="number of damaged files")
    parser.add_argument("--folder", help="where the folder for files is made")
    parser.add_argument("--keep", help="folder into which damaged files with violations are copied")
    parser.add_argument("--verbose", action="store_true", help="also the last lines of what succeeded")
    options = parser.parse_args()
    attacks = Attacks(options)
    attacks.damage_count, attacks.keep = options.damaged, options.keep
    began = time.monotonic()
    try:
        for name in options.only.split(",") if options.only else Attacks.ALL:
            start = time.monotonic()
            getattr(attacks, name)()
            print(f"-- {name}: {time.monotonic() - start:.0f} s", flush=True)
    finally:
        attacks.close()
    print(f"\n{attacks.count} attacks in {time.monotonic() - began:.0f} s, {len(attacks.violations)} violations")
    for violation in attacks.violations:
        print("  " + violation)
    return 1 if attacks.violations else 0


if __name__ == "__main__":
    sys.exit(main())
