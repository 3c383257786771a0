"""Writes small glTF 2.0 files with the same bytes on every machine; standard library only."""

import base64
import json
import math
import struct

FLOAT, UINT16, UINT32 = 5126, 5123, 5125


def add(a, b):
    return tuple(x + y for x, y in zip(a, b))


def sub(a, b):
    return tuple(x - y for x, y in zip(a, b))


def scale(a, s):
    return tuple(x * s for x in a)


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def normalize(a):
    return scale(a, 1 / math.sqrt(dot(a, a)))


def tidy(value):
    """Seven decimals: hides the last-bit differences between maths libraries, keeps float precision."""
    if isinstance(value, float):
        return round(value, 7) + 0.0
    if isinstance(value, (list, tuple)):
        return [tidy(v) for v in value]
    if isinstance(value, dict):
        return {k: tidy(v) for k, v in value.items()}
    return value


class Shape:
    """Triangles: positions, indices, and optionally unit normals and texture coordinates, one a position."""

    def __init__(self, positions, indices, normals=None, uvs=None):
        self.positions, self.indices, self.normals, self.uvs = positions, indices, normals, uvs

    def triangles(self):
        p, i = self.positions, self.indices
        return [(p[i[k]], p[i[k + 1]], p[i[k + 2]]) for k in range(0, len(i), 3)]

    def flipped(self):
        i = self.indices
        turned = [v for k in range(0, len(i), 3) for v in (i[k], i[k + 2], i[k + 1])]
        return Shape(self.positions, turned, self.normals and [scale(n, -1.0) for n in self.normals], self.uvs)

    def moved(self, offset, factor=1.0):
        return Shape([add(scale(p, factor), offset) for p in self.positions], self.indices, self.normals, self.uvs)


def quad(a, b, c, d):
    """Two triangles; the front is where a, b, c, d run counter-clockwise."""
    return Shape([a, b, c, d], [0, 1, 2, 0, 2, 3])


def join(shapes):
    positions, indices = [], []
    for shape in shapes:
        indices += [len(positions) + i for i in shape.indices]
        positions += shape.positions
    return Shape(positions, indices)


def prism(base, height):
    """A closed prism that stands on `base`: corners (x, z) counter-clockwise as seen from above, at y = 0."""
    n = len(base)
    lower = [(x, 0.0, z) for x, z in base]
    upper = [(x, height, z) for x, z in base]
    sides = [quad(lower[i], lower[(i + 1) % n], upper[(i + 1) % n], upper[i]) for i in range(n)]
    fan = [v for i in range(1, n - 1) for v in (0, i, i + 1)]
    return join(sides + [Shape(upper, fan), Shape(lower, fan).flipped()])


def box(lo, hi):
    x0, z0, x1, z1 = lo[0], lo[2], hi[0], hi[2]
    return prism([(x0, z0), (x0, z1), (x1, z1), (x1, z0)], hi[1] - lo[1]).moved((0.0, lo[1], 0.0))


def disc(radius, height, segments):
    """A regular polygon facing down, centred over the origin."""
    ring = [(radius * math.cos(t), height, radius * math.sin(t))
            for t in (2 * math.pi * i / segments for i in range(segments))]
    return Shape(ring, [v for i in range(1, segments - 1) for v in (0, i, i + 1)])


def sphere(rings=32, smooth=True):
    """The unit sphere, 2 * rings around; its vertices lie on it."""
    around = 2 * rings
    positions = [(0.0, 1.0, 0.0)]
    for i in range(1, rings):
        t = math.pi * i / rings
        positions += [(math.sin(t) * math.cos(p), math.cos(t), math.sin(t) * math.sin(p))
                      for p in (2 * math.pi * j / around for j in range(around))]
    positions.append((0.0, -1.0, 0.0))
    indices, last = [], len(positions) - 1
    for j in range(around):
        k = (j + 1) % around
        indices += [0, 1 + k, 1 + j, last, last - around + j, last - around + k]
        for i in range(rings - 2):
            a, b = 1 + i * around + j, 1 + i * around + k
            indices += [a, b, b + around, a, b + around, a + around]
    return Shape(positions, indices, positions if smooth else None)


