"""Caustics to look at and to measure error against time by: a pool, a bulb, a ring, a ball before a mirror, a prism.

`lamp`: the light is a small body, which a path from the camera can hit; otherwise it has no extent, and none can.
"""

import math

from caustics import GLASS, GOLD, WATER, wedge
from gltf import Gltf, Shape, add, box, join, normalize, quad, scale, sphere


def floor(g, half, color=(0.7, 0.7, 0.7)):
    g.mesh("floor", quad((-half, 0.0, -half), (-half, 0.0, half), (half, 0.0, half), (half, 0.0, -half)),
           g.lambert("floor", color))


def add_lamp(g, position, radius, radiance, lamp):
    """A glowing ball, or a point that shines as brightly."""
    if lamp:
        g.mesh("lamp", sphere(8), g.emitter("lamp", radiance), translation=list(position), scale=[radius] * 3)
    else:
        strength = max(radiance)
        g.light("point", strength * math.pi * radius ** 2, scale(radiance, 1 / strength), position)


def lathe(profile, segments=48):
    """Turned about y. `profile`: runs of (radius, y, normal's radius, normal's y), bottom to top on the outside."""
    positions, normals, indices = [], [], []
    for run in profile:
        first = len(positions)
        for r, y, nr, ny in run:
            for j in range(segments):
                c, s = math.cos(2 * math.pi * j / segments), math.sin(2 * math.pi * j / segments)
                positions.append((r * c, y, -r * s))
                normals.append((nr * c, ny, -nr * s))
        for i in range(len(run) - 1):
            for j in range(segments):
                a, b = first + i * segments + j, first + i * segments + (j + 1) % segments
                for triangle in ((a, b, b + segments), (a, b + segments, a + segments)):
                    if len({positions[k] for k in triangle}) == 3:  # none at the axis
                        indices += triangle
    return Shape(positions, indices, normals)


def bulb_profile(radius, thickness, steps=24):
    """A ball that is open above, with a rim; outside, rim, inside."""
    end = 0.85 * math.pi
    angles = [end * i / steps for i in range(steps + 1)]  # from the lowest point

    def arc(r, side):
        return [(r * math.sin(a), -r * math.cos(a), side * math.sin(a), -side * math.cos(a)) for a in angles]

    outside, inside = arc(radius, 1.0), arc(radius - thickness, -1.0)[::-1]
    rim = [(r, y, math.cos(end), math.sin(end)) for r, y, *_ in (outside[-1], inside[0])]
    return [outside, rim, inside]


def bulb_room(lamp):
    g = Gltf("lamp in a glass bulb")
    floor(g, 1.5)
    g.mesh("wall", quad((-1.5, 0.0, -0.8), (1.5, 0.0, -0.8), (1.5, 2.0, -0.8), (-1.5, 2.0, -0.8)),
           g.lambert("wall", (0.45, 0.55, 0.65)))
    centre = (0.0, 0.5, 0.0)
    g.mesh("bulb", lathe(bulb_profile(0.2, 0.03)), g.glass("glass", GLASS), translation=list(centre))
    g.mesh("block", box((-0.75, 0.0, -0.4), (-0.45, 0.35, -0.1)), g.lambert("block", (0.65, 0.25, 0.15)))
    g.mesh("ball", sphere(24), g.lambert("ball", (0.3, 0.55, 0.25)), translation=[0.6, 0.15, 0.1], scale=[0.15] * 3)
    add_lamp(g, add(centre, (0.0, -0.03, 0.02)), 0.02, (900.0, 780.0, 560.0), lamp)
    g.camera((0.5, 0.9, 2.1), (0.0, 0.35, -0.1), yfov=0.75, aspect=4 / 3)
    return g


def bulb_lamp():
    return bulb_room(lamp=True)


def bulb_point():
    return bulb_room(lamp=False)


def ripples(side, cells, height):
    """A square of water, smooth."""
    waves = [(0.014, 1.3, 0.4, 0.3), (0.009, -0.7, 1.9, 1.1), (0.006, 2.6, -1.5, 2.0), (0.003, 1.1, 4.3, 0.6)]
    positions, normals, indices = [], [], []
    for j in range(cells + 1):
        for i in range(cells + 1):
            x, z = side * (i / cells - 0.5), side * (j / cells - 0.5)
            phases = [(a, 2 * math.pi * u, 2 * math.pi * v, 2 * math.pi * (u * x + v * z + p)) for a, u, v, p in waves]
            positions.append((x, height + sum(a * math.sin(p) for a, _, _, p in phases), z))
            normals.append(normalize((-sum(a * u * math.cos(p) for a, u, _, p in phases), 1.0,
                                      -sum(a * v * math.cos(p) for a, _, v, p in phases))))
    for j in range(cells):
        for i in range(cells):
            a = j * (cells + 1) + i
            indices += [a, a + cells + 1, a + cells + 2, a, a + cells + 2, a + 1]
    return Shape(positions, indices, normals)


