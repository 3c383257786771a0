"""Light of lamps and suns through glass, water and off mirrors, with answers from Snell, Fresnel and solid angles.

A path from the camera cannot find it: a lamp without extent is not hit by chance, and a smooth surface cannot be aimed
through. So these scenes are no part of analytic/: generate.py writes them to caustics/, and their answers beside them,
to expected.json. `seen`: how the camera sees the floor. `straight`: shadow rays that pass thin glass unbent suffice;
`diffuse`: a light path that is connected to the camera suffices; `specular`: through glass or in a mirror, which takes
merging or manifolds.

Every floor is Lambert's; --max-depth ends the paths where the closed form ends.
"""

import math

import oracles
from analytic import ALBEDO, COLOR_UNIT, PI, product
from gltf import Gltf, Shape, box, cross, join, normalize, quad, scale, sphere, sub

LUX = 10.0
WATER, GLASS = 1.33, 1.5
SAMPLES = "4096"


def sheet(g, name, half, height, material):
    """Level, its front above."""
    s, y = half, height
    g.mesh(name, quad((-s, y, -s), (-s, y, s), (s, y, s), (s, y, -s)), material)


def lambert_floor(g, half):
    sheet(g, "floor", half, 0.0, g.lambert("floor", ALBEDO))


def look_down(g, half, height, x=0.0):
    g.camera((x, height, 0.0), (x, 0.0, 0.0), up=(0.0, 0.0, -1.0), extent=half)


def sun(g, degrees):
    """From the zenith towards -x, so that it shines towards +x."""
    a = math.radians(degrees)
    g.light("directional", LUX, COLOR_UNIT, direction=(math.sin(a), -math.cos(a), 0.0))
    return math.cos(a)


def answer(g, about, irradiance, depth, seen, slack=0.0, tint=(1.0, 1.0, 1.0)):
    """`irradiance`: of the floor, before COLOR_UNIT and `tint`."""
    flags = ["--size", "8x8", "--spp", SAMPLES, "--max-depth", str(depth), "--filter", "box"]
    g.answer = {"about": about, "seen": seen, "render": flags, "slack": slack,
                "expected": [round(v, 7) for v in scale(product(ALBEDO, COLOR_UNIT, tint), irradiance / PI)]}
    return g


def passed(cosine, ior):
    return 1 - oracles.fresnel(cosine, ior)


def water_flat():
    """The camera is in the water."""
    g = Gltf("sun through still water")
    lambert_floor(g, 2.0)
    sheet(g, "water", 2.0, 0.5, g.glass("water", WATER))
    cosine = sun(g, 40)
    look_down(g, 0.5, 0.25)
    return answer(g, "E = E_sun cos 40 (1 - F)", LUX * cosine * passed(cosine, WATER), 2, "diffuse")


def water_flat_from_above():
    g = Gltf("sun through still water, seen from above")
    lambert_floor(g, 2.0)
    sheet(g, "water", 2.0, 0.5, g.glass("water", WATER))
    cosine = sun(g, 40)
    look_down(g, 0.5, 1.0)
    inside = LUX * cosine * passed(cosine, WATER)
    return answer(g, "E = E_sun cos 40 (1 - F); the radiance that leaves at right angles is (1 - F(0))/n^2 of it",
                  inside * passed(1.0, WATER) / WATER ** 2, 3, "specular")


def waves(cells, periods, height):
    """Facets of a level sheet with waves along x and across, each of whole periods a metre; `cells` a metre."""
    n = cells * periods
    def at(i, j):
        x, z = i / cells - periods / 2, j / cells - periods / 2
        y = sum(a * math.sin(2 * PI * p) for a, p in ((0.016, x + 0.1), (0.01, 2 * z + x), (0.004, 3 * (x - z))))
        return (x, height + y, z)

    positions = [at(i, j) for j in range(n + 1) for i in range(n + 1)]
    indices = []
    for j in range(n):
        for i in range(n):
            a = j * (n + 1) + i
            indices += [a, a + n + 1, a + n + 2, a, a + n + 2, a + 1]
    return Shape(positions, indices)


