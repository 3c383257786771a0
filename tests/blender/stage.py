"""Scenes and pictures for the tests that run inside Blender: see tests/blender_test.py."""

import importlib
import math
import os
import struct
import sys
import zlib

import bpy
import mathutils
import numpy

if "WAVEPATH_ADDON" in os.environ:  # the add-on's sources, where it is not installed
    sys.path.insert(0, os.environ["WAVEPATH_ADDON"])
FOLDER = os.environ["WAVEPATH_SCRATCH"]


def add_on():
    module = importlib.import_module("wavepath_blender")
    if not hasattr(bpy.types.Scene, "wavepath"):
        module.register()
    return module


def empty(size=(16, 16), samples=64):
    """A scene without world, to be rendered into a linear picture."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    add_on()
    scene = bpy.context.scene
    render = scene.render
    render.engine = "WAVEPATH"
    render.resolution_x, render.resolution_y = size
    render.resolution_percentage = 100
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth = "32"
    scene.wavepath.samples = samples
    return scene


def material(name, kind="ShaderNodeBsdfDiffuse", **inputs):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    node = tree.nodes.new(kind)
    for key, value in inputs.items():
        node.inputs[key.replace("_", " ")].default_value = value
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return made


def white(albedo=0.8):
    return material("white", Color=(albedo, albedo, albedo, 1))


def mesh(name, corners, faces, surface, place=(0, 0, 0)):
    data = bpy.data.meshes.new(name)
    data.from_pydata(corners, [], faces)
    data.materials.append(surface)
    return link(name, data, mathutils.Matrix.Translation(place))


def plane(half, surface, name="plane", place=(0, 0, 0)):
    return mesh(name, [(-half, -half, 0), (half, -half, 0), (half, half, 0), (-half, half, 0)], [(0, 1, 2, 3)], surface,
                place)


def ball(radius, surface, place, name="ball"):
    bpy.ops.mesh.primitive_uv_sphere_add(radius=radius, location=place, segments=48, ring_count=24)
    made = bpy.context.object
    made.name = name
    made.data.materials.append(surface)
    bpy.ops.object.shade_smooth()
    return made


def link(name, data, matrix):
    made = bpy.data.objects.new(name, data)
    made.matrix_world = matrix
    bpy.context.scene.collection.objects.link(made)
    return made


def look(eye, target, up="Y"):
    eye = mathutils.Vector(eye)
    turn = (mathutils.Vector(target) - eye).to_track_quat("-Z", up)
    return mathutils.Matrix.LocRotScale(eye, turn, (1, 1, 1))


def camera(eye, target, angle):
    data = bpy.data.cameras.new("camera")
    data.sensor_fit = "VERTICAL"
    data.angle = angle
    made = link("camera", data, look(eye, target))
    bpy.context.scene.camera = made
    return made


def lamp(kind, power, eye=(0, 0, 2), target=(0, 0, 0), name="lamp", **values):
    data = bpy.data.lights.new(name, kind)
    data.energy = power
    if kind in ("POINT", "SPOT"):
        data.shadow_soft_size = 0
    if kind == "SUN":
        data.angle = 0
    for key, value in values.items():
        setattr(data, key, value)
    return link(name, data, look(eye, target))


def world(colour, strength=1.0):
    made = bpy.data.worlds.new("world")
    made.use_nodes = True
    node = made.node_tree.nodes["Background"]
    node.inputs["Color"].default_value = (*colour, 1)
    node.inputs["Strength"].default_value = strength
    bpy.context.scene.world = made
    return made


def cycles(scene, samples):
    scene.render.engine = "CYCLES"
    options = scene.cycles
    options.device = "CPU"
    options.samples = samples
    options.use_denoising = options.use_adaptive_sampling = False
    options.max_bounces = options.diffuse_bounces = options.glossy_bounces = options.transmission_bounces = 8
    options.sample_clamp_direct = options.sample_clamp_indirect = 0
    options.blur_glossy = 0
    options.pixel_filter_type = "BLACKMAN_HARRIS"


def render(name="picture", **arguments):
    """The picture that Blender writes: channels by name, top row first."""
    bpy.context.scene.render.filepath = os.path.join(FOLDER, name + ".exr")
    bpy.ops.render.render(write_still=True, **arguments)
    return read_exr(bpy.context.scene.render.filepath)


def mean(channels, names="RGB"):
    return float(numpy.mean([channels[name] for name in names]))


def read_exr(path):
    """Rows of an EXR file as Blender writes it: scan lines, compressed by ZIP or not at all."""
    with open(path, "rb") as file:
        data = file.read()
    at, attributes = 8, {}
    while data[at]:
        name, at = text(data, at)
        _, at = text(data, at)
        (size,) = struct.unpack_from("<i", data, at)
        attributes[name] = data[at + 4 : at + 4 + size]
        at += 4 + size
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    channels, place = [], 0
    while attributes["channels"][place]:
        name, place = text(attributes["channels"], place)
        (kind,) = struct.unpack_from("<i", attributes["channels"], place)
        channels.append((name, {0: "<u4", 1: "<f2", 2: "<f4"}[kind]))
        place += 16
    compression = attributes["compression"][0]
    lines = {0: 1, 2: 1, 3: 16}[compression]
    pictures = {name: numpy.zeros((height, width), kind) for name, kind in channels}
    count = -(-height // lines)
    for offset in struct.unpack_from("<%dQ" % count, data, at + 1):
        y, size = struct.unpack_from("<2i", data, offset)
        rows = min(lines, bottom - y + 1)
        whole = sum(numpy.dtype(kind).itemsize for _, kind in channels) * width * rows
        block = data[offset + 8 : offset + 8 + size]
        if compression and size < whole:
            block = undo_prediction(zlib.decompress(block))
        place = 0
        for row in range(rows):
            for name, kind in channels:
                values = numpy.frombuffer(block, kind, width, place)
                pictures[name][y - top + row] = values
                place += values.nbytes
    return pictures


def undo_prediction(block):
    values = numpy.frombuffer(block, numpy.uint8).astype(numpy.int64)
    values[1:] -= 128
    values = (numpy.cumsum(values) & 255).astype(numpy.uint8)
    half = (len(values) + 1) // 2
    joined = numpy.empty_like(values)
    joined[0::2], joined[1::2] = values[:half], values[half:]
    return joined.tobytes()


def text(data, at):
    end = data.index(0, at)
    return data[at:end].decode(), end + 1


def near(what, value, expected, tolerance):
    ratio = value / expected
    verdict = "ok" if abs(ratio - 1) <= tolerance else "WRONG"
    print("%-40s %12.6g expected %12.6g ratio %.5f  %s" % (what, value, expected, ratio, verdict), flush=True)
    if verdict != "ok":
        raise SystemExit(what)


def patch_of_rectangle(x, y, d):
    """Irradiance by radiance 1 of a rectangle, faced and centred, at distance d: four times a corner's."""
    a, b = x / 2 / d, y / 2 / d
    p, q = math.sqrt(1 + a * a), math.sqrt(1 + b * b)
    return 4 * 0.5 * (a / p * math.atan(b / p) + b / q * math.atan(a / q))


def patch_of_ellipse(x, y, d):
    """The same by sums over rings and turns."""
    radii = (numpy.arange(400) + 0.5) / 400
    turns = (numpy.arange(400) + 0.5) / 400 * 2 * math.pi
    r, t = numpy.meshgrid(radii, turns)
    squared = (x / 2 * r * numpy.cos(t)) ** 2 + (y / 2 * r * numpy.sin(t)) ** 2 + d * d
    return float(numpy.sum(r * d * d / squared**2) * (x * y / 4) * 2 * math.pi / 400**2)
