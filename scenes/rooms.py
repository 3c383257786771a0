"""Rooms behind walls: lit through a slit, through a door ajar, and houses full of lamps of which few are seen."""

import math
import random

from gltf import Gltf, Shape, box, join, normalize, quad, scale, sphere

WALL = 0.15  # metres thick


def sheets(lo, hi):
    """The inside of a box: six sheets that face inwards."""
    return box(lo, hi).flipped()


def wall_x(x, z0, z1, height, opening=None):
    """A wall across x from z0 to z1; `opening`: z0, z1, y0, y1 of a hole in it. It reaches into floor and ceiling."""
    lo, hi = x - WALL / 2, x + WALL / 2
    bottom, top = -WALL / 4, height + WALL / 4
    if not opening:
        return [box((lo, bottom, z0), (hi, top, z1))]
    a, b, y0, y1 = opening
    parts = [box((lo, bottom, z0), (hi, top, a)), box((lo, bottom, b), (hi, top, z1)), box((lo, y1, a), (hi, top, b))]
    return parts + ([box((lo, bottom, a), (hi, y0, b))] if y0 > 0.0 else [])


def swapped(shape):
    """x and z exchanged; still outside out."""
    return Shape([(z, y, x) for x, y, z in shape.positions], shape.indices).flipped()


def wall_z(z, x0, x1, height, opening=None):
    return [swapped(part) for part in wall_x(z, x0, x1, height, opening)]


def slit_room():
    """The lamp hangs on the far side of the wall and shines away from it: what comes through the slit was reflected."""
    g = Gltf("room lit through a slit")
    white = g.lambert("white", (0.75, 0.75, 0.75))
    red, blue = g.lambert("red", (0.6, 0.1, 0.08)), g.lambert("blue", (0.1, 0.2, 0.6))
    g.mesh("room", sheets((0.0, 0.0, 0.0), (6.0, 2.8, 3.2)), white)
    g.mesh("wall", join(wall_x(4.0, -WALL, 3.2 + WALL, 2.8, opening=(1.35, 1.75, 0.3, 2.4))), white)
    lamp = quad((4.1, 0.8, 0.9), (4.1, 0.8, 0.3), (4.1, 2.0, 0.3), (4.1, 2.0, 0.9))
    g.mesh("lamp", lamp, g.emitter("lamp", (600.0, 520.0, 400.0)))
    g.mesh("block", box((2.3, 0.0, 0.5), (2.9, 1.1, 1.1)), red)
    g.mesh("ball", sphere(24), blue, translation=[2.2, 0.4, 2.2], scale=[0.4] * 3)
    g.camera((0.3, 1.5, 1.4), (3.6, 1.1, 1.6), yfov=1.0, aspect=4 / 3)
    return g


def door_ajar():
    """After Veach's scene: one lamp in the next room, a door that lets a little of its light through."""
    g = Gltf("door ajar")
    white = g.lambert("white", (0.8, 0.8, 0.8))
    hinge, width, height, angle = 1.0, 0.9, 2.1, 0.25
    g.mesh("rooms", sheets((0.0, 0.0, 0.0), (7.0, 2.7, 3.6)), white)
    g.mesh("wall", join(wall_x(4.0, -WALL, 3.6 + WALL, 2.7, opening=(hinge, hinge + width, 0.0, height))),
           g.lambert("wall", (0.55, 0.6, 0.65)))
    door = box((-0.02, 0.005, 0.005), (0.02, height - 0.005, width - 0.005))
    g.mesh("door", door, g.lambert("wood", (0.45, 0.28, 0.14)), translation=[4.0, 0.0, hinge],
           rotation=[0.0, math.sin(-angle / 2), 0.0, math.cos(angle / 2)])
    lamp = quad((5.2, 2.6, 2.2), (6.2, 2.6, 2.2), (6.2, 2.6, 3.2), (5.2, 2.6, 3.2))
    g.mesh("lamp", lamp, g.emitter("lamp", (900.0, 820.0, 700.0)))
    g.mesh("table", box((1.9, 0.0, 1.5), (2.9, 0.7, 2.9)), g.lambert("table", (0.5, 0.33, 0.2)))
    ball = g.shape(sphere(32))
    for name, z, material in (("glass", 1.8, g.glass("glass")), ("clay", 2.2, g.lambert("clay", (0.6, 0.2, 0.12))),
                              ("steel", 2.6, g.material("steel", (0.8, 0.8, 0.82), metallic=1.0, roughness=0.35))):
        g.mesh(name, ball, material, translation=[2.35, 0.86, z], scale=[0.16] * 3)
    g.camera((0.3, 1.6, 3.0), (3.2, 0.9, 1.8), yfov=0.9, aspect=4 / 3)
    return g