def water_wavy():
    """What enters a period of the surface lands in a period of the floor, wherever in it."""
    g = Gltf("sun through waves")
    lambert_floor(g, 1.5)
    cells, periods = 24, 3
    surface = waves(cells, periods, 0.5)
    g.mesh("water", surface, g.glass("water", WATER))
    cosine = sun(g, 0)
    look_down(g, 0.5, 0.25)
    inside = [t for t in surface.triangles() if all(-0.5 - 1e-9 <= p[k] <= 0.5 + 1e-9 for p in t for k in (0, 2))]
    flux = 0.0
    for a, b, c in inside:
        normal = cross(sub(b, a), sub(c, a))
        flux += normal[1] / 2 * passed(normalize(normal)[1], WATER)
    return answer(g, "mean of 1 - F over the facets of one period, by level area", LUX * cosine * flux, 2, "diffuse")


def slab_sun():
    g = Gltf("sun through a glass plate")
    lambert_floor(g, 1.5)
    g.mesh("plate", box((-1.5, 0.4, -1.5), (1.5, 0.5, 1.5)), g.glass("glass", GLASS))
    cosine = sun(g, 60)
    look_down(g, 0.3, 0.2)
    return answer(g, "E = E_sun cos 60 (1 - F)^2: faces without what is reflected between them",
                  LUX * cosine * passed(cosine, GLASS) ** 2, 3, "diffuse")


def panes():
    """Thin glass, which does not bend light."""
    g = Gltf("point light above two thin panes")
    lambert_floor(g, 1.5)
    tint = (0.9, 0.6, 0.8)
    for i, height in enumerate((1.0, 1.2)):
        index = g.material(f"pane {i}", tint if i else (1.0, 1.0, 1.0), roughness=0.0)
        g.extend(g.doc["materials"][index], KHR_materials_transmission={"transmissionFactor": 1.0})
        sheet(g, f"pane {i}", 3.0, height, index)
    g.light("point", LUX, COLOR_UNIT, (0.0, 1.6, 0.0))
    look_down(g, 0.25, 0.5, 0.75)
    steps, mean = 32, 0.0
    for i in range(steps):
        for j in range(steps):
            x, z = 0.5 + (i + 0.5) * 0.5 / steps, -0.25 + (j + 0.5) * 0.5 / steps
            d2 = x * x + z * z + 1.6 ** 2
            cosine = 1.6 / math.sqrt(d2)
            mean += cosine / d2 * passed(cosine, GLASS) ** 2 / steps ** 2
    return answer(g, "E = I cos/d^2 (1 - F)^2 tint, mean over the picture (midpoint rule)", LUX * mean, 3, "straight",
                  1e-5, tint)


def shell(g, centre, outer, inner, rings=16):
    """The normal interpolated at a point of this mesh is along the radius: light from the centre passes unbent."""
    glass = g.glass("glass", GLASS)
    g.mesh("outside", sphere(rings), glass, translation=list(centre), scale=[outer] * 3)
    g.mesh("inside", sphere(rings).flipped(), glass, translation=list(centre), scale=[inner] * 3)


def bulb():
    g = Gltf("point light in a glass bulb")
    lambert_floor(g, 1.0)
    shell(g, (0.0, 1.0, 0.0), 0.2, 0.15)
    g.light("point", LUX, COLOR_UNIT, (0.0, 1.0, 0.0))
    look_down(g, 0.5, 0.5)
    solid_angle = 4 * math.atan(0.25 / math.sqrt(1.5))  # of a square of side 1 from 1 m above its centre
    return answer(g, "mean E = I (1 - F(0))^2 times the square's solid angle over its area",
                  LUX * passed(1.0, GLASS) ** 2 * solid_angle, 3, "diffuse")