def pool():
    """A basin that the sun reaches through the water alone, as the camera does."""
    g = Gltf("sun in a pool")
    side, depth = 3.0, 0.9
    basin = box((-side / 2, 0.0, -side / 2), (side / 2, depth + 0.12, side / 2)).flipped()
    open_above = [t for t in basin.triangles() if min(p[1] for p in t) < depth]
    g.mesh("basin", Shape([p for t in open_above for p in t], list(range(3 * len(open_above)))),
           g.lambert("basin", (0.5, 0.68, 0.75)))
    g.mesh("water", ripples(side - 2e-3, 72, depth), g.glass("water", WATER))
    g.mesh("ball", sphere(24), g.lambert("ball", (0.75, 0.2, 0.1)), translation=[0.5, 0.25, -0.4], scale=[0.25] * 3)
    g.light("directional", 12.0, (1.0, 0.95, 0.85), direction=(0.35, -1.0, -0.15))
    g.camera((0.0, 2.6, 2.4), (0.0, 0.3, -0.1), yfov=0.75, aspect=4 / 3)
    return g


def ring():
    """A gold ring on the floor: light that its inside reflects gathers in a cusp."""
    g = Gltf("light in a ring")
    floor(g, 1.5, (0.75, 0.73, 0.7))
    r, t, h = 0.4, 0.02, 0.16
    profile = [[(r, 0.001, 1.0, 0.0), (r, h, 1.0, 0.0)], [(r, h, 0.0, 1.0), (r - t, h, 0.0, 1.0)],
               [(r - t, h, -1.0, 0.0), (r - t, 0.001, -1.0, 0.0)]]
    g.mesh("ring", lathe(profile, 128), g.material("gold", GOLD, metallic=1.0, roughness=0.0))
    add_lamp(g, (-1.1, 0.75, 0.3), 0.02, (9000.0, 8500.0, 8000.0), False)
    g.camera((0.1, 1.1, 1.2), (0.0, 0.0, 0.0), yfov=0.7, aspect=4 / 3)
    return g


def mirror_caustic():
    """What the ball gathers lies behind it: the camera sees it in the mirror."""
    g = Gltf("caustic in a mirror")
    floor(g, 1.5)
    g.mesh("mirror", quad((-0.9, 0.02, -0.7), (0.9, 0.02, -0.7), (0.9, 0.9, -0.7), (-0.9, 0.9, -0.7)),
           g.material("silver", (0.95, 0.95, 0.95), metallic=1.0, roughness=0.0))
    g.mesh("ball", sphere(40), g.glass("glass", GLASS), translation=[0.0, 0.25, 0.15], scale=[0.22] * 3)
    g.mesh("block", box((0.4, 0.0, -0.4), (0.6, 0.4, -0.2)), g.lambert("block", (0.25, 0.4, 0.65)))
    add_lamp(g, (0.25, 1.3, 1.2), 0.04, (700.0, 650.0, 560.0), True)
    g.camera((-0.1, 0.6, 1.9), (0.0, 0.22, -0.4), yfov=0.7, aspect=4 / 3)
    return g


def prism_spot():
    g = Gltf("spot light through a prism")
    floor(g, 2.0)
    g.mesh("screen", quad((1.2, 0.0, 1.0), (1.2, 0.0, -1.0), (1.2, 1.2, -1.0), (1.2, 1.2, 1.0)),
           g.lambert("screen", (0.75, 0.75, 0.75)))
    g.mesh("prism", join(wedge((0.0, 0.6), 0.4, 0.6)), g.glass("glass", GLASS))
    turn = math.asin(GLASS / 2) - math.pi / 6
    direction = (math.cos(turn), math.sin(turn), 0.0)
    position = add((-0.1, 0.43, 0.0), scale(direction, -0.55))
    g.light("spot", 6.0, (1.0, 0.9, 0.75), position, direction, spot=(0.08, 0.11))
    g.camera((0.1, 0.75, 2.2), (0.3, 0.4, 0.0), yfov=0.75, aspect=4 / 3)
    return g


def scenes():
    """File stem, scene."""
    for build in (bulb_lamp, bulb_point, pool, ring, mirror_caustic, prism_spot):
        yield build.__name__, build()
