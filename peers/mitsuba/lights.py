"""Mitsuba's emitters and sensors for our lights and cameras, where both mean the same; `Unsupported` where they do not.

* An environment by longitude and latitude becomes `envmap`. Mitsuba's first and last row of texels are the poles themselves, ours
  end at the poles. An image of 2 H + 1 rows has all of our rows and the middles between them at its nodes, so that it is
  interpolated to the same radiance everywhere. Across, both have the middles of texels at the same longitudes.
* `spot` falls off linearly with the angle in Mitsuba. Its hard edge is moved to our outer cone, and our falloff is its texture.
* A `distant` light with an angle becomes a luminous disk so far away that nothing of a scene sees it from another direction. It
  hides what is behind it, where ours adds to it: an even environment's radiance is added to the disk's, that of an image is left out.
* Of an OpenEXR file the numbers are taken as they are, which is what we do. Mitsuba's own reader follows the attribute
  `chromaticities`: it turns the file's white, which may be D50, into a colour of Rec. 709.
"""

import math
import pathlib
import sys

import backend
import numpy as np
from materials import Unsupported, rgb

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import pictures

FAR = 1e5
"""Distance of the disk of a distant light, scene units: what is at 10 units from the origin sees it turned by 0.006 degrees."""

SPOT = 2048
"""Texels across the texture of a spot light, which is interpolated bilinearly."""


def refuse(part, name, *keys):
    """Ends in `Unsupported` if a part of a scene has one of these keys with a meaning."""
    for key in keys:
        if part.get(key):
            raise Unsupported(f"{name}: {key}")


def turn_to(up):
    """The rotation of +y to `up` by the shortest way, 3 x 3."""
    up = np.array(up, dtype=np.float64)
    up = up / np.linalg.norm(up)
    if up[1] < -1.0 + 1e-12:
        return np.diag([1.0, -1.0, -1.0])
    v = np.cross([0.0, 1.0, 0.0], up)
    cross = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    return np.eye(3) + cross + cross @ cross / (1.0 + up[1])


def about_y(degrees):
    """Rotation about +y, counter-clockwise as seen from above."""
    s, c = math.sin(math.radians(degrees)), math.cos(math.radians(degrees))
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


def rows_at_poles(image):
    """2 H + 1 rows from pole to pole: every other one is a row of the image, the others are means of their neighbours."""
    height = len(image)
    wide = np.concatenate([image[:1], image, image[-1:]])
    rows = np.empty((2 * height + 1, *image.shape[1:]), dtype=np.float32)
    rows[1::2] = image
    rows[0::2] = 0.5 * (wide[:-1] + wide[1:])
    return rows


def read_image(file):
    """Linear radiance [height][width][3] of an image file; numbers below zero count as 0."""
    mi = backend.mitsuba()
    if not pathlib.Path(file).exists():
        raise Unsupported(f"{file} does not exist")
    if pathlib.Path(file).suffix.lower() == ".exr":
        try:
            image = pictures.read_exr(file)
        except ImportError as missing:
            raise Unsupported(f"{file}: {missing}") from None
        if image is None:
            raise Unsupported(f"{file} has no channels R, G and B")
        return np.maximum(image, 0.0).astype(np.float32)
    bitmap = mi.Bitmap(str(file)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, srgb_gamma=False)
    return np.maximum(np.array(bitmap, dtype=np.float32), 0.0)


def environment(light, textures, folder):
    mi = backend.mitsuba()
    if light.get("visible", True) is not True:
        raise Unsupported("environment: Mitsuba can hide all emitters or none")
    color = np.array(light.get("color", [1, 1, 1]), dtype=np.float64) * light.get("intensity", 1.0)
    if "texture" not in light:
        return {"type": "constant", "radiance": rgb(color)}
    texture = textures[light["texture"]]
    if light.get("projection", "latlong") != "latlong" or texture["type"] != "image":
        raise Unsupported("environment: only images by longitude and latitude")
    refuse(texture, "texture of the environment", "colorSpace", "coordinates", "vertexColors")
    if texture.get("filter", "bilinear") == "nearest":
        raise Unsupported("environment: Mitsuba interpolates")
    image = read_image(pathlib.Path(folder) / texture["file"]) * color.astype(np.float32)
    # The left edge of Mitsuba's image is in the direction -z, and so is the middle of ours.
    to_world = np.eye(4)
    to_world[:3, :3] = turn_to(light.get("up", [0, 1, 0])) @ about_y(light.get("rotation", 0.0) + 180.0)
    turned = mi.ScalarTransform4f(to_world.tolist())
    return {"type": "envmap", "bitmap": mi.Bitmap(rows_at_poles(image)), "to_world": turned}


