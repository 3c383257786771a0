"""Bakes what feeds a Principled node and has no word in glTF: Cycles paints it on image textures, for each mesh."""

import bpy

from . import materials

LAYER = "wavepath bake"
COLOURS = ("Base Color", "Emission", "Emission Color")
SOCKETS = COLOURS + ("Metallic", "Roughness", "Transmission", "Transmission Weight")
CHANNELS = {"Metallic": 2, "Roughness": 1}  # of the textures that glTF has for them


def replace(found, size):
    scene = found.flat
    bpy.context.window.scene = scene
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples = "CPU", 4
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.render.bake.margin = max(size // 128, 2)
    done = set()
    for thing in list(scene.objects):
        mesh = thing.data
        if mesh.name in done or not any(lost_sockets(material) for material in mesh.materials):
            continue
        done.add(mesh.name)
        for index, material in enumerate(mesh.materials):
            if lost_sockets(material):
                mesh.materials[index] = material.copy()
        bake_mesh(thing, size)


def lost_sockets(material):
    """Of the material's one Principled node, by name."""
    if material is None or not material.use_nodes or material.node_tree is None:
        return {}
    node = principled(material)
    if node is None:
        return {}
    return {socket.name: socket for socket in node.inputs
            if socket.links and socket.name in SOCKETS + ("Normal",) and is_lost(socket)}


def principled(material):
    output = materials.output_of(material.node_tree)
    links = output.inputs["Surface"].links if output else ()
    return links[0].from_node if links and links[0].from_node.type == "BSDF_PRINCIPLED" else None


def is_lost(socket):
    return any(node.type not in materials.KNOWN for node in materials.reached_from(socket))


def bake_mesh(thing, size):
    unwrap(thing)
    todo = [lost_sockets(material) for material in thing.data.materials]
    for name in sorted({name for sockets in todo for name in sockets}):
        images = [paint_to(material, name, size if name in sockets else 4)
                  for material, sockets in zip(thing.data.materials, todo)]
        kept = [redirect(material, sockets[name]) if name in sockets and name != "Normal" else None
                for material, sockets in zip(thing.data.materials, todo)]
        bpy.ops.object.bake(type="NORMAL" if name == "Normal" else "EMIT", use_clear=True)
        for material, link, image, sockets in zip(thing.data.materials, kept, images, todo):
            if material is None:
                continue
            tree = material.node_tree
            if link is not None:
                tree.links.new(link, materials.output_of(tree).inputs["Surface"])
            if name in sockets:
                read_from(tree, image, lost_sockets(material)[name])
            else:
                tree.nodes.remove(image)


def unwrap(thing):
    """A layer of coordinates in which no two places of the surface share a texel. What is rendered keeps its own."""
    layers = thing.data.uv_layers
    shown = next((layer.name for layer in layers if layer.active_render), None)
    layers.new(name=LAYER)
    layers.active = layers[LAYER]
    if shown:
        layers[shown].active_render = True
    for other in bpy.context.view_layer.objects:
        other.select_set(other == thing)
    bpy.context.view_layer.objects.active = thing
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.uv.smart_project(island_margin=0.01)
    bpy.ops.object.mode_set(mode="OBJECT")


def paint_to(material, name, size):
    """An image node that the bake paints to."""
    if material is None:
        return None
    if not material.use_nodes:
        material.use_nodes = True
    image = bpy.data.images.new("%s %s" % (material.name, name), size, size)
    image.colorspace_settings.name = "sRGB" if name in COLOURS else "Non-Color"
    nodes = material.node_tree.nodes
    node = nodes.new("ShaderNodeTexImage")
    node.image = image
    for other in nodes:
        other.select = False
    node.select = True
    nodes.active = node
    return node


def redirect(material, socket):
    """Lets the material shine by what feeds the socket. Gives what was shown before."""
    tree = material.node_tree
    surface = materials.output_of(tree).inputs["Surface"]
    before = surface.links[0].from_socket
    emission = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(socket.links[0].from_socket, emission.inputs["Color"])
    tree.links.new(emission.outputs[0], surface)
    return before


def read_from(tree, node, socket):
    node.image.pack()
    place = tree.nodes.new("ShaderNodeUVMap")
    place.uv_map = LAYER
    tree.links.new(place.outputs[0], node.inputs["Vector"])
    value = node.outputs["Color"]
    if socket.name == "Normal":
        turn = tree.nodes.new("ShaderNodeNormalMap")
        turn.uv_map = LAYER
        tree.links.new(value, turn.inputs["Color"])
        value = turn.outputs["Normal"]
    elif socket.name in CHANNELS:
        kind = "ShaderNodeSeparateColor" if hasattr(bpy.types, "ShaderNodeSeparateColor") else "ShaderNodeSeparateRGB"
        parts = tree.nodes.new(kind)
        tree.links.new(value, parts.inputs[0])
        value = parts.outputs[CHANNELS[socket.name]]
    tree.links.new(value, socket)
