"""Renders one glTF scene with Cycles, again and again, as lines on stdin ask: runs inside Blender, see peer_cycles.py.

The first line on stdin is the view as JSON; every further one is {"spp", "seed", "output"}. After each picture a line
begins with DONE. Blender itself tells how long the rendering took (--debug-cycles).
"""

import json
import math
import sys

import bpy
import mathutils
import numpy

# Debian 12's glTF importer asks numpy for names that numpy has dropped since.
for dropped, builtin in (("bool", bool), ("int", int), ("float", float), ("object", object)):
    if dropped not in vars(numpy):
        setattr(numpy, dropped, builtin)


def z_up(v):
    """glTF has +Y up, Blender +Z; this is how Blender's importer turns a scene."""
    return mathutils.Vector((v[0], -v[2], v[1]))


def add_camera(view):
    data = bpy.data.cameras.new("view")
    data.sensor_fit = "VERTICAL"
    data.angle = math.radians(view["yfov"])
    data.clip_start, data.clip_end = 1e-3, 1e5
    camera = bpy.data.objects.new("view", data)
    eye = z_up(view["eye"])
    camera.location = eye
    camera.rotation_mode = "QUATERNION"
    camera.rotation_quaternion = (z_up(view["look_at"]) - eye).to_track_quat("-Z", "Y")
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera


def add_environment(light, intensity):
    """`light`: a file, three numbers, or none."""
    world = bpy.data.worlds.new("environment")
    bpy.context.scene.world = world
    world.use_nodes = True
    background = world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (0, 0, 0, 1)
    background.inputs["Strength"].default_value = intensity
    if light and light[0].isdigit():
        background.inputs["Color"].default_value = (*map(float, light.split(",")), 1)
    elif light:
        image = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
        image.image = bpy.data.images.load(light)
        world.node_tree.links.new(image.outputs["Color"], background.inputs["Color"])


def principled(material):
    nodes = material.node_tree.nodes if material.use_nodes else ()
    return next((n for n in nodes if n.type == "BSDF_PRINCIPLED"), None)


def shines(material):
    node = principled(material)
    return node is None or max(node.inputs["Emission"].default_value[:3]) > 0


def make_lambert(material):
    """For a scene whose materials have no specular part, which this importer does not know: Principled is no Lambert
    surface even then."""
    tree, node = material.node_tree, principled(material)
    diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
    base = node.inputs["Base Color"]
    diffuse.inputs["Color"].default_value = base.default_value
    for link in base.links:  # of its texture
        tree.links.new(link.from_socket, diffuse.inputs["Color"])
    output = next(n for n in tree.nodes if n.type == "OUTPUT_MATERIAL")
    tree.links.new(diffuse.outputs["BSDF"], output.inputs["Surface"])


def is_lambert(material, names):
    """`names`: of those without a specular part, which this importer leaves theirs; or "all"."""
    node = principled(material)
    if node is None or shines(material):
        return False
    value = [node.inputs[name].default_value for name in ("Metallic", "Transmission")]
    return names == "all" or (max(value) == 0 and material.name in names)


def mix_layers(material, told):
    """Principled adds a coat of a quarter's weight and a diffuse base to what is mirrored. Here the layer on top takes
    Fresnel's share and what is below has the rest, as in glTF; `told`: what the importer has dropped."""
    tree, node = material.node_tree, principled(material)
    value = {key: node.inputs[key].default_value for key in ("Metallic", "Transmission", "Roughness", "IOR")}
    layers = []  # from the top: weight, ior, roughness
    if told["coat"] > 0:
        layers.append((told["coat"], 1.5, told["coat_roughness"]))
        node.inputs["Clearcoat"].default_value = 0
    below = node.outputs["BSDF"]
    if value["Metallic"] == value["Transmission"] == 0 and not shines(material):
        layers.append((told["specular"], value["IOR"], value["Roughness"]))
        base = tree.nodes.new("ShaderNodeBsdfDiffuse")
        base.inputs["Color"].default_value = node.inputs["Base Color"].default_value
        below = base.outputs["BSDF"]
    for weight, ior, roughness in reversed(layers):
        below = under_interface(tree, below, weight, ior, roughness)
    if layers:
        output = next(n for n in tree.nodes if n.type == "OUTPUT_MATERIAL")
        tree.links.new(below, output.inputs["Surface"])


