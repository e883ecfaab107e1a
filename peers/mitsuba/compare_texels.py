"""Where the texels of an image lie: ours against Mitsuba's, for a 4 x 4 image on a square under an even sky.

The square shows texture coordinates from -0.5 to 1.5, so that half texels, wrapping and the direction of v all show. A
diffuse square under an even sky of radiance 1 has the radiance of its albedo. Prints, for each filter and each wrapping, the
mean and the largest difference of pixels; noise is what is left where they agree.
"""

import argparse
import json
import pathlib
import sys
import tempfile

import backend  # First, for its message when something is missing.
import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import ours

SIDE = 96
SPP = 1024


def image():
    """Numbers that no turn, mirror or shift maps onto themselves."""
    return np.random.default_rng(4).integers(0, 256, (4, 4, 3)).astype(np.uint8)


def our_scene(folder, texels, filter_name, wrap):
    import struct, zlib

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = b"".join(b"\0" + row.tobytes() for row in texels)
    png = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 4, 4, 8, 2, 0, 0, 0))
    png += chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
    (folder / "texels.png").write_bytes(png)
    scene = {
        "etendue": 1,
        "camera": {"origin": [0, 0, 10], "lookAt": [0, 0, 0], "up": [0, 1, 0], "fieldOfView": 2 * np.degrees(np.arctan(0.1))},
        "lights": [{"type": "environment", "color": [1, 1, 1]}],
        "textures": [
            {"name": "t", "type": "image", "file": "texels.png", "colorSpace": "raw", "filter": filter_name, "wrap": wrap,
             "scale": [2, 2], "offset": [-0.5, -0.5]}
        ],
        "materials": [{"name": "m", "type": "diffuse", "color": [1, 1, 1], "textures": {"color": "t"}}],
        "surfaces": [
            {"geometry": "quad", "vertex-1": [-1, -1, 0], "vertex-2": [1, -1, 0], "vertex-3": [1, 1, 0],
             "vertex-4": [-1, 1, 0], "material": "m"}
        ],
    }
    path = folder / "scene.json"
    path.write_text(json.dumps(scene), encoding="utf-8")
    return path


def mitsuba_image(mi, texels, filter_name, wrap):
    bitmap = mi.Bitmap(texels)
    # In Mitsuba the first row of an image is at v = 0, in ours at v = 1.
    to_uv = mi.ScalarTransform4f().translate([-0.5, 1.5, 0]).scale([2, -2, 1])
    scene = mi.load_dict({
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 2},
        "sensor": {
            "type": "perspective",
            "fov": float(2 * np.degrees(np.arctan(0.1))),
            "to_world": mi.ScalarTransform4f().look_at(origin=[0, 0, 10], target=[0, 0, 0], up=[0, 1, 0]),
            "film": {"type": "hdrfilm", "width": SIDE, "height": SIDE, "rfilter": {"type": "box"}},
            "sampler": {"type": "independent", "sample_count": SPP},
        },
        "sky": {"type": "constant", "radiance": {"type": "rgb", "value": 1.0}},
        "square": {
            "type": "rectangle",
            "bsdf": {"type": "diffuse", "reflectance": {"type": "bitmap", "bitmap": bitmap, "raw": True,
                                                        "filter_type": filter_name, "wrap_mode": wrap, "to_uv": to_uv}},
        },
    })
    return backend.render(mi, scene, SPP, 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--etendue", default="target/release/examples/etendue", help="our program")
    parser.add_argument("--variant", default="scalar_rgb", help="Mitsuba variant")
    args = parser.parse_args()
    program = ours.find(args.etendue)
    mi = backend.mitsuba(args.variant)
    texels, failed = image(), False
    print("filter     wrap     mean difference  largest")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for filter_name in ("nearest", "bilinear"):
            for wrap in ("repeat", "mirror", "clamp"):
                scene = our_scene(folder, texels, filter_name, wrap)
                output = folder / "ours.exr"
                ours.render(program, scene, output, 1, 1, "--resolution", f"{SIDE}x{SIDE}", "--spp", str(SPP))
                a, b = backend.read_exr(output), mitsuba_image(mi, texels, filter_name, wrap)
                difference = np.abs(a - np.asarray(b)[..., :3])
                failed |= difference.mean() > 0.005
                print(f"{filter_name:10} {wrap:8} {difference.mean():15.5f}  {difference.max():.4f}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
