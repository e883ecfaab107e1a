"""Keeps one scene in LuxCore and renders it as often as it is told, for ../bench.py.

A line of JSON in, {"spp", "seed", "output"}, makes a PFM file and a line out, {"spp", "seconds", "cpu", "prepare"}. The
first line out, when the scene is loaded, has the version. Every render is a session of its own; its hierarchy is built
before the clock starts, and those seconds are `prepare`.
"""

import json
import os
import sys
import time

import render as luxcore  # First, for its message when something is missing.

import pictures


def say(record):
    os.write(luxcore.record_to, (json.dumps(record) + "\n").encode())


def main():
    parser = luxcore.arguments()
    parser.set_defaults(integrator="path", time=600.0)
    args = parser.parse_args()
    luxcore.pyluxcore.Init(lambda line: None)
    scene, resolution = luxcore.load(args)
    say({"version": luxcore.pyluxcore.Version()})
    for line in sys.stdin:
        order = json.loads(line)
        args.spp, args.seed = order["spp"], order["seed"]
        busy = time.process_time()
        image, seconds, prepared, samples = luxcore.render(args, scene, resolution, poll=0.05)
        cpu = time.process_time() - busy
        pictures.write_pfm(order["output"], image)
        say({"spp": samples, "seconds": seconds - prepared, "cpu": cpu, "prepare": prepared})
    # LuxCore 2.11 crashes when Python takes its module apart; everything is written by now.
    os._exit(0)


if __name__ == "__main__":
    main()
