#!/usr/bin/env python3
"""Scenes that nobody tuned: small ones, thrown together by seed, to judge what `render` decides by itself.

Seven kinds of light and how open a scene is go by turns; materials, detail and places by chance. The same seed gives
the same bytes. Even seeds are for tuning, odd ones only for judging. Prints what it wrote, a line a scene; see --help.
"""

import argparse
import json
import math
import pathlib
import random
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "scenes"))

from gltf import Gltf, Shape, box, join, normalize, quad, scale, sphere  # noqa: E402
from png import png  # noqa: E402
from rooms import wall_x, wall_z  # noqa: E402

COUNT = 28
LIGHTS = ("lamp", "lamps", "sun", "sky", "map", "window", "hidden")
# How open a scene may be under each kind of light.
OPENNESS = {"lamp": ("open", "half", "closed"), "lamps": ("open", "half", "closed"), "sun": ("open", "half", "closed"),
            "sky": ("open", "half", "open"), "map": ("open", "half", "closed"), "window": ("closed",),
            "hidden": ("half", "closed", "open")}
DETAILS = ("plain", "round", "fine")  # blocks; balls; bodies of some 15,000 triangles, as many as four of them
WIDTH, DEPTH, HEIGHT = 5.0, 6.0, 2.8  # metres, of rooms


def is_for_tuning(seed):
    return seed % 2 == 0


def blob(dice, rings):
    """A ball with waves on it, with normals."""
    ball = sphere(rings)
    waves = [(normalize(tuple(dice.random() - 0.5 for _ in range(3))), 2.0 + 6.0 * dice.random(), 6.28 * dice.random())
             for _ in range(5)]

    def radius(p):
        return 0.85 + sum(0.045 * math.sin(f * sum(a * b for a, b in zip(d, p)) + t) for d, f, t in waves)

    def normal(p):
        slope = [0.0] * 3
        for d, f, t in waves:
            bend = 0.045 * f * math.cos(f * sum(a * b for a, b in zip(d, p)) + t)
            slope = [s + bend * c for s, c in zip(slope, d)]
        r, along = radius(p), sum(s * c for s, c in zip(slope, p))
        return normalize(tuple(r * c - (s - along * c) for s, c in zip(slope, p)))

    return Shape([scale(p, radius(p)) for p in ball.positions], ball.indices, [normal(p) for p in ball.positions])