def glazed_room():
    """A sun shines through a window of thin tinted glass; with `--env` a sky does, too."""
    g = Gltf("room behind a glazed window")
    white, oak = g.lambert("white", (0.75, 0.75, 0.72)), g.lambert("oak", (0.45, 0.3, 0.18))
    width, height, depth = 4.6, 2.7, 3.6
    end = (width + WALL, depth + WALL)
    g.mesh("floor", box((-WALL, -WALL, -WALL), (end[0], 0.0, end[1])), oak)
    g.mesh("ceiling", box((-WALL, height, -WALL), (end[0], height + WALL, end[1])), white)
    walls = wall_x(-WALL / 2, -WALL, end[1], height) + wall_z(-WALL / 2, 0.0, width, height)
    walls += wall_z(depth + WALL / 2, 0.0, width, height)
    walls += wall_x(width + WALL / 2, -WALL, end[1], height, opening=(0.9, 2.5, 0.8, 2.2))
    g.mesh("walls", join(walls), white)
    x = width + WALL / 2
    g.mesh("pane", quad((x, 0.75, 0.85), (x, 0.75, 2.55), (x, 2.25, 2.55), (x, 2.25, 0.85)),
           g.pane("glass", (0.9, 0.96, 0.93)))
    g.mesh("sill", box((width - 0.1, 0.74, 0.85), (width + 0.03, 0.8, 2.55)), oak)
    g.mesh("table", box((1.9, 0.0, 1.1), (2.9, 0.72, 2.3)), oak)
    g.mesh("ball", sphere(24), g.lambert("blue", (0.15, 0.25, 0.6)), translation=[2.4, 0.98, 1.6], scale=[0.26] * 3)
    g.mesh("block", box((0.6, 0.0, 0.4), (1.1, 1.3, 0.9)), g.lambert("red", (0.6, 0.12, 0.08)))
    g.light("directional", 40.0, (1.0, 0.92, 0.8), direction=(-1.0, -0.75, 0.2))
    g.camera((0.25, 1.6, 3.3), (2.9, 1.0, 1.3), yfov=1.05, aspect=4 / 3)
    return g


# ---- many lights ----------------------------------------------------------------------------------------------------

SIDE, HEIGHT, YARD = 4.0, 3.0, 6.0  # metres: of a room, and around the house
FLUX_PER_ROOM = 60.0
SPREAD = 1.5  # standard deviation of the logarithm of power
OUTSIDE = 0.2  # share of lights around the house
HANGING = 2 / 3  # share of emitters that hang in the room; the rest are panels under its ceiling
SMALLEST = {"body": 0.0006, "panel": 0.001}  # m^2; an emitter has up to four times that
TINTS = ((1.0, 0.72, 0.42), (1.0, 0.95, 0.88), (0.6, 0.78, 1.0))


def house(g, rooms, dice):
    """`rooms` x `rooms` rooms, doors between neighbours, a window to the outside in each outer wall."""
    end = rooms * SIDE
    parts = [box((-YARD, -0.3, -YARD), (end + YARD, 0.0, end + YARD)),
             box((-WALL, HEIGHT, -WALL), (end + WALL, HEIGHT + 0.2, end + WALL))]
    for wall in (wall_x, wall_z):
        for line in range(rooms + 1):
            for i in range(rooms):
                at = i * SIDE + 0.6 + dice.random() * (SIDE - 2.4)
                outer = line in (0, rooms)
                opening = (at, at + 1.2, 1.0, 2.0) if outer else (at, at + 0.9, 0.0, 2.1)
                parts += wall(line * SIDE, i * SIDE, (i + 1) * SIDE, HEIGHT, opening)
    g.mesh("house", join(parts), g.lambert("plaster", (0.7, 0.68, 0.65)))
    furniture = []
    for room in range(rooms * rooms):
        for _ in range(2):
            x, z = (c * SIDE + 0.5 + dice.random() * (SIDE - 1.8) for c in divmod(room, rooms))
            furniture.append(box((x, 0.001, z), (x + 0.8, 0.5 + dice.random(), z + 0.8)))
    g.mesh("furniture", join(furniture), g.lambert("oak", (0.5, 0.36, 0.22)))