def spot(light):
    mi = backend.mitsuba()
    outer, inner = light.get("outerConeAngle", 45.0), light.get("innerConeAngle", 0.0)
    if outer > 89.0:
        raise Unsupported("spot light: the texture of Mitsuba's reaches to less than 90 degrees")
    color = np.array(light.get("color", [1, 1, 1]), dtype=np.float64) * light.get("intensity", 1.0)
    origin, along = np.array(light["origin"], dtype=np.float64), np.array(light["direction"], dtype=np.float64)
    up = np.eye(3)[np.argmin(np.abs(along))]
    to_world = mi.ScalarTransform4f().look_at(origin=origin.tolist(), target=(origin + along).tolist(), up=up.tolist())
    keys = {"type": "spot", "intensity": rgb(color), "to_world": to_world, "cutoff_angle": outer}
    if outer <= inner:
        return keys | {"beam_width": outer * (1.0 - 1e-5)}
    # Texels lie evenly on the plane at distance 1, out to the cone.
    x = (2.0 * (np.arange(SPOT) + 0.5) / SPOT - 1.0) * math.tan(math.radians(outer))
    cosine = 1.0 / np.sqrt(1.0 + x[None, :] ** 2 + x[:, None] ** 2)
    far, near = math.cos(math.radians(outer)), math.cos(math.radians(inner))
    falloff = np.clip((cosine - far) / (near - far), 0.0, 1.0) ** 2
    image = mi.Bitmap(np.repeat(falloff[..., None], 3, 2).astype(np.float32))
    texture = {"type": "bitmap", "bitmap": image, "raw": True, "filter_type": "bilinear", "wrap_mode": "clamp"}
    return keys | {"beam_width": outer * (1.0 - 1e-5), "texture": texture}


def distant(light, behind):
    mi = backend.mitsuba()
    if "sunAt" in light or light.get("visible", True) is not True:
        raise Unsupported("distant light: sunAt or a disk that is not visible")
    color = np.array(light.get("color", [1, 1, 1]), dtype=np.float64) * light.get("intensity", 1.0)
    sun = np.array(light["sun"], dtype=np.float64)
    sun = sun / np.linalg.norm(sun)
    half = math.radians(light.get("angle", 0.0) / 2.0)
    if half == 0.0:
        return {"type": "directional", "direction": (-sun).tolist(), "irradiance": rgb(color)}
    if half > math.radians(80.0):
        raise Unsupported("distant light: a disk that spans half of the sky")
    # A disk of radius 1 whose normal is +z, seen under the angle and facing the origin. Its irradiance is pi sin^2 of its radiance.
    place = mi.ScalarTransform4f().look_at(
        origin=(FAR * sun).tolist(), target=[0, 0, 0], up=np.eye(3)[np.argmin(np.abs(sun))].tolist()
    )
    radius = FAR * math.tan(half)
    radiance = color / (math.pi * math.sin(half) ** 2) + np.array(behind)
    return {
        "type": "disk",
        "to_world": place @ mi.ScalarTransform4f().scale([radius, radius, 1.0]),
        "bsdf": {"type": "diffuse", "reflectance": rgb([0, 0, 0])},
        "emitter": {"type": "area", "radiance": rgb(radiance)},
    }


def evenly(lights):
    """The radiance that a scene has from all directions: of its environment without a texture."""
    total = np.zeros(3)
    for light in lights:
        if light["type"] == "environment" and "texture" not in light:
            total += np.array(light.get("color", [1, 1, 1]), dtype=np.float64) * light.get("intensity", 1.0)
    return total


def emitter(light, textures, folder, behind):
    """Mitsuba's emitter of one of our lights other than an area light. `behind`: see `evenly`."""
    kind = light["type"]
    refuse(light, f"{kind} light", "motion", "temperature")
    if light.get("unit", "W") != "W":
        raise Unsupported(f"{kind} light: photometric units")
    if kind == "point":
        color = np.array(light.get("color", [1, 1, 1]), dtype=np.float64) * light.get("intensity", 1.0)
        return {"type": "point", "position": [float(x) for x in light["origin"]], "intensity": rgb(color)}
    if kind == "environment":
        return environment(light, textures, folder)
    if kind == "spot":
        return spot(light)
    if kind == "distant":
        return distant(light, behind)
    raise Unsupported(f"light type {kind}")


def lens(camera, view, aspect):
    """Mitsuba's keys for a native camera that looks along `view` (whose length is the distance of `lookAt`), without its place.

    `half_width` is none of Mitsuba's: what half of an image of parallel rays spans.
    """
    kind = camera.get("type", "perspective")
    shutter = camera.get("shutter") or {}
    refuse(camera, "camera", "motion")
    if shutter.get("close", shutter.get("open", 0.0)) != shutter.get("open", 0.0):
        raise Unsupported("camera: shutter")
    if kind == "orthographic":
        width = camera["width"] if camera.get("width") is not None else camera["height"] * aspect
        return {"type": "orthographic", "half_width": 0.5 * float(width)}
    if kind != "perspective":
        raise Unsupported(f"camera {kind}")
    axis = "y" if camera.get("fieldOfViewAxis", "horizontal") == "vertical" else "x"
    keys = {"fov": float(camera.get("fieldOfView", 90.0)), "fov_axis": axis}
    radius = camera.get("lensRadius") or 0.0
    if camera.get("fStop"):
        radius = camera["focalLength"] / (2.0 * camera["fStop"])
    if radius == 0.0:
        return {"type": "perspective"} | keys
    refuse(camera, "lens", "blades")
    if camera.get("squeeze", 1.0) != 1.0:
        raise Unsupported("lens: squeeze")
    length = float(np.linalg.norm(view))
    focus = camera.get("focusDistance") or length
    if camera.get("focusAt"):
        towards = np.array(camera["focusAt"], dtype=np.float64) - np.array(camera.get("origin", [0, 0, 0]), dtype=np.float64)
        focus = float(towards @ view) / length
    return {"type": "thinlens", "aperture_radius": float(radius), "focus_distance": float(focus)} | keys
