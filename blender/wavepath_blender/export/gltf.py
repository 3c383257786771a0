"""glTF: by Blender's exporter, then completed by what that leaves out: camera, lamps, names."""

import json
import math
import struct

import bpy
import mathutils

Y_UP = mathutils.Matrix(((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1)))
JSON_CHUNK, BINARY_CHUNK = 0x4E4F534A, 0x004E4942

# Of the exporter, where this version has them. COMPAT: what is W/m^2 in Blender has the same number in glTF.
OPTIONS = {
    "export_format": "GLB", "export_apply": False, "export_animations": False, "export_skins": False,
    "export_morph": False, "export_cameras": False, "export_lights": False, "export_extras": False,
    "export_yup": True, "export_normals": True, "export_texcoords": True, "export_tangents": False,
    "export_materials": "EXPORT", "use_active_scene": True, "use_renderable": False, "use_visible": False,
    "convert_lighting_mode": "COMPAT", "export_import_convert_lighting_mode": "COMPAT",
    "export_vertex_color": "MATERIAL", "export_attributes": False, "will_save_settings": False,
    "export_original_specular": False, "export_shared_accessors": False, "export_try_sparse_sk": False,
}


def write(path, flat):
    known = bpy.ops.export_scene.gltf.get_rna_type().properties
    options = {name: value for name, value in OPTIONS.items() if name in known}
    bpy.context.window.scene = flat
    bpy.context.view_layer.update()
    if not flat.objects:
        write_glb(path, {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}]}, b"")
        return
    bpy.ops.export_scene.gltf(filepath=path, check_existing=False, **options)


def complete(path, found, shining):
    """Adds to the file. Gives the pass indices of nodes and materials, in their order there."""
    document, binary = read_glb(path)
    nodes = document.setdefault("nodes", [])
    pass_indices = []
    for node in nodes:
        name, index = found.originals.get(node.get("name"), (node.get("name"), 0))
        node["name"] = name
        pass_indices.append(index)
    materials = document.get("materials", [])
    for material in materials:
        if material["name"] in shining.radiance:
            make_shine(document, material, shining.radiance[material["name"]])
        drop_dark_layer(material)
        make_solid(document, material)
    roots = document["scenes"][document.get("scene", 0)].setdefault("nodes", [])
    if found.camera:
        document["cameras"] = [lens_of(found.camera)]
        add_node(nodes, roots, found.camera.name, found.camera.matrix, {"camera": 0})
    if shining.lights:
        lights = document.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {}).setdefault("lights", [])
        use(document, "KHR_lights_punctual")
        for name, matrix, light in shining.lights:
            lights.append(light)
            extension = {"KHR_lights_punctual": {"light": len(lights) - 1}}
            add_node(nodes, roots, name, matrix, {"extensions": extension})
    write_glb(path, document, binary)
    known = bpy.data.materials
    return {"textures": len(document.get("textures", [])), "object_indices": pass_indices,
            "material_indices": [known[m["name"]].pass_index if m["name"] in known else 0 for m in materials]}


def make_shine(document, material, radiance):
    largest = max(radiance)
    material.pop("doubleSided", None)
    material["pbrMetallicRoughness"] = {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0}
    material["emissiveFactor"] = [value / largest for value in radiance]
    material["extensions"] = {"KHR_materials_emissive_strength": {"emissiveStrength": largest},
                              "KHR_materials_specular": {"specularFactor": 0}}
    for extension in material["extensions"]:
        use(document, extension)


def drop_dark_layer(material):
    """Without specular reflection Cycles has no layer there. A black one of glTF still shines at grazing angles."""
    specular = material.get("extensions", {}).get("KHR_materials_specular", {})
    if specular.get("specularColorFactor") == [0, 0, 0]:
        specular["specularFactor"] = 0


def make_solid(document, material):
    """What transmits light refracts it in Blender. In glTF it is thin unless it has a thickness."""
    extensions = material.get("extensions", {})
    if "KHR_materials_transmission" in extensions and "KHR_materials_volume" not in extensions:
        extensions["KHR_materials_volume"] = {"thicknessFactor": 1}
        use(document, "KHR_materials_volume")


def lens_of(camera):
    projection = camera.projection
    if camera.data.type == "ORTHO":
        return {"type": "orthographic", "name": camera.name, "orthographic": {
            "xmag": 1 / projection[0][0], "ymag": 1 / projection[1][1], "znear": camera.data.clip_start,
            "zfar": camera.data.clip_end}}
    return {"type": "perspective", "name": camera.name, "perspective": {
        "yfov": 2 * math.atan(1 / projection[1][1]), "aspectRatio": projection[1][1] / projection[0][0],
        "znear": camera.data.clip_start}}


def add_node(nodes, roots, name, matrix, content):
    columns = (Y_UP @ matrix).transposed()
    nodes.append({"name": name, "matrix": [value for column in columns for value in column], **content})
    roots.append(len(nodes) - 1)


def use(document, extension):
    used = document.setdefault("extensionsUsed", [])
    if extension not in used:
        used.append(extension)


def read_glb(path):
    with open(path, "rb") as file:
        data = file.read()
    length, _ = struct.unpack_from("<2I", data, 12)
    document = json.loads(data[20 : 20 + length])
    rest = 20 + length
    binary = data[rest + 8 : rest + 8 + struct.unpack_from("<I", data, rest)[0]] if rest + 8 <= len(data) else b""
    return document, binary


def write_glb(path, document, binary):
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<2I", len(text), JSON_CHUNK) + text
    if binary:
        chunks += struct.pack("<2I", len(binary), BINARY_CHUNK) + binary
    with open(path, "wb") as file:
        file.write(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
