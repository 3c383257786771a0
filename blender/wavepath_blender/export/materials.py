"""Materials that the glTF exporter does not know: simple ones are rewritten for it, the others are told."""

import bpy

# Read by the exporter, or without effect on a render.
KNOWN = {"OUTPUT_MATERIAL", "BSDF_PRINCIPLED", "TEX_IMAGE", "NORMAL_MAP", "UVMAP", "MAPPING", "TEX_COORD", "EMISSION",
         "SEPARATE_COLOR", "SEPRGB", "RGB", "VALUE", "REROUTE", "FRAME", "VERTEX_COLOR", "GROUP_INPUT"}


def simplify():
    for material in bpy.data.materials:
        if material.use_nodes and material.node_tree is not None:
            rewrite(material.node_tree)
            show_as_cycles(material)


def tell(meshes, told):
    used = {material for mesh in meshes for material in mesh.materials if material is not None}
    for material in sorted(used, key=lambda material: material.name):
        if material.use_nodes and material.node_tree is not None:
            tell_of(material, told)


def output_of(tree):
    return next((n for n in tree.nodes if n.type == "OUTPUT_MATERIAL" and n.is_active_output), None)


def rewrite(tree):
    """A lone node of another kind becomes the Principled one that is the same, or near to it."""
    output = output_of(tree)
    if output is None or not output.inputs["Surface"].links:
        return
    old = output.inputs["Surface"].links[0].from_node
    values = {"BSDF_DIFFUSE": {"Specular": 0.0, "Roughness": 1.0},
              "BSDF_GLOSSY": {"Metallic": 1.0},
              "BSDF_ANISOTROPIC": {"Metallic": 1.0},
              "BSDF_GLASS": {"Transmission": 1.0},
              "BSDF_TRANSPARENT": {"Alpha": 0.0, "Specular": 0.0}}.get(old.type)
    if values is None:
        return
    new = tree.nodes.new("ShaderNodeBsdfPrincipled")
    for name, value in values.items():
        socket_named(new, name).default_value = value
    for theirs, ours in (("Color", "Base Color"), ("Roughness", "Roughness"), ("IOR", "IOR"), ("Normal", "Normal")):
        if theirs not in old.inputs or ours in values:
            continue
        if theirs != "Normal":
            new.inputs[ours].default_value = old.inputs[theirs].default_value
        for link in list(old.inputs[theirs].links):
            tree.links.new(link.from_socket, new.inputs[ours])
    tree.links.new(new.outputs[0], output.inputs["Surface"])


def show_as_cycles(material):
    """Both sides of a surface, and alpha whatever Eevee does with it."""
    material.use_backface_culling = False
    output = output_of(material.node_tree)
    node = output.inputs["Surface"].links[0].from_node if output and output.inputs["Surface"].links else None
    alpha = node.inputs.get("Alpha") if node else None
    if alpha is not None and (alpha.links or alpha.default_value < 1) and material.blend_method == "OPAQUE":
        material.blend_method = "BLEND"


def socket_named(node, name):
    """Blender 4.0 renamed some."""
    later = {"Specular": "Specular IOR Level", "Transmission": "Transmission Weight", "Subsurface": "Subsurface Weight",
             "Sheen": "Sheen Weight", "Clearcoat": "Coat Weight", "Emission": "Emission Color"}
    return node.inputs.get(name) or node.inputs.get(later.get(name, name))


def tell_of(material, told):
    tree = material.node_tree
    output = output_of(tree)
    if output is None:
        return
    unknown = sorted({node.bl_label for node in reached(output) if node.type not in KNOWN})
    if unknown:
        told.add("material nodes without a word in glTF, %s: left out" % ", ".join(unknown),
                 material.name)
    for socket, what in (("Volume", "volume"), ("Displacement", "displacement")):
        if output.inputs[socket].links:
            told.add("%s of a material: left out" % what, material.name)
    for node in reached(output):
        if node.type == "BSDF_PRINCIPLED":
            for name, what in (("Subsurface", "subsurface scattering"), ("Anisotropic", "anisotropy")):
                socket = socket_named(node, name)
                if name == "Anisotropic" and bpy.app.version >= (4, 0, 0):
                    continue
                if socket is not None and (socket.links or socket.default_value > 0):
                    told.add("%s: left out" % what, material.name)


def reached(output):
    return reached_from(output.inputs["Surface"])


def reached_from(socket):
    """Nodes that it depends on."""
    found, todo = [], [socket]
    while todo:
        for link in todo.pop().links:
            if link.from_node not in found:
                found.append(link.from_node)
                todo += list(link.from_node.inputs)
    return found