def bulb_in_sphere():
    """What the bulb reflects leaves it later, and nothing is absorbed."""
    g = Gltf("glass bulb in the middle of a closed sphere")
    g.mesh("sphere", sphere(40, smooth=False).flipped(), g.lambert("wall", (0.5, 0.5, 0.5)))
    shell(g, (0.0, 0.0, 0.0), 0.1, 0.07)
    g.light("point", PI, position=(0.0, 0.0, 0.0))
    g.camera((0.0, 0.0, 0.5), (0.6, 0.0, 1.0), yfov=0.6)
    answer(g, "L = rho I/(pi R^2 (1-rho)) as without the bulb, I = pi, rho = 1/2, R = 1", 1.0, 128, "diffuse", 6e-3)
    g.answer["expected"] = [1.0] * 3
    return g


GOLD = (1.0, 0.76, 0.33)


def gold(cosine):
    """What it reflects."""
    return tuple(oracles.schlick(c, cosine) for c in GOLD)


def mirror_sun():
    """The sheet that it shines on has its back to the sun."""
    g = Gltf("sun off a gold mirror")
    sheet(g, "mirror", 1.0, 0.0, g.material("gold", GOLD, metallic=1.0, roughness=0.0))
    back = quad((1.0, 1.0, -1.0), (2.6, 1.0, -1.0), (2.6, 1.0, 1.0), (1.0, 1.0, 1.0))
    g.mesh("ceiling", back, g.lambert("ceiling", ALBEDO, doubleSided=True))
    cosine = sun(g, 60)
    g.camera((2.0, 0.5, 0.0), (2.0, 1.0, 0.0), up=(0.0, 0.0, -1.0), extent=0.25)
    return answer(g, "E = E_sun cos 60 F, Schlick's F", LUX * cosine, 2, "diffuse", tint=gold(cosine))


def mirror_seen():
    """The camera looks along -x into a mirror that is inclined by half a right angle and shows the floor."""
    g = Gltf("sun through a glass plate, seen in a mirror")
    lambert_floor(g, 1.5)
    g.mesh("plate", box((-2.4, 0.8, -2.4), (2.4, 0.9, 2.4)), g.glass("glass", GLASS))
    m = 0.2
    g.mesh("mirror", quad((-m, 0.5 - m, m), (m, 0.5 + m, m), (m, 0.5 + m, -m), (-m, 0.5 - m, -m)).flipped(),
           g.material("gold", GOLD, metallic=1.0, roughness=0.0, doubleSided=True))
    cosine = sun(g, 60)
    g.camera((1.0, 0.5, 0.0), (0.0, 0.5, 0.0), extent=0.15)
    return answer(g, "E = E_sun cos 60 (1 - F)^2, seen at 45 degrees by Schlick's F of gold",
                  LUX * cosine * passed(cosine, GLASS) ** 2, 4, "specular", tint=gold(math.sqrt(0.5)))


def bulb_seen():
    """As mirror_seen, under a lamp in a bulb that stands aside of the mirror's shadow."""
    g = Gltf("point light in a glass bulb, the floor seen in a mirror")
    lambert_floor(g, 1.5)
    aside, above, half = 0.8, 1.0, 0.15
    shell(g, (aside, above, 0.0), 0.2, 0.15)
    m = 0.2
    g.mesh("mirror", quad((-m, 0.5 - m, m), (m, 0.5 + m, m), (m, 0.5 + m, -m), (-m, 0.5 - m, -m)).flipped(),
           g.material("gold", GOLD, metallic=1.0, roughness=0.0, doubleSided=True))
    g.light("point", LUX, COLOR_UNIT, (aside, above, 0.0))
    g.camera((1.0, 0.5, 0.0), (0.0, 0.5, 0.0), extent=half)
    steps, mean = 32, 0.0
    for i in range(steps):
        for j in range(steps):
            x, z = (((2 * k + 1) / steps - 1) * half for k in (i, j))
            d2 = (x - aside) ** 2 + above ** 2 + z ** 2
            mean += above / d2 ** 1.5 / steps ** 2
    return answer(g, "E = I (1 - F(0))^2 cos/d^2 (midpoint rule), seen at 45 degrees by Schlick's F of gold",
                  LUX * passed(1.0, GLASS) ** 2 * mean, 4, "specular", 1e-4, gold(math.sqrt(0.5)))


