"""A million triangles with 0, 1, 10 and 100 textures of 2048 x 2048: loading, memory and speed, ours and Mitsuba's.

Writes a hilly ground of a million triangles in as many pieces as there are textures (PLY files and PNG images, 8 bits),
under an even sky, and renders it with both programs. Loading is from the start of reading to a picture of 8 x 8 pixels and one
sample, without the start of Python; memory is the greatest of the process. Speed is that of a picture of 512 x 512 and
16 samples, with paths of three bounces. Nothing else may run on the machine.
"""

import argparse
import json
import pathlib
import resource
import struct
import subprocess
import sys
import time
import zlib

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "mitsuba"))
import backend  # First, for its message when something is missing.
import numpy as np

import ours

TEXELS = 2048
SIDE = 708  # 707 x 707 squares are 999,698 triangles.
CAMERA = {"origin": [0, 7, 9], "lookAt": [0, 0, 0], "up": [0, 1, 0], "fieldOfView": 60}


def write_png(path, image):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    height, width, _ = image.shape
    rows = np.concatenate([np.zeros((height, 1), np.uint8), image.reshape(height, -1)], axis=1)
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    data = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows.tobytes(), 1)) + chunk(b"IEND", b"")
    path.write_bytes(data)


def ground():
    x, z = np.meshgrid(np.linspace(-5, 5, SIDE), np.linspace(-5, 5, SIDE))
    y = 0.4 * np.sin(1.7 * x) * np.cos(1.3 * z) + 0.03 * np.sin(31 * x + 3) * np.sin(29 * z) + 0.005 * np.sin(170 * x) * np.cos(190 * z)
    return np.stack([x, y, z], -1).astype("<f4")


def write_pieces(folder, count):
    """One PLY file for each of `count` strips of the ground; texture coordinates run once over each."""
    points = ground()
    for i in range(count):
        first, last = (SIDE - 1) * i // count, (SIDE - 1) * (i + 1) // count
        strip = points[first : last + 1]
        rows, columns, _ = strip.shape
        u, v = np.meshgrid(np.linspace(0, 1, columns), np.linspace(0, 1, rows))
        vertices = np.concatenate([strip, np.stack([u, v], -1)], -1).astype("<f4").reshape(-1, 5)
        corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).reshape(-1)
        faces = np.concatenate([np.stack([corner, corner + columns, corner + 1], -1),
                                np.stack([corner + 1, corner + columns, corner + columns + 1], -1)])
        table = np.zeros(len(faces), dtype=[("n", "u1"), ("v", "<i4", 3)])
        table["n"], table["v"] = 3, faces
        names = "".join(f"property float {name}\n" for name in ("x", "y", "z", "u", "v"))
        head = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n{names}"
                f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
        (folder / f"{i}.ply").write_bytes(head.encode() + vertices.tobytes() + table.tobytes())


def write_scene(folder, textures):
    pieces = max(textures, 1)
    folder.mkdir(parents=True, exist_ok=True)
    write_pieces(folder, pieces)
    scene = {
        "etendue": 1, "camera": CAMERA, "lights": [{"type": "environment", "color": [1, 1, 1]}],
        "textures": [{"name": f"t{i}", "type": "image", "file": f"../t{i}.png"} for i in range(textures)],
        "materials": [{"name": f"m{i}", "type": "diffuse", "color": [1, 1, 1] if textures else [0.5] * 3,
                       "textures": {"color": f"t{i}"} if textures else {}} for i in range(pieces)],
        "surfaces": [{"geometry": "mesh", "file": f"{i}.ply", "material": f"m{i}"} for i in range(pieces)],
    }
    path = folder / "scene.json"
    path.write_text(json.dumps(scene), encoding="utf-8")
    return path