def texture(g, dice):
    """A chequerboard with grain."""
    side, cells = 64, 4 + int(4 * dice.random())
    tones = [[0.15 + 0.7 * dice.random() for _ in range(3)] for _ in range(2)]
    palette = [tuple(int(255 * c * (0.75 + 0.25 * i / 7)) for c in tone) for tone in tones for i in range(8)]

    def pixel(x, y):
        return 8 * ((x * cells // side + y * cells // side) % 2) + int(8 * dice.random())

    image = g.append("images", {"bufferView": g.view(png(side, side, palette, pixel)), "mimeType": "image/png"})
    return g.append("textures", {"source": image})


def material(g, dice, kind):
    color = tuple(0.15 + 0.65 * dice.random() for _ in range(3))
    bright = tuple(0.6 + 0.35 * dice.random() for _ in range(3))
    if kind == "diffuse":
        return g.lambert(kind, color)
    if kind == "textured":
        index = g.material(kind, roughness=0.8)
        g.doc["materials"][index]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": texture(g, dice)}
        return index
    if kind == "plastic":
        return g.material(kind, color, roughness=0.15 + 0.4 * dice.random())
    if kind == "coat":
        index = g.material(kind, color, roughness=0.6)
        coat = {"clearcoatFactor": 1.0, "clearcoatRoughnessFactor": round(0.2 * dice.random(), 3)}
        g.extend(g.doc["materials"][index], KHR_materials_clearcoat=coat)
        return index
    if kind == "rough metal":
        return g.material(kind, bright, metallic=1.0, roughness=0.25 + 0.4 * dice.random())
    if kind == "mirror":
        return g.material(kind, bright, metallic=1.0, roughness=0.0)
    return g.glass(kind, color=tuple(0.9 + 0.1 * dice.random() for _ in range(3)))


# A scene has materials of one group, so that not every scene needs kernels for all of them.
GROUPS = (("diffuse", "textured"), ("diffuse", "plastic", "textured"), ("diffuse", "rough metal", "mirror"),
          ("diffuse", "glass", "mirror"), ("textured", "coat", "rough metal"), ("plastic", "glass", "textured"))


def lay_uvs(shape, size):
    return Shape(shape.positions, shape.indices, shape.normals, [(p[0] / size, p[2] / size) for p in shape.positions])


def stage(g, dice, openness, light):
    """Floor and walls; the camera looks along -z. Returns what a lamp may hang under: its height."""
    floor_kind = "textured" if dice.random() < 0.5 else "diffuse"
    floor, wall = material(g, dice, floor_kind), g.lambert("wall", tuple(0.45 + 0.4 * dice.random() for _ in range(3)))
    if openness == "open":
        half = 14.0
        ground = quad((-half, 0, half), (half, 0, half), (half, 0, -half), (-half, 0, -half))
        g.mesh("floor", lay_uvs(ground, 2.0), floor)
        return 3.5
    x, z = WIDTH / 2, DEPTH / 2
    ground = quad((-x, 0, z), (x, 0, z), (x, 0, -z), (-x, 0, -z))
    g.mesh("floor", lay_uvs(ground, 2.0), floor)
    if openness == "half":  # two walls and half of a roof
        parts = wall_x(-x, -z, z, HEIGHT) + wall_z(-z, -x, x,
                                                   HEIGHT) + [box((-x, HEIGHT, -z), (x, HEIGHT + 0.15, -0.5))]
        g.mesh("walls", join(parts), wall)
        return HEIGHT
    tall, lit = 0.9 + 1.2 * dice.random(), light in ("sun", "map", "window")
    wide = 1.2 + 1.3 * dice.random() if lit else 0.25 + 0.3 * dice.random()
    at = -1.5 + dice.random()
    opening = (at, at + wide, 0.7, 0.7 + tall) if lit else (at, at + wide, 0.3, 2.3)
    parts = wall_x(-x, -z, z, HEIGHT) + wall_x(x, -z, z, HEIGHT, opening)
    parts += wall_z(-z, -x, x, HEIGHT) + wall_z(z, -x, x, HEIGHT)
    parts.append(box((-x - 0.1, HEIGHT, -z - 0.1), (x + 0.1, HEIGHT + 0.15, z + 0.1)))
    g.mesh("walls", join(parts), wall)
    if light == "window" and dice.random() < 0.5:
        a, b, low, high = opening
        g.mesh("pane", quad((x, low, a), (x, low, b), (x, high, b), (x, high, a)), g.pane("pane", (0.92, 0.97, 0.95)))
    return HEIGHT


def place_things(g, dice, detail, group):
    """Two to five things on the floor, apart from each other."""
    taken = []
    for i in range(2 + int(4 * dice.random())):
        for _ in range(40):
            x, z, size = -1.7 + 3.4 * dice.random(), -2.2 + 3.0 * dice.random(), 0.3 + 0.35 * dice.random()
            if all(math.hypot(x - u, z - v) > 1.15 * (size + s) for u, v, s in taken):
                break
        else:
            continue
        taken.append((x, z, size))
        kind = group[i % len(group)]
        index = material(g, dice, kind)
        if detail == "plain" and kind not in ("glass", "mirror"):
            tall = size * (1.0 + 1.5 * dice.random())
            shape = lay_uvs(box((-0.75 * size, 0.0, -0.75 * size), (0.75 * size, tall, 0.75 * size)), 0.5)
            turn = 0.5 * math.pi * dice.random()
            g.mesh(kind, shape, index, translation=[x, 0.002, z],
                   rotation=[0.0, math.sin(turn / 2), 0.0, math.cos(turn / 2)])
        else:
            shape = blob(dice, 62) if detail == "fine" else sphere(24)
            g.mesh(kind, lay_uvs(shape, 0.7), index, translation=[x, size + 0.003, z], scale=[size] * 3)


def down_quad(x, y, z, side):
    return quad((x - side, y, z - side), (x + side, y, z - side), (x + side, y, z + side), (x - side, y, z + side))


def light_lamp(g, dice, height, openness):
    side, flux = 0.1 + 0.4 * dice.random(), 40.0
    g.mesh("lamp", down_quad(-1.0 + 2.0 * dice.random(), height - 0.05, -1.5 + 2.5 * dice.random(), side),
           g.emitter("lamp", scale((1.0, 0.9, 0.75), flux / (math.pi * 4.0 * side * side))))


def light_lamps(g, dice, height, openness):
    """Some thirty to a hundred of unlike power; in rooms a third of them behind the walls."""
    ball = g.shape(sphere(4))
    for _ in range(30 + int(70 * dice.random())):
        outside = openness != "open" and dice.random() < 0.33
        x, z = -2.2 + 4.4 * dice.random(), -2.6 + 5.0 * dice.random()
        if outside:
            x = -WIDTH / 2 - 0.4 - 2.0 * dice.random()
        y = 0.5 + (height - 0.8) * dice.random()
        power = 2.0 * math.exp(1.2 * (2.0 * dice.random() - 1.0))
        tint = (1.0, 0.6 + 0.4 * dice.random(), 0.3 + 0.7 * dice.random())
        if dice.random() < 0.3:
            g.light("point", power / 4.0, tint, position=(x, y, z))
        else:
            g.mesh("bulb", ball, g.emitter("bulb", scale(tint, power / (4.0 * math.pi**2 * 0.03**2))),
                   translation=[x, y, z], scale=[0.03] * 3)


def light_sun(g, dice, height, openness):
    across = -1.0 if openness == "closed" else 2.0 * dice.random() - 1.0
    g.light("directional", 8.0 + 8.0 * dice.random(), (1.0, 0.93, 0.82),
            direction=(across, -0.6 - 0.5 * dice.random(), 0.2 - 0.7 * dice.random()))


def light_hidden(g, dice, height, openness):
    """In a shade, open above and below, or in a ball of glass."""
    x, y, z = -0.8 + 1.6 * dice.random(), 1.6 + 0.4 * dice.random(), -0.8 * dice.random()
    size = 0.07
    bulb = g.emitter("bulb", scale((1.0, 0.85, 0.65), 40.0 / (4.0 * math.pi**2 * size * size)))
    g.mesh("bulb", sphere(12), bulb, translation=[x, y, z], scale=[size] * 3)
    if dice.random() < 0.5:
        g.mesh("globe", sphere(24), g.glass("globe"), translation=[x, y, z], scale=[0.2] * 3)
        return
    n, low, high = 32, 0.3, 0.2
    ring = [(math.cos(2 * math.pi * i / n), math.sin(2 * math.pi * i / n)) for i in range(n)]
    sides = [quad((low * a, -0.25, low * b), (high * a, 0.25, high * b), (high * c, 0.25, high * d),
                  (low * c, -0.25, low * d))
             for (a, b), (c, d) in zip(ring, ring[1:] + ring[:1])]
    g.mesh("shade", join(sides), g.lambert("shade", (0.6, 0.5, 0.4), doubleSided=True), translation=[x, y, z])


def sky_map(dice):
    """A Radiance picture: a sky that brightens towards the horizon, a ground, and a sun of some two degrees."""
    width, height = 512, 256
    sun_x, sun_y, turbid = dice.random(), 0.12 + 0.25 * dice.random(), 0.5 + dice.random()
    at = (sun_x * 2 * math.pi, sun_y * math.pi)
    sun = (math.sin(at[1]) * math.cos(at[0]), math.cos(at[1]), math.sin(at[1]) * math.sin(at[0]))
    rows = bytearray()
    for j in range(height):
        v = (j + 0.5) / height * math.pi
        for i in range(width):
            u = (i + 0.5) / width * 2 * math.pi
            d = (math.sin(v) * math.cos(u), math.cos(v), math.sin(v) * math.sin(u))
            near = sum(a * b for a, b in zip(d, sun))
            haze = math.exp(-4.0 * max(d[1], 0.0)) * turbid
            glow = math.exp(-12.0 * (1.0 - near))
            color = (0.25 + 0.6 * haze + 1.5 * glow, 0.4 + 0.6 * haze + 1.2 * glow, 0.8 + 0.4 * haze + 0.8 * glow)
            if d[1] < 0.0:
                color = (0.12, 0.1, 0.08)
            if near > math.cos(math.radians(1.0)):
                color = (9000.0, 8200.0, 7000.0)
            exponent = math.frexp(max(color))[1]
            rows += bytes([*(min(255, int(math.ldexp(c, 8 - exponent))) for c in color), exponent + 128])
    return b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (height, width) + bytes(rows)


def scene(seed):
    """The scene, flags of `render` that belong to it, and what it is, in words."""
    dice = random.Random(seed)
    light = LIGHTS[seed % len(LIGHTS)]
    ways = OPENNESS[light]
    openness = ways[(seed // len(LIGHTS) + seed) % len(ways)]
    detail = DETAILS[int(3 * dice.random())]
    group = GROUPS[int(len(GROUPS) * dice.random())]
    g = Gltf(f"generated {seed}")
    height = stage(g, dice, openness, light)
    place_things(g, dice, detail, group)
    flags, files = ["--max-depth", "6"], {}
    if light in ("lamp", "lamps", "sun", "hidden"):
        {"lamp": light_lamp, "lamps": light_lamps, "sun": light_sun, "hidden": light_hidden}[light](g, dice, height,
                                                                                                    openness)
    if light == "map" or (light == "window" and dice.random() < 0.5):
        files["sky.hdr"] = sky_map(dice)
        flags += ["--env", "sky.hdr"]
    elif light in ("sky", "window") or (light == "sun" and dice.random() < 0.7):
        power = 1.0 if light != "sun" else 0.3 + 0.5 * dice.random()
        flags += ["--env", ",".join(f"{power * c:.3g}" for c in (0.9, 1.0, 1.15))]
    else:
        flags += ["--env", "black"]
    if openness == "open":
        g.camera((0.4, 2.0, 6.2), (0.0, 0.5, -0.5), yfov=0.65, aspect=4 / 3)
    elif openness == "half":
        g.camera((1.6, 1.7, 5.2), (-0.3, 0.9, -1.0), yfov=0.75, aspect=4 / 3)
    else:
        g.camera((-1.9, 1.6, 2.6), (0.4, 0.9, -1.0), yfov=0.95, aspect=4 / 3)
    return g, flags, files, f"{light}, {openness}, {detail}, {'/'.join(group)}"


def make(folder, seeds):
    """Writes the scenes that are not there. A list of what each is; paths within flags are absolute."""
    folder.mkdir(parents=True, exist_ok=True)
    made = []
    for seed in seeds:
        told = folder / f"{seed:02}.json"
        if not told.exists():
            g, flags, files, words = scene(seed)
            path = folder / f"{seed:02}.glb"
            path.write_bytes(g.binary())
            for name, data in files.items():
                (folder / f"{seed:02}-{name}").write_bytes(data)
                flags = [str(folder / f"{seed:02}-{name}") if flag == name else flag for flag in flags]
            told.write_text(json.dumps({"seed": seed, "scene": str(path), "flags": flags, "words": words,
                                        "tuning": is_for_tuning(seed)}) + "\n")
        made.append(json.loads(told.read_text()))
    return made


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--seeds", type=int, nargs="*", default=list(range(COUNT)), help=f"[default: 0 to {COUNT - 1}]")
    args = parser.parse_args()
    for one in make(args.folder.resolve(), args.seeds):
        print(f"{one['seed']:2} {'tuning ' if one['tuning'] else 'judging'} {one['words']}: {' '.join(one['flags'])}")


if __name__ == "__main__":
    main()
