"""The picture on the first page: glass, metals and ceramics on a tiled stage, under a soft box."""

import math

from gltf import Gltf, Shape, add, cross, normalize, prism, quad, scale, sphere, sub
from png import png

STAGE_RADIUS, STAGE_HEIGHT = 3.1, 0.12
TEXTURE_SIZE = 512


def torus_knot(around=3, through=2, radius=0.62, swing=0.27, tube=0.155, steps=360, sides=20):
    """A (through, around) torus knot that stands upright."""
    def centre(t):
        r = radius + swing * math.cos(around * t)
        return (r * math.cos(through * t), r * math.sin(through * t), swing * math.sin(around * t))

    positions, normals, indices = [], [], []
    for i in range(steps):
        t, dt = 2 * math.pi * i / steps, 1e-4
        ahead, behind = centre(t + dt), centre(t - dt)
        tangent = normalize(sub(ahead, behind))
        bend = add(add(ahead, behind), scale(centre(t), -2.0))
        side = normalize(cross(tangent, bend))
        other = cross(side, tangent)
        for j in range(sides):
            a = 2 * math.pi * j / sides
            normal = add(scale(side, math.cos(a)), scale(other, math.sin(a)))
            positions.append(add(centre(t), scale(normal, tube)))
            normals.append(normal)
            here, next_j, next_i = i * sides + j, i * sides + (j + 1) % sides, (i + 1) % steps * sides
            indices += [here, next_i + (j + 1) % sides, next_j, here, next_i + j, next_i + (j + 1) % sides]
    return Shape(positions, indices, normals)


def brilliant(sides=12, table=0.55, crown=0.34, pavilion=0.86):
    """A cut gem, flat-faced: table, crown and pavilion; girdle of radius 1 at y = 0."""
    def ring(radius, y, turn):
        return [(radius * math.cos(a), y, -radius * math.sin(a))
                for a in (2 * math.pi * (i + turn) / sides for i in range(sides))]

    top, girdle, tip = ring(table, crown, 0.5), ring(1.0, 0.0, 0.0), (0.0, -pavilion, 0.0)
    faces = []
    for i in range(sides):
        k = (i + 1) % sides
        faces += [(girdle[i], girdle[k], top[i]), (girdle[k], top[k], top[i]), (girdle[k], girdle[i], tip)]
    faces += [(top[0], top[i], top[i + 1]) for i in range(1, sides - 1)]
    return Shape([v for face in faces for v in face], list(range(3 * len(faces))))


def backdrop(width=16.0, floor_front=9.0, floor_back=-3.0, bend=2.5, height=9.0, steps=24):
    """A floor that curves up into a wall, without a visible edge."""
    profile = [(floor_front, 0.0, 0.0)]
    profile += [(floor_back - bend * math.sin(a), bend * (1 - math.cos(a)), a)
                for a in (math.pi / 2 * i / steps for i in range(steps + 1))]
    profile.append((floor_back - bend, height, math.pi / 2))
    positions, normals, indices = [], [], []
    for i, (z, y, angle) in enumerate(profile):
        positions += [(-width, y, z), (width, y, z)]
        normals += [(0.0, math.cos(angle), math.sin(angle))] * 2
        if i:
            a = 2 * i
            indices += [a - 2, a - 1, a + 1, a - 2, a + 1, a]
    return Shape(positions, indices, normals)


def tiles():
    """Hexagonal tiles in three tones with pale joints."""
    palette = [(226, 220, 208), (38, 52, 66), (46, 64, 80), (54, 76, 92), (188, 150, 92)]
    across = 14  # tiles over the width of the texture
    step, row = TEXTURE_SIZE / across, TEXTURE_SIZE / across * math.sqrt(3) / 2

    def pixel(x, y):
        nearest = []
        for r in range(int(y / row) - 1, int(y / row) + 3):
            shift = 0.5 * (r % 2)
            c = round(x / step - shift)
            for column in (c - 1, c, c + 1):
                nearest.append((math.hypot(x - (column + shift) * step, y - r * row), column, r))
        nearest.sort()
        if nearest[1][0] - nearest[0][0] < 0.055 * step:
            return 0
        _, column, r = nearest[0]
        mixed = (column * 7919 + r * 104729 + column * r * 31) % 11
        return 4 if mixed == 0 else 1 + mixed % 3

    return png(TEXTURE_SIZE, TEXTURE_SIZE, palette, pixel)