def mitsuba_times(folder, textures, variant, threads):
    """In a process of its own: seconds until the first picture, peak memory, seconds of the large picture."""
    mi = backend.mitsuba(variant)
    backend.set_threads(threads)
    start = time.perf_counter()
    scene = {
        "type": "scene", "integrator": {"type": "path", "max_depth": 4}, "sky": {"type": "constant"},
        "sensor": {"type": "perspective", "fov": CAMERA["fieldOfView"],
                   "to_world": mi.ScalarTransform4f().look_at(CAMERA["origin"], CAMERA["lookAt"], CAMERA["up"]),
                   "film": {"type": "hdrfilm", "width": 512, "height": 512, "rfilter": {"type": "box"}}},
    }
    for i in range(max(textures, 1)):
        color = {"type": "bitmap", "filename": str(folder.parent / f"t{i}.png")} if textures else {"type": "rgb", "value": 0.5}
        scene[f"s{i}"] = {"type": "ply", "filename": str(folder / f"{i}.ply"), "face_normals": True,
                          "bsdf": {"type": "diffuse", "reflectance": color}}
    small = mi.load_dict({"type": "perspective", "film": {"type": "hdrfilm", "width": 8, "height": 8, "rfilter": {"type": "box"}},
                          "to_world": scene["sensor"]["to_world"], "fov": CAMERA["fieldOfView"]})
    scene = mi.load_dict(scene)
    np.array(mi.render(scene, sensor=small, spp=1))
    loaded = time.perf_counter() - start
    np.array(mi.render(scene, spp=16, seed=1))
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    start = time.perf_counter()
    np.array(mi.render(scene, spp=16, seed=2))
    print(json.dumps([loaded, memory, time.perf_counter() - start]))


def our_times(program, path, threads):
    output = path.with_suffix(".exr")
    options = ["--output", output, "--threads", threads, "--max-depth", 4, "--stats", path.with_suffix(".stats.json")]
    start = time.perf_counter()
    ours.run([program, "render", path, "--resolution", "8x8", "--spp", 1, *options])
    loaded = time.perf_counter() - start
    ours.run([program, "render", path, "--resolution", "512x512", "--spp", 16, *options])
    stats = json.loads(path.with_suffix(".stats.json").read_text(encoding="utf-8"))
    return loaded, stats, stats["seconds"]["render"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--etendue", default="target/release/examples/etendue", help="our program")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--folder", default="out/textured", type=pathlib.Path)
    parser.add_argument("--counts", type=int, nargs="+", default=[0, 1, 10, 100])
    parser.add_argument("--variants", nargs="*", default=["llvm_ad_rgb", "scalar_rgb"])
    parser.add_argument("--worker", nargs=2, help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.worker:
        count, variant = int(args.worker[0]), args.worker[1]
        mitsuba_times(args.folder / str(count), count, variant, args.threads)
        return
    program = ours.find(args.etendue)
    args.folder.mkdir(parents=True, exist_ok=True)
    random = np.random.default_rng(5)
    for i in range(max(args.counts)):
        path = args.folder / f"t{i}.png"
        if not path.exists():
            coarse = random.integers(0, 256, (TEXELS // 8, TEXELS // 8, 3)).astype(np.uint8)
            fine = random.integers(0, 24, (TEXELS, TEXELS, 3)).astype(np.uint8)
            write_png(path, coarse.repeat(8, 0).repeat(8, 1) // 2 + fine)
    print("| textures | renderer | s to the first picture | peak memory, MiB | s for 16 samples | Mrays/s |\n|---|---|---|---|---|---|")
    for count in args.counts:
        path = write_scene(args.folder / str(count), count)
        loaded, stats, seconds = our_times(program, path, args.threads)
        rays = f"{stats['rays'] / seconds / 1e6:.2f}"
        print(f"| {count} | étendue | {loaded:.2f} | {stats.get('peakMemory', 0) / 2**20:.0f} | {seconds:.2f} | {rays} |", flush=True)
        for variant in args.variants:
            command = [sys.executable, __file__, "--folder", args.folder, "--threads", args.threads, "--worker", count, variant]
            done = subprocess.run([str(x) for x in command], capture_output=True, text=True)
            if done.returncode:
                print(f"| {count} | mitsuba {variant} | {done.stderr.strip().splitlines()[-1]} | | | |")
                continue
            loaded, memory, seconds = json.loads(done.stdout.splitlines()[-1])
            print(f"| {count} | mitsuba {variant} | {loaded:.2f} | {memory:.0f} | {seconds:.2f} | |", flush=True)


if __name__ == "__main__":
    main()
