#!/usr/bin/env python3
"""Writes a scene that is hard for shadow techniques, as one .glb; the same bytes every time.

  sphere_lamp FILE.glb             the Cornell box, lit by a ball that hangs in its middle: penumbrae of all widths
  tree FILE.glb                    a tree with leaves cut out of cards by alpha, under a sun: many thin layers
  rails FILE.glb                   a balustrade of bars and thinner wires under a low sun: casters finer than texels
  room_spot ROOM.glb FILE.glb      HotelRoom in metres, lit by one spot under its ceiling: large and small bodies
"""

import json
import math
import pathlib
import random
import struct
import sys

from gltf import Gltf, add, box, cross, join, normalize, quad, scale, sphere, sub, Shape
from pictures import cornell_box
from png import png


def sphere_lamp():
    return cornell_box("Cornell box with a ball", sphere(8, smooth=False).moved((0.278, 0.40, 0.26), 0.05),
                       (60.0, 50.0, 35.0))


def tube(start, end, first, last, sides):
    """An open tube around a line: its radii at both ends."""
    along = normalize(sub(end, start))
    x = normalize(cross(along, (0.0, 0.0, 1.0) if abs(along[2]) < 0.9 else (1.0, 0.0, 0.0)))
    y = cross(along, x)
    turns = [2 * math.pi * i / sides for i in range(sides)]
    ring = [[add(middle, add(scale(x, radius * math.cos(t)), scale(y, radius * math.sin(t)))) for t in turns]
            for middle, radius in ((start, first), (end, last))]
    indices = []
    for i in range(sides):
        j = (i + 1) % sides
        indices += [i, j, sides + j, i, sides + j, sides + i]
    return Shape(ring[0] + ring[1], indices)


def leaf_card():
    """Five leaves on a stem; what is between them is transparent."""
    def is_leaf(x, y):
        u, v = (x + 0.5) / 64, (y + 0.5) / 64
        if abs(u - 0.5) < 0.015 and v > 0.3:
            return True
        for i in range(5):  # tip, and two pairs
            angle = (0.0, 0.9, -0.9, 1.2, -1.2)[i]
            at = (0.5 + 0.20 * math.sin(angle), (0.30, 0.42, 0.42, 0.70, 0.70)[i] - 0.1 * math.cos(angle))
            dx, dy = u - at[0], v - at[1]
            along = dx * math.sin(angle) - dy * math.cos(angle)
            across = dx * math.cos(angle) + dy * math.sin(angle)
            if (along / 0.19) ** 2 + (across / 0.08) ** 2 < 1.0:
                return True
        return False

    return png(64, 64, [(60, 110, 40), (60, 110, 40)], lambda x, y: 1 if is_leaf(x, y) else 0, alpha=[0])


def tree():
    g = Gltf("tree")
    dice = random.Random(15)
    wood, cards = [], [[], [], []]

    def leaves(at, along):
        for _ in range(6):
            size = 0.16 + 0.10 * dice.random()
            up = normalize(add(along, [dice.uniform(-1.2, 1.2) for _ in range(3)]))
            side = normalize(cross(up, [dice.uniform(-1, 1) for _ in range(3)]))
            start = add(at, [dice.uniform(-0.12, 0.12) for _ in range(3)])
            a, b = sub(start, scale(side, size / 2)), add(start, scale(side, size / 2))
            first = len(cards[0])
            cards[0] += [a, b, add(b, scale(up, size)), add(a, scale(up, size))]
            cards[1] += [(0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0)]
            cards[2] += [first, first + 1, first + 2, first, first + 2, first + 3]

    def branch(start, along, length, radius, level):
        end = add(start, scale(along, length))
        wood.append(tube(start, end, radius, 0.65 * radius, 6))
        if level == 0:
            return leaves(end, along)
        for i in range(3 if level > 1 else 4):
            turn = [dice.uniform(-1, 1) for _ in range(3)]
            bent = normalize(add(add(along, scale(turn, 0.75)), (0.0, 0.18, 0.0)))
            branch(add(start, scale(along, length * (1.0 if i < 2 else dice.uniform(0.6, 0.9)))), bent,
                   length * dice.uniform(0.62, 0.78), 0.6 * radius, level - 1)
        return None

    branch((0.0, 0.0, 0.0), (0.0, 1.0, 0.0), 1.4, 0.13, 6)
    image = g.append("images", {"name": "leaves", "mimeType": "image/png", "bufferView": g.view(leaf_card())})
    leaf = g.material("leaves", alphaMode="MASK", alphaCutoff=0.5, doubleSided=True)
    g.doc["materials"][leaf]["pbrMetallicRoughness"]["baseColorTexture"] = {
        "index": g.append("textures", {"source": image})}
    ground = quad((-8.0, 0.0, -8.0), (-8.0, 0.0, 8.0), (8.0, 0.0, 8.0), (8.0, 0.0, -8.0))
    g.mesh("ground", ground, g.lambert("ground", (0.5, 0.46, 0.4)))
    g.mesh("wood", join(wood), g.lambert("wood", (0.25, 0.17, 0.1)))
    g.mesh("leaves", Shape(cards[0], cards[2], uvs=cards[1]), leaf)
    g.light("directional", 3.0, direction=(-0.55, -1.0, -0.35))
    g.camera((2.0, 2.2, 6.2), (0.0, 1.55, 0.0), yfov=0.75)
    return g