def wedge(apex, side, depth):
    """A glass prism along z, one edge up at `apex`, its other two faces below at 30 degrees to the vertical."""
    x, y = apex
    h = side * math.sqrt(0.75)
    corners = [(x, y), (x - side / 2, y - h), (x + side / 2, y - h)]
    front, rear = ([(a, b, z) for a, b in corners] for z in (depth / 2, -depth / 2))
    faces = [Shape(front, [0, 1, 2]), Shape(rear, [0, 2, 1])]
    faces += [quad(front[i], rear[i], rear[k], front[k]) for i, k in ((0, 1), (1, 2), (2, 0))]
    return faces


def prism_beam():
    """At least deviation: equal angles at both faces, so a beam keeps its width. A plate with a hole stops the rest."""
    g = Gltf("sunbeam through a prism")
    incidence = math.asin(GLASS * 0.5)
    turn = incidence - PI / 6  # the beam rises by this towards the prism and falls by it behind
    d_in, d_out = (math.cos(turn), math.sin(turn), 0.0), (math.cos(turn), -math.sin(turn), 0.0)
    g.mesh("prism", join(wedge((0.0, 0.2), 0.4, 1.0)), g.glass("glass", GLASS))
    middle = (0.0, 0.2 - 0.4 * math.sqrt(0.75) / 2, 0.0)  # the beam crosses the prism level, at half its height
    entry = (-0.1, middle[1], 0.0)
    up_in = (-d_in[1], d_in[0], 0.0)
    across = (0.0, 0.0, 1.0)

    def plate(direction, up, centre, lo, hi, z0, z1):
        """Faces against `direction`."""
        def at(v, z):
            return tuple(c + v * u + z * w for c, u, w in zip(centre, up, across))
        return quad(at(lo, z0), at(lo, z1), at(hi, z1), at(hi, z0))

    hole = tuple(c - 0.3 * d for c, d in zip(entry, d_in))
    black = g.lambert("black", (0.0, 0.0, 0.0), doubleSided=True)
    h, w, far = 0.06, 0.2, 1.2
    g.mesh("plate", join([plate(d_in, up_in, hole, -far, -h, -far, far), plate(d_in, up_in, hole, h, far, -far, far),
                          plate(d_in, up_in, hole, -h, h, -far, -w), plate(d_in, up_in, hole, -h, h, w, far)]), black)
    exit_point = (0.1, middle[1], 0.0)
    up_out = (d_out[1] * -1.0, d_out[0], 0.0)
    screen = tuple(c + 0.5 * d for c, d in zip(exit_point, d_out))
    g.mesh("screen", plate(d_out, up_out, screen, -0.2, 0.2, -0.4, 0.4), g.lambert("screen", ALBEDO, doubleSided=True))
    g.light("directional", LUX, COLOR_UNIT, direction=d_in)
    eye = tuple(c - 0.2 * d for c, d in zip(screen, d_out))
    g.camera(eye, screen, up=up_out, extent=0.04)
    return answer(g, "asin(n/2) at both faces: E = E_sun (1 - F)^2", LUX * passed(math.cos(incidence), GLASS) ** 2, 3,
                  "diffuse")


def scenes():
    """File stem, scene; its `answer` goes to expected.json."""
    for build in (water_flat, water_flat_from_above, water_wavy, slab_sun, panes, bulb, bulb_in_sphere, mirror_sun,
                  mirror_seen, bulb_seen, prism_beam):
        yield build.__name__, build()
