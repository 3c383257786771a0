"""Motion blur: two files of the same scene become one, with an animation from the first pose to the second.

Poses are evaluated ones, so that all that moves or deforms objects is in them: parents, drivers, physics, modifiers.
"""

import mathutils
import numpy

from . import gltf

FLOAT = 5126
NODE_PATHS = {"translation": ("VEC3", [0, 0, 0]), "rotation": ("VEC4", [0, 0, 0, 1]), "scale": ("VEC3", [1, 1, 1])}


def join(path, later_path, told):
    """Whether something moves. The result replaces the first file."""
    document, binary = gltf.read_glb(path)
    later, later_binary = gltf.read_glb(later_path)
    nodes, later_nodes = document["nodes"], later["nodes"]
    if [(n.get("name"), n.get("mesh")) for n in nodes] != [(n.get("name"), n.get("mesh")) for n in later_nodes]:
        told.add("motion blur where objects come or go: off", "shutter")
        return False
    builder = Builder(document, bytearray(binary))
    times = None
    channels, samplers = [], []

    def animate(node, key, values, kind):
        nonlocal times
        if times is None:
            times = builder.add(numpy.array([0, 1], numpy.float32), "SCALAR")
        samplers.append({"input": times, "output": builder.add(numpy.array(values, numpy.float32), kind)})
        channels.append({"sampler": len(samplers) - 1, "target": {"node": node, "path": key}})

    deformed = {index: deform(builder, index, later, later_binary, told)
                for index in range(len(document.get("meshes", [])))}
    for index, (node, other) in enumerate(zip(nodes, later_nodes)):
        if "mesh" in node:
            for key, (kind, rest) in NODE_PATHS.items():
                before, after = node.get(key, rest), other.get(key, rest)
                if before != after:
                    animate(index, key, [before, after], kind)
            if deformed[node["mesh"]]:
                animate(index, "weights", [0, 1], "SCALAR")
        elif node.get("matrix") != other.get("matrix"):
            node["matrix"] = middle(node["matrix"], other["matrix"])
            told.add("camera or lamp that moves while the shutter is open: no blur", node["name"])
    if not channels:
        return False
    document["animations"] = [{"name": "shutter", "channels": channels, "samplers": samplers}]
    gltf.write_glb(path, document, bytes(builder.binary))
    return True


def deform(builder, index, later, later_binary, told):
    """A morph target to the later shape. Whether the shapes differ."""
    mesh = builder.document["meshes"][index]
    others = later["meshes"][index]["primitives"] if index < len(later.get("meshes", [])) else []
    moved = []
    for primitive, other in zip(mesh["primitives"], others):
        before = read(builder.document, builder.binary, primitive["attributes"]["POSITION"])
        after = read(later, later_binary, other["attributes"]["POSITION"])
        if before.shape != after.shape:
            break
        moved.append(after - before)
    if len(moved) != len(mesh["primitives"]) or len(others) != len(moved):
        told.add("motion blur of a shape whose vertices come or go: off", mesh["name"])
        return False
    if not any(values.any() for values in moved):
        return False
    for primitive, values in zip(mesh["primitives"], moved):
        primitive["targets"] = [{"POSITION": builder.add(values, "VEC3")}]
    mesh["weights"] = [0]
    return True


def middle(matrix, other):
    """Columns, as glTF has them."""
    first, second = (mathutils.Matrix([values[row::4] for row in range(4)]) for values in (matrix, other))
    between = first.lerp(second, 0.5)
    return [value for column in between.transposed() for value in column]


def read(document, binary, accessor):
    """Positions, which the exporter stores as tight floats."""
    found = document["accessors"][accessor]
    view = document["bufferViews"][found["bufferView"]]
    start = view.get("byteOffset", 0) + found.get("byteOffset", 0)
    return numpy.frombuffer(bytes(binary), "<f4", found["count"] * 3, start).reshape(-1, 3)


class Builder:
    def __init__(self, document, binary):
        self.document, self.binary = document, binary
        for key in ("accessors", "bufferViews", "buffers"):
            document.setdefault(key, [])
        if not document["buffers"]:
            document["buffers"].append({"byteLength": 0})

    def add(self, values, kind):
        """The accessor of these floats."""
        self.binary += b"\0" * (-len(self.binary) % 4)
        start, data = len(self.binary), numpy.ascontiguousarray(values, "<f4").tobytes()
        self.binary += data
        self.document["buffers"][0]["byteLength"] = len(self.binary)
        self.document["bufferViews"].append({"buffer": 0, "byteOffset": start, "byteLength": len(data)})
        rows = numpy.asarray(values, numpy.float32).reshape(len(values), -1)
        self.document["accessors"].append({
            "bufferView": len(self.document["bufferViews"]) - 1, "componentType": FLOAT, "count": len(rows),
            "type": kind, "min": rows.min(axis=0).tolist(), "max": rows.max(axis=0).tolist()})
        return len(self.document["accessors"]) - 1
