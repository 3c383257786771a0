"""The world: one colour as a flag, anything else as an equirectangular picture that Cycles renders of it."""

import math
import os

import bpy
import numpy

SIZE = (1024, 512)
LARGEST = 4096


def flags_of(scene, folder, told):
    world = scene.world
    flags = ["--transparent"] if scene.render.film_transparent else []
    if world is None:
        return flags + ["--env", "0,0,0"]
    colour = constant(world)
    if colour is not None:
        return flags + ["--env", "%r,%r,%r" % tuple(colour)]
    nodes = reached(world.node_tree)
    if any(node.type == "LIGHT_PATH" for node in nodes):
        told.add("world that differs by kind of ray: all rays see what cameras see", world.name)
    if any(node.type in ("VOLUME_SCATTER", "VOLUME_ABSORPTION", "PRINCIPLED_VOLUME") for node in nodes):
        told.add("volume of the world: left out", world.name)
    path = os.path.join(folder, "world.exr")
    paint(scene, world, path, size_for(nodes))
    if clip(path):
        told.add("negative radiance of the world: black", world.name)
    return flags + ["--env", path]


def constant(world):
    if not world.use_nodes or world.node_tree is None:
        return list(world.color)
    output = active_output(world.node_tree)
    if output is None or not output.inputs["Surface"].links:
        return [0.0, 0.0, 0.0]
    node = output.inputs["Surface"].links[0].from_node
    if node.type != "BACKGROUND" or any(socket.links for socket in node.inputs):
        return None
    return [node.inputs["Strength"].default_value * value for value in node.inputs["Color"].default_value[:3]]


def active_output(tree):
    return next((n for n in tree.nodes if n.type == "OUTPUT_WORLD" and n.is_active_output), None)


def reached(tree):
    """Nodes that the output depends on."""
    found, todo = [], [active_output(tree)]
    while todo:
        node = todo.pop()
        if node is None or node in found:
            continue
        found.append(node)
        todo += [link.from_node for socket in node.inputs for link in socket.links]
    return found


def size_for(nodes):
    widths = [node.image.size[0] for node in nodes if node.type == "TEX_ENVIRONMENT" and node.image]
    width = min(max([SIZE[0], *widths]), LARGEST)
    return width, width // 2


def paint(source, world, path, size):
    """The centre of the picture is direction +X, three quarters across is -Y: +Z of glTF."""
    scene = bpy.data.scenes.new("wavepath world")
    scene.frame_set(source.frame_current)
    scene.world = world
    data = bpy.data.cameras.new("wavepath world")
    data.type = "PANO"
    kind = data if hasattr(data, "panorama_type") else data.cycles
    kind.panorama_type = "EQUIRECTANGULAR"
    camera = bpy.data.objects.new("wavepath world", data)
    camera.rotation_euler = (math.pi / 2, 0, -math.pi / 2)
    scene.collection.objects.link(camera)
    scene.camera = camera
    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y = size
    render.resolution_percentage = 100
    render.film_transparent = False
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_mode = "RGB"
    render.image_settings.color_depth = "32"
    render.filepath = path
    cycles.device = "CPU"
    cycles.samples = 4
    cycles.use_denoising = cycles.use_adaptive_sampling = False
    cycles.pixel_filter_type = "BOX"
    cycles.film_exposure = 1.0
    bpy.context.window.scene = scene
    bpy.ops.render.render(write_still=True)


def clip(path):
    """Whether the picture had values that are no radiance."""
    image = bpy.data.images.load(path)
    pixels = numpy.empty(len(image.pixels), numpy.float32)
    image.pixels.foreach_get(pixels)
    wrong = ~(pixels >= 0) | (pixels == numpy.inf)
    if wrong.any():
        pixels[wrong] = 0
        image.pixels.foreach_set(pixels)
        image.filepath_raw = path
        image.file_format = "OPEN_EXR"
        image.save()
    bpy.data.images.remove(image)
    return bool(wrong.any())