def rails():
    g = Gltf("rails")
    stone, steel = g.lambert("stone", (0.6, 0.58, 0.55)), g.lambert("steel", (0.3, 0.32, 0.35))
    g.mesh("floor", box((-4.0, -0.2, -3.0), (4.0, 0.0, 3.0)), stone)
    g.mesh("wall", box((-4.0, 0.0, -3.2), (4.0, 2.6, -3.0)), stone)
    bars = [box((x - 0.006, 0.0, 0.994), (x + 0.006, 1.0, 1.006))
            for x in (-3.6 + 0.12 * i for i in range(61))]
    bars += [tube((-3.6, y, 1.3), (3.6, y, 1.3), 0.0015, 0.0015, 6) for y in (0.1 * k for k in range(1, 10))]
    bars += [box((x - 0.02, 0.0, 1.28), (x + 0.02, 1.0, 1.32)) for x in (-3.6, -1.2, 1.2, 3.6)]
    bars += [box((-3.7, 1.0, 0.97), (3.7, 1.03, 1.03))]
    g.mesh("balustrade", join(bars), steel)
    g.light("directional", 3.0, direction=(-0.45, -0.55, -1.0))
    g.camera((1.6, 1.9, 4.6), (-0.3, 0.35, -0.6), yfov=0.8)
    return g


def room_spot(source):
    """`source`: HotelRoom-plain.glb, whose units are millimetres and which has neither lights nor cameras."""
    data = source.read_bytes()
    length = struct.unpack("<I", data[12:16])[0]
    document = json.loads(data[20:20 + length])
    g = Gltf("HotelRoom with a spot")
    g.data = bytearray(data[28 + length:])
    for key, value in document.items():
        if key not in ("buffers", "asset", "scene"):
            g.doc[key] = value
    g.doc["asset"].update(document["asset"], generator=g.doc["asset"]["generator"])
    roots = g.doc["scenes"][0]["nodes"]
    g.doc["scenes"] = [{"name": "HotelRoom with a spot", "nodes": []}]
    g.node(name="millimetres", scale=[0.001, 0.001, 0.001], children=roots)
    g.light("spot", 40.0, position=(9.6, 2.05, -6.6), direction=(-0.2, -1.0, 0.1), spot=(0.7, 1.0))
    g.camera((12.4, 1.7, -8.2), (9.2, 0.3, -6.2), yfov=0.9)
    return g


SCENES = {"sphere_lamp": sphere_lamp, "tree": tree, "rails": rails, "room_spot": room_spot}


def main():
    name, files = (sys.argv[1] if len(sys.argv) > 1 else ""), [pathlib.Path(p) for p in sys.argv[2:]]
    if name not in SCENES or len(files) != (2 if name == "room_spot" else 1):
        sys.exit(f"usage: shadow_scenes.py {'|'.join(SCENES)} [ROOM.glb] FILE.glb")
    files[-1].parent.mkdir(parents=True, exist_ok=True)
    files[-1].write_bytes(SCENES[name](*files[:-1]).binary())
    print(files[-1])


if __name__ == "__main__":
    main()
