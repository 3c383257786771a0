"""Flags of the camera: what glTF has no words for. Shift, pixel aspect and border come from Blender's own matrix."""

import math


def flags_of(found, job, told):
    camera = found.camera
    if camera is None:
        told.add("no active camera: wavepath chooses a view", "scene")
        return []
    width, height = job["size"]
    flags = ["--camera", "0", "--clip", "%r,%r" % (camera.data.clip_start, camera.data.clip_end)]
    data, projection = camera.data, camera.projection
    orthographic = data.type == "ORTHO"
    if data.type == "PANO":
        return flags + panorama(camera, told)
    # The centre of the picture in units of its half size: further right or up is what is shown by a shift.
    x, y = (-projection[0][3], -projection[1][3]) if orthographic else (projection[0][2], projection[1][2])
    if max(abs(x), abs(y)) > 1e-6:
        flags += ["--shift", "%r,%r" % (x / 2, y / 2)]
    aspect = job["pixel_aspect"]
    if abs(aspect[0] / aspect[1] - 1) > 1e-6:
        if orthographic:
            told.add("pixels that are not square: square", camera.name)
        else:
            flags += ["--intrinsics", "%r,%r,%r,%r" % (projection[0][0] * width / 2, projection[1][1] * height / 2,
                                                      (1 - x) * width / 2, (1 + y) * height / 2)]
            flags = [f for i, f in enumerate(flags) if f != "--shift" and flags[i - 1] != "--shift"]
    if data.dof.use_dof and not orthographic:
        flags += depth_of_field(camera, told)
    elif data.dof.use_dof:
        told.add("depth of field of a parallel projection: off", camera.name)
    return flags


def depth_of_field(camera, told):
    dof = camera.data.dof
    if abs(dof.aperture_ratio - 1) > 1e-4:
        told.add("squeezed aperture: round", camera.name)
    if dof.aperture_rotation and dof.aperture_blades:
        told.add("turned aperture: a corner is on top", camera.name)
    aperture = camera.data.lens / 1000 / dof.aperture_fstop
    flags = ["--aperture", repr(aperture), "--focus", repr(max(camera.focus, 1e-4))]
    return flags + (["--blades", str(min(dof.aperture_blades, 64))] if dof.aperture_blades >= 3 else [])


def panorama(camera, told):
    data = camera.data
    settings = getattr(data, "cycles", None)
    kind = getattr(data, "panorama_type", None) or getattr(settings, "panorama_type", "EQUIRECTANGULAR")
    if kind == "EQUIRECTANGULAR":
        return ["--projection", "equirectangular"]
    if kind in ("FISHEYE_EQUIDISTANT",):
        fov = getattr(data, "fisheye_fov", None) or getattr(settings, "fisheye_fov", math.pi)
        return ["--projection", "fisheye", "--fov", repr(math.degrees(fov))]
    told.add("panorama of kind %s: equirectangular" % kind.lower(), camera.name)
    return ["--projection", "equirectangular"]