def under_interface(tree, below, weight, ior, roughness):
    fresnel = tree.nodes.new("ShaderNodeFresnel")
    fresnel.inputs["IOR"].default_value = ior
    share = tree.nodes.new("ShaderNodeMath")
    share.operation = "MULTIPLY"
    share.inputs[1].default_value = weight
    glossy = tree.nodes.new("ShaderNodeBsdfGlossy")
    glossy.distribution = "MULTI_GGX"
    glossy.inputs["Color"].default_value = (1, 1, 1, 1)
    glossy.inputs["Roughness"].default_value = roughness
    mix = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(fresnel.outputs["Fac"], share.inputs[0])
    tree.links.new(share.outputs["Value"], mix.inputs["Fac"])
    tree.links.new(below, mix.inputs[1])
    tree.links.new(glossy.outputs["BSDF"], mix.inputs[2])
    return mix.outputs["Shader"]


def set_model(view):
    """`model`: as imported, with all bounces between microfacets (multi), or with layers mixed besides."""
    for material in bpy.data.materials:
        if (node := principled(material)) and view["model"] != "imported":
            node.distribution = "MULTI_GGX"
            if view["model"] == "mixed":
                mix_layers(material, view["told"][material.name])


def shield(lamp):
    """A black back. Cycles shines to both sides, glTF to one only: behind the Cornell box's lamp the ceiling would
    catch so much light that its fireflies, not the picture, would be measured."""
    black = bpy.data.materials.new("black")
    black.use_nodes = True
    principled(black).inputs["Base Color"].default_value = (0, 0, 0, 1)
    make_lambert(black)
    back = lamp.copy()
    back.data = lamp.data.copy()
    back.data.materials.clear()
    back.data.materials.append(black)
    for vertex in back.data.vertices:
        vertex.co -= 1e-4 * vertex.normal
    bpy.context.scene.collection.objects.link(back)


def set_up(view):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=view["scene"], convert_lighting_mode="COMPAT")  # 1 cd = 1 W/sr
    scene = bpy.context.scene
    for thing in [o for o in scene.objects if o.type == "CAMERA" or (o.type == "LIGHT" and not view["punctual"])]:
        bpy.data.objects.remove(thing)
    for light in bpy.data.lights:
        if light.type in ("POINT", "SPOT"):
            light.shadow_soft_size = 0
    if view["lambert"] != "none":
        for lamp in [o for o in scene.objects if o.type == "MESH" and shines(o.data.materials[0])]:
            shield(lamp)
        for material in bpy.data.materials:
            if is_lambert(material, view["lambert"]):
                make_lambert(material)
    if "model" in view:
        set_model(view)
    add_camera(view)
    add_environment(view["environment"], view["intensity"])

    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y = view["size"]
    render.resolution_percentage = 100
    render.use_persistent_data = True  # prepared once; what is timed leaves preparation out anyway
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth = "32"
    cycles.device = "CPU"
    cycles.use_denoising = False
    cycles.use_adaptive_sampling = False
    # Cycles counts bounces after the first surface, wavepath counts that one too.
    bounces = view["max_depth"] - 1
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = bounces
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.blur_glossy = 0
    cycles.pixel_filter_type = "BOX"  # one pixel wide


def main():
    set_up(json.loads(sys.stdin.readline()))
    scene = bpy.context.scene
    print("DONE Blender", bpy.app.version_string, scene.cycles.sampling_pattern, flush=True)
    for line in sys.stdin:
        job = json.loads(line)
        scene.cycles.samples = job["spp"]
        scene.cycles.seed = job["seed"]
        scene.render.filepath = job["output"]
        bpy.ops.render.render(write_still=True)
        print("DONE", flush=True)


main()