class Gltf:
    """A glTF file in the making. Methods return the index of what they added."""

    def __init__(self, name):
        self.doc = {"asset": {"version": "2.0", "generator": "wavepath scenes/generate.py"}, "scene": 0,
                    "scenes": [{"name": name, "nodes": []}]}
        self.data = bytearray()

    def append(self, key, value):
        items = self.doc.setdefault(key, [])
        items.append(value)
        return len(items) - 1

    def extend(self, target, **extensions):
        for name, value in extensions.items():
            target.setdefault("extensions", {})[name] = value
            used = self.doc.setdefault("extensionsUsed", [])
            if name not in used:
                used.append(name)
                used.sort()

    def view(self, data):
        self.data += bytes(-len(self.data) % 4)
        self.data += data
        return self.append("bufferViews",
                           {"buffer": 0, "byteOffset": len(self.data) - len(data), "byteLength": len(data)})

    def accessor(self, rows, kind):
        rows = tidy(rows)
        data = struct.pack(f"<{sum(map(len, rows))}f", *(v for row in rows for v in row))
        entry = {"bufferView": self.view(data), "componentType": FLOAT, "count": len(rows), "type": kind}
        if kind == "VEC3":  # the bounds must be those of the floats as stored
            stored = list(zip(*[iter(struct.unpack(f"<{3 * len(rows)}f", data))] * 3))
            entry["min"], entry["max"] = [list(map(f, zip(*stored))) for f in (min, max)]
        return self.append("accessors", entry)

    def shape(self, shape):
        """The accessors of a shape, to be shared by any number of meshes."""
        attributes = {"POSITION": self.accessor(shape.positions, "VEC3")}
        if shape.normals:
            attributes["NORMAL"] = self.accessor(shape.normals, "VEC3")
        if shape.uvs:
            attributes["TEXCOORD_0"] = self.accessor(shape.uvs, "VEC2")
        small = len(shape.positions) < 65536
        data = struct.pack(f"<{len(shape.indices)}{'H' if small else 'I'}", *shape.indices)
        indices = self.append("accessors", {"bufferView": self.view(data), "componentType": UINT16 if small else UINT32,
                                            "count": len(shape.indices), "type": "SCALAR"})
        return {"attributes": attributes, "indices": indices}

    def node(self, **properties):
        index = self.append("nodes", tidy(properties))
        self.doc["scenes"][0]["nodes"].append(index)
        return index

    def mesh(self, name, shape, material, **placement):
        """`shape`: a Shape, or what shape() returned."""
        primitive = dict(shape if isinstance(shape, dict) else self.shape(shape), material=material)
        return self.node(name=name, mesh=self.append("meshes", {"name": name, "primitives": [primitive]}), **placement)

    def material(self, name, color=(1.0, 1.0, 1.0), alpha=1.0, metallic=0.0, roughness=1.0, **extra):
        material = {"name": name, "pbrMetallicRoughness": tidy(
            {"baseColorFactor": [*color, alpha], "metallicFactor": metallic, "roughnessFactor": roughness})}
        material.update(extra)
        return self.append("materials", material)

    def lambert(self, name, color, **extra):
        """A dielectric without its coat is Lambert's surface."""
        index = self.material(name, color, **extra)
        self.extend(self.doc["materials"][index], KHR_materials_specular={"specularFactor": 0.0})
        return index

    def emitter(self, name, radiance, color=(0.0, 0.0, 0.0)):
        strength = max(max(radiance), 1.0)
        index = self.lambert(name, color, emissiveFactor=tidy(scale(radiance, 1 / strength)))
        if strength > 1.0:
            self.extend(self.doc["materials"][index], KHR_materials_emissive_strength={"emissiveStrength": strength})
        return index

    def glass(self, name, ior=1.5, color=(1.0, 1.0, 1.0), roughness=0.0, attenuation=None, distance=1.0):
        """A closed body; `attenuation`: what is left of white light after `distance` metres."""
        index = self.material(name, color, roughness=roughness)
        volume = {"thicknessFactor": 1.0}
        if attenuation:
            volume.update(attenuationColor=list(attenuation), attenuationDistance=distance)
        self.extend(self.doc["materials"][index], KHR_materials_transmission={"transmissionFactor": 1.0},
                    KHR_materials_ior={"ior": ior}, KHR_materials_volume=volume)
        return index

    def pane(self, name, color=(1.0, 1.0, 1.0), roughness=0.0):
        """Thin glass, which light passes unbent."""
        index = self.material(name, color, roughness=roughness, doubleSided=True)
        self.extend(self.doc["materials"][index], KHR_materials_transmission={"transmissionFactor": 1.0})
        return index

    def camera(self, eye, look_at, up=(0.0, 1.0, 0.0), yfov=None, extent=None, aspect=None):
        """Perspective with `yfov` radians, or orthographic with the half width and height `extent` metres."""
        z = normalize(sub(eye, look_at))
        x = normalize(cross(up, z))
        y = cross(z, x)
        if yfov:
            camera = {"type": "perspective", "perspective": {"yfov": yfov, "znear": 0.01}}
            if aspect:
                camera["perspective"]["aspectRatio"] = aspect
        else:
            camera = {"type": "orthographic",
                      "orthographic": {"xmag": extent, "ymag": extent, "znear": 0.0, "zfar": 1000.0}}
        return self.node(name="camera", camera=self.append("cameras", tidy(camera)),
                         matrix=[*x, 0.0, *y, 0.0, *z, 0.0, *eye, 1.0])

    def light(self, kind, intensity, color=(1.0, 1.0, 1.0), position=(0.0, 0.0, 0.0), direction=None, spot=None,
              range=None):
        """Candela (point, spot) or lux (directional); `direction` in which it shines; `spot`: half angles; `range`:
        where it ends."""
        light = {"type": kind, "intensity": intensity, "color": list(color)}
        if spot:
            light["spot"] = {"innerConeAngle": spot[0], "outerConeAngle": spot[1]}
        if range:
            light["range"] = range
        lights = self.doc.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        lights.append(tidy(light))
        properties = {"name": kind, "translation": list(position)}
        if direction:  # turn -z to `direction`
            d = normalize(direction)
            axis = cross((0.0, 0.0, -1.0), d)
            w = 1.0 + dot((0.0, 0.0, -1.0), d)
            length = math.sqrt(dot(axis, axis) + w * w)
            properties["rotation"] = [*scale(axis, 1 / length), w / length]
        node = self.doc["nodes"][self.node(**properties)]
        self.extend(node, KHR_lights_punctual={"light": len(lights) - 1})

    def animate(self, name, node, path, keys):
        """Adds a channel to the animation of that name. `path`: translation, rotation or scale of the node; `keys`:
        seconds and value of each."""
        animations = self.doc.setdefault("animations", [])
        animation = next((a for a in animations if a["name"] == name), None)
        if not animation:
            animation = {"name": name, "channels": [], "samplers": []}
            animations.append(animation)
        times, values = zip(*sorted(keys.items()))
        seconds = self.accessor([(float(t),) for t in times], "SCALAR")
        self.doc["accessors"][seconds].update(min=[float(times[0])], max=[float(times[-1])])
        output = self.accessor(values, "VEC4" if path == "rotation" else "VEC3")
        animation["samplers"].append({"input": seconds, "output": output, "interpolation": "LINEAR"})
        animation["channels"].append(
            {"sampler": len(animation["samplers"]) - 1, "target": {"node": node, "path": path}})

    def luminaire(self, text, color=(1.0, 1.0, 1.0), multiplier=1.0, position=(0.0, 0.0, 0.0), rotation=None):
        """A lamp of EXT_lights_ies; `text`: the file of its profile; `rotation`: quaternion."""
        lights = self.doc.setdefault("extensions", {}).setdefault("EXT_lights_ies", {"lights": []})["lights"]
        data = base64.b64encode(text.encode()).decode()
        lights.append({"uri": "data:application/x-ies-lm-63;base64," + data})
        properties = {"name": "luminaire", "translation": list(position)}
        if rotation:
            properties["rotation"] = list(rotation)
        node = self.doc["nodes"][self.node(**properties)]
        self.extend(node, EXT_lights_ies={"light": len(lights) - 1, "color": list(color), "multiplier": multiplier})

    def expect(self, about, expected, render, **terms):
        """What tests/analytic_test.cpp and a reader need: see README.md in this folder."""
        self.doc["extras"] = {"wavepath": {"about": about, "render": render, "expected": tidy(list(expected)), **terms}}

    def text(self):
        """A .gltf with the buffer inside; bytes that differ from version to version of Python are not used."""
        uri = "data:application/octet-stream;base64," + base64.b64encode(bytes(self.data)).decode()
        doc = dict(self.doc, buffers=[{"byteLength": len(self.data), "uri": uri}])
        return (json.dumps(doc, indent=1) + "\n").encode()

    def binary(self):
        """The same as a .glb."""
        data = bytes(self.data) + bytes(-len(self.data) % 4)
        text = json.dumps(dict(self.doc, buffers=[{"byteLength": len(data)}]), separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        body = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data
        return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body