def place(rooms, dice):
    """Where a light is, and whether there is a ceiling above it."""
    if dice.random() >= OUTSIDE:
        x, z = (int(dice.random() * rooms) * SIDE + 0.3 + dice.random() * (SIDE - 0.6) for _ in range(2))
        return (x, 0.4 + dice.random() * (HEIGHT - 0.8), z), True
    along, away = dice.random() * rooms * SIDE, 0.5 + dice.random() * (YARD - 1.0)
    side = int(dice.random() * 4)
    across = -away if side % 2 else rooms * SIDE + away
    x, z = (along, across) if side < 2 else (across, along)
    return (x, 0.4 + dice.random() * (HEIGHT - 0.8), z), False


def body(centre, area, dice):
    """A regular tetrahedron of that surface, turned about the vertical."""
    r = math.sqrt(area * math.sqrt(3.0) / 8)
    turn = 2 * math.pi * dice.random()
    ring = [(r * math.sqrt(8 / 9) * math.cos(a), -r / 3, -r * math.sqrt(8 / 9) * math.sin(a))
            for a in (turn + 2 * math.pi * i / 3 for i in range(3))]
    return Shape([(0.0, r, 0.0), *ring], [0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2]).moved(centre)


def panel(centre, area, dice):
    s = math.sqrt(area) / 2
    x, z = centre[0], centre[2]
    y = HEIGHT - 0.01
    return quad((x - s, y, z - s), (x + s, y, z - s), (x + s, y, z + s), (x - s, y, z + s))


def add_emitters(g, lights, dice):
    """Radiance goes in steps of four, the area of each makes up the rest; all of one radiance and tint are one mesh."""
    meshes = {}
    for power, centre, under_ceiling, tint in lights:
        kind = "body" if not under_ceiling or dice.random() < HANGING else "panel"
        step = math.floor(math.log(power / (math.pi * SMALLEST[kind]), 4))
        area = power / (math.pi * 4.0 ** step)
        meshes.setdefault((step, tint), []).append((body if kind == "body" else panel)(centre, area, dice))
    for (step, tint), shapes in sorted(meshes.items()):
        name = f"emitters of {4.0 ** step:g}, tint {tint}"
        g.mesh(name, join(shapes), g.emitter(name, scale(TINTS[tint], 4.0 ** step)))


def add_punctual(g, lights, dice):
    for i, (power, centre, _, tint) in enumerate(lights):
        if i % 2:
            g.light("point", power / (4 * math.pi), TINTS[tint], centre)
        else:
            outer = 0.4 + 0.6 * dice.random()
            direction = normalize((2 * dice.random() - 1, -1.0, 2 * dice.random() - 1))
            g.light("spot", power / (2 * math.pi * (1 - math.cos(outer))), TINTS[tint], centre, direction,
                    spot=(outer / 2, outer))


def many_lights(count=10000, seed=0, punctual=0.1, rooms=4):
    """`count` lights of log-normal power, a share `punctual` of them without extent; the camera stands in one room."""
    g = Gltf(f"{count} lights in and around {rooms * rooms} rooms")
    dice = random.Random(seed)
    house(g, rooms, dice)
    powers = [math.exp(SPREAD * dice.gauss(0.0, 1.0)) for _ in range(count)]
    unit = FLUX_PER_ROOM * rooms * rooms / (1 - OUTSIDE) / sum(powers)
    lights = [(p * unit, *place(rooms, dice), int(3 * dice.random())) for p in powers]
    first = round(count * (1 - punctual))
    add_emitters(g, lights[:first], dice)
    add_punctual(g, lights[first:], dice)
    g.camera((0.35, 2.4, 0.35), (1.35, 1.95, 1.2), yfov=1.1, aspect=4 / 3)
    return g


def hundred_lights():
    """Few enough to try everything."""
    return many_lights(count=100, seed=1, punctual=0.2, rooms=2)