def stage(g):
    circle = [(STAGE_RADIUS * math.cos(a), -STAGE_RADIUS * math.sin(a))
              for a in (2 * math.pi * i / 128 for i in range(128))]
    g.mesh("stage", prism(circle, STAGE_HEIGHT - 0.002), g.material("stage edge", (0.75, 0.72, 0.66), roughness=0.5))
    top = Shape([(x, STAGE_HEIGHT, z) for x, z in circle], [v for i in range(1, 127) for v in (0, i, i + 1)],
                uvs=[(0.5 + 0.5 * x / STAGE_RADIUS, 0.5 + 0.5 * z / STAGE_RADIUS) for x, z in circle])
    image = g.append("images", {"name": "tiles", "mimeType": "image/png", "bufferView": g.view(tiles())})
    material = g.material("tiles", roughness=0.22)
    g.doc["materials"][material]["pbrMetallicRoughness"]["baseColorTexture"] = {
        "index": g.append("textures", {"source": image})}
    g.mesh("tiles", top, material)


def lights(g):
    """Quads that face the stage."""
    def panel(name, centre, right, up, radiance):
        a, b, c, d = (add(centre, add(scale(right, x), scale(up, y))) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1)))
        g.mesh(name, quad(a, b, c, d), g.emitter(name, radiance))

    panel("soft box", (0.6, 6.0, 0.6), (3.0, 0.0, 0.0), (0.0, 0.3, 1.8), (9.0, 8.6, 8.0))
    panel("cool strip", (-5.6, 2.6, 1.2), (0.5, 0.0, -1.2), (0.0, 2.4, 0.0), (2.6, 4.4, 7.0))
    panel("warm strip", (5.8, 2.4, 0.6), (-0.4, 0.0, -1.2), (0.0, 2.2, 0.0), (7.5, 4.2, 1.8))
    panel("fill", (0.0, 4.0, 11.0), (-6.0, 0.0, 0.0), (0.0, 3.0, -0.8), (0.7, 0.72, 0.8))


def showcase():
    g = Gltf("showcase")
    g.mesh("backdrop", backdrop(), g.lambert("backdrop", (0.5, 0.49, 0.5)))
    stage(g)
    ball = g.shape(sphere(40))

    def place(name, x, z, radius, material):
        g.mesh(name, ball, material, translation=[x, STAGE_HEIGHT + radius, z], scale=[radius] * 3)

    def metal(name, color, roughness):
        return g.material(name, color, metallic=1.0, roughness=roughness)

    g.mesh("knot", torus_knot(), metal("rose gold", (0.96, 0.64, 0.54), 0.2),
           translation=[0.0, STAGE_HEIGHT + 0.995, -0.55], rotation=[0.0, math.sin(0.15), 0.0, math.cos(0.15)])
    place("glass", -1.25, 0.75, 0.52, g.glass("glass"))
    place("amber", 1.3, 0.95, 0.44, g.glass("amber", attenuation=(1.0, 0.55, 0.12), distance=0.35))
    place("copper", -2.05, -0.55, 0.58, metal("rough copper", (0.955, 0.638, 0.538), 0.45))
    place("ceramic", 2.0, -0.55, 0.62, g.material("blue ceramic", (0.02, 0.10, 0.42), roughness=0.08))
    place("mirror", 0.42, 1.35, 0.3, metal("mirror", (0.95, 0.95, 0.95), 0.0))
    place("gold", -0.28, 1.75, 0.2, metal("gold", (1.0, 0.77, 0.34), 0.12))
    place("matte", 0.95, 1.95, 0.16, g.lambert("red clay", (0.62, 0.09, 0.05)))
    place("frosted", 2.25, 0.75, 0.26, g.glass("frosted", color=(0.85, 1.0, 0.95), roughness=0.35))
    g.mesh("lamp", sphere(8), g.emitter("lamp", (7.0, 4.2, 1.8)), translation=[-2.3, STAGE_HEIGHT + 0.14, 0.95],
           scale=[0.14] * 3)
    gem = 0.34
    g.mesh("gem", brilliant(), g.glass("gem", ior=2.0, attenuation=(0.75, 0.95, 1.0), distance=0.6),
           translation=[-0.8, STAGE_HEIGHT + 0.86 * gem, 1.75], scale=[gem] * 3)
    lights(g)
    g.camera((0.0, 2.35, 7.4), (0.0, 0.86, 0.0), yfov=0.46, aspect=16 / 9)
    return g
