"""Scenes whose radiance has a closed form; each carries the formula and the value in extras.wavepath.

Most measure one point: an orthographic camera 2 um wide, close above the receiver, so that it stands in no light's way.
"""

import math

import oracles
from gltf import Gltf, add, box, disc, join, quad, scale, sphere

PI = math.pi
COLOR = (4.0, 2.0, 1.0)  # of light, so that a mixed-up channel shows
ALBEDO = (0.8, 0.5, 0.2)
UP = (0.0, 1.0, 0.0)
ORIGIN = (0.0, 0.0, 0.0)
COLOR_UNIT = (1.0, 0.5, 0.25)  # glTF keeps the colours of punctual lights within 0..1
FAR = 1000.0
NEEDS_LIGHT_SAMPLING = ["mis", "nee"]  # a point without extent is never hit by chance
NO_NEE = ["mis", "bsdf"]  # next-event estimation alone has no finite variance where a light touches the receiver


def flags(spp=256, depth=1, *more):
    return ["--size", "8x8", "--spp", str(spp), "--max-depth", str(depth), "--filter", "box", *more]


def each(function, *rgb):
    return tuple(function(*channel) for channel in zip(*rgb))


def product(*factors):
    return tuple(math.prod(channel) for channel in zip(*factors))


def floor(g, material, size=1.0):
    s = size
    g.mesh("floor", quad((-s, 0.0, -s), (-s, 0.0, s), (s, 0.0, s), (s, 0.0, -s)), material)


def look_down(g, extent=1e-6, height=0.05):
    g.camera((0.0, height, 0.0), ORIGIN, up=(0.0, 0.0, -1.0), extent=extent)


def receiver(name, camera_height=0.05):
    g = Gltf(name)
    floor(g, g.lambert("receiver", ALBEDO))
    look_down(g, height=camera_height)
    return g


def reflected(irradiance, light=COLOR):
    """Radiance that the receiver reflects of `irradiance`, per unit of light."""
    return scale(product(ALBEDO, light), irradiance / PI)


def area_light(name, shape, about, occluder=None, factor=1.0):
    g = receiver(name)
    g.mesh("light", shape, g.emitter("light", COLOR))
    if occluder:
        g.mesh("occluder", occluder, g.lambert("black", (0.0, 0.0, 0.0), doubleSided=True))
    e = oracles.mesh_irradiance(shape.triangles(), ORIGIN, UP)
    g.expect(about, reflected(e * factor), flags())
    return g


def disc_light():
    return area_light("disc light", disc(1.0, 2.0, 64), "E = pi L R^2/(R^2+h^2), R = 1, h = 2; here of the 64-gon")


def half_hidden_disc_light():
    half = quad((0.0, 1.0, -9.0), (9.0, 1.0, -9.0), (9.0, 1.0, 9.0), (0.0, 1.0, 9.0))
    return area_light("half-hidden disc light", disc(1.0, 2.0, 64), "an edge through the axis hides exactly half",
                      occluder=half, factor=0.5)


def sphere_light():
    body = sphere(32, smooth=False).moved((0.0, 3.0, 0.0))
    return area_light("sphere light", body, "E = pi L (R/d)^2, R = 1, d = 3; here of the polyhedron")


def tilted_sphere_light():
    body = sphere(32, smooth=False).moved((0.0, 3.0 * math.cos(1.0), 3.0 * math.sin(1.0)))
    return area_light("sphere light at one radian", body,
                      "E = pi L (R/d)^2 cos 1, R = 1, d = 3; here of the polyhedron")


def rectangle(x0, x1, z0, z1, y=1.0):
    """Faces down."""
    return quad((x0, y, z0), (x1, y, z0), (x1, y, z1), (x0, y, z1))


def rectangle_light_corner():
    g = receiver("unit square light above its corner")
    g.mesh("light", rectangle(0.0, 1.0, 0.0, 1.0), g.emitter("light", COLOR))
    f = oracles.corner_rectangle_form_factor(1, 1, 1)
    g.expect("E = pi L F(a/h, b/h), a = b = h = 1", reflected(PI * f), flags())
    return g


def rectangle_light_centre():
    g = receiver("unit square light above its centre")
    g.mesh("light", rectangle(-0.5, 0.5, -0.5, 0.5), g.emitter("light", COLOR))
    f = 4 * oracles.corner_rectangle_form_factor(0.5, 0.5, 1)
    g.expect("E = pi L F, four corners of half the side", reflected(PI * f), flags())
    return g


def rectangle_light_below_horizon():
    g = receiver("light that reaches below the horizon")
    light = quad((-1.0, -1.0, -0.5), (1.0, -1.0, -0.5), (1.0, 1.0, -0.5), (-1.0, 1.0, -0.5))
    g.mesh("light", light, g.emitter("light", COLOR))
    above = [(-1.0, 0.0, -0.5), (1.0, 0.0, -0.5), (1.0, 1.0, -0.5), (-1.0, 1.0, -0.5)]
    g.expect("Lambert's polygon formula of the part above the horizon",
             reflected(oracles.polygon_irradiance(above, ORIGIN, UP)), flags())
    return g


def touching_light():
    g = receiver("10 cm light 1 um above the receiver", camera_height=5e-7)
    g.mesh("light", rectangle(-0.05, 0.05, -0.05, 0.05, y=1e-6), g.emitter("light", COLOR))
    g.expect("E -> pi L as h -> 0", reflected(PI), flags(), slack=1e-5, estimators=NO_NEE)
    return g


def point_light():
    g = receiver("point light")
    g.light("point", 10.0, COLOR_UNIT, position=(1.0, 2.0, 0.0))
    e = 10.0 * (2 / math.sqrt(5.0)) ** 3 / 4
    g.expect("E = I cos^3/h^2, h = 2, 1 m aside", reflected(e, COLOR_UNIT), flags(), exact=2e-6,
             estimators=NEEDS_LIGHT_SAMPLING)
    return g


def ies(vertical, horizontal, candela, factors=(1.0, 1.0)):
    """Text of an LM-63 file of type C photometry; `candela`: by horizontal angle."""
    rows = [" ".join(f"{v:g}" for v in row) for row in (vertical, horizontal, *candela)]
    head = f"1 -1 {factors[0]:g} {len(vertical)} {len(horizontal)} 1 2 0 0 0\n{factors[1]:g} 1 10"
    return "\n".join(["IESNA:LM-63-2002", "[TEST] wavepath", "TILT=NONE", head, *rows]) + "\n"


def luminaire():
    """Aimed down, and turned so that the receiver lies at its horizontal angle of 60 degrees; 30 degrees off its axis,
    which is halfway between two vertical angles of the table."""
    g = receiver("luminaire with a measured profile")
    turned = math.radians(-60.0)
    h = 2.0
    aside = h * math.tan(math.radians(30.0))
    text = ies([0, 20, 40, 90], [0, 90], [[100, 80, 40, 0], [100, 50, 20, 0]], factors=(2.0, 0.5))
    # -Z of the node to -Y, +X to itself: a quarter turn about X; then about Y.
    quarter = (-math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))
    y = (0.0, math.sin(turned / 2), 0.0, math.cos(turned / 2))
    rotation = (y[3] * quarter[0] + y[1] * quarter[2], y[1] * quarter[3], -y[1] * quarter[0], y[3] * quarter[3])
    g.luminaire(text, COLOR_UNIT, 3.0, position=(-aside, h, 0.0), rotation=rotation)
    along = {0: (80 + 40) / 2, 90: (50 + 20) / 2}
    third = 60.0 / 90.0
    intensity = 3.0 * ((1 - third) * along[0] + third * along[90])
    e = intensity * math.cos(math.radians(30.0)) ** 3 / h ** 2
    g.expect("E = I cos^3/h^2, I of a table between its angles, h = 2, 30 degrees off the axis",
             reflected(e, COLOR_UNIT), flags(), exact=2e-5, estimators=NEEDS_LIGHT_SAMPLING)
    return g


def point_light_with_range():
    g = receiver("point light whose range is 3 m, 2 m away")
    g.light("point", 10.0, COLOR_UNIT, position=(0.0, 2.0, 0.0), range=3.0)
    g.expect("E = I/h^2 (1 - (h/range)^4), as KHR_lights_punctual has it",
             reflected(10.0 / 4 * (1 - (2 / 3) ** 4), COLOR_UNIT),
             flags(), exact=2e-6, estimators=NEEDS_LIGHT_SAMPLING)
    return g


def roof_under_the_sun():
    g = receiver("single-sided roof that faces the sun, and a lamp below it")
    g.mesh("roof", quad((-5.0, 1.0, 5.0), (5.0, 1.0, 5.0), (5.0, 1.0, -5.0), (-5.0, 1.0, -5.0)),
           g.lambert("black", (0.0, 0.0, 0.0)))
    g.light("directional", 10.0, COLOR_UNIT, direction=(0.0, -1.0, 0.0))
    g.light("point", 1.0, COLOR_UNIT, position=(0.0, 0.5, 0.0))
    g.expect("the lamp's E = I/h^2 alone, h = 1/2", reflected(4.0, COLOR_UNIT), flags(),
             estimators=NEEDS_LIGHT_SAMPLING)
    return g


def directional_light():
    g = receiver("directional light at 60 degrees")
    g.light("directional", 10.0, COLOR_UNIT, direction=(math.sin(PI / 3), -math.cos(PI / 3), 0.0))
    g.expect("L = albedo E cos/pi", reflected(5.0, COLOR_UNIT), flags(), exact=5e-6, estimators=NEEDS_LIGHT_SAMPLING)
    return g


def spot_light():
    g = receiver("inside the penumbra of a spot light")
    angle = 0.4
    g.light("spot", 10.0, COLOR_UNIT, position=(0.0, 2.0, 0.0), direction=(math.sin(angle), -math.cos(angle), 0.0),
            spot=(0.2, 0.6))
    e = 10.0 * oracles.spot_falloff(math.cos(angle), 0.2, 0.6) / 4
    g.expect("E = I falloff/h^2, 0.4 rad off the axis of a cone 0.2..0.6 rad, h = 2", reflected(e, COLOR_UNIT), flags(),
             exact=1e-5, estimators=NEEDS_LIGHT_SAMPLING)
    return g


def flat_scales():
    """A ball that its scale makes a disc, under a spot light whose own scale is zero."""
    g = Gltf("ball flattened to a disc, under a spot light of scale zero")
    g.mesh("disc", sphere(8), g.lambert("receiver", ALBEDO), translation=[0.3, 0.0, 0.1], scale=[1.0, 0.0, 1.0])
    look_down(g)
    angle = 0.4
    g.light("spot", 10.0, COLOR_UNIT, position=(0.0, 2.0, 0.0), direction=(math.sin(angle), -math.cos(angle), 0.0),
            spot=(0.2, 0.6))
    g.doc["nodes"][-1]["scale"] = [0.0, 0.0, 0.0]
    e = 10.0 * oracles.spot_falloff(math.cos(angle), 0.2, 0.6) / 4
    g.expect("E = I falloff/h^2 as without the scales", reflected(e, COLOR_UNIT), flags(), exact=1e-5,
             estimators=NEEDS_LIGHT_SAMPLING)
    return g


def lights_of_all_sizes():
    """Checks that the probability of picking a light cancels, however unequal the lights are."""
    g = receiver("seven lights over six decades")
    total = ORIGIN
    for i in range(5):
        light = rectangle(-2.5 + i, -2.0 + i, 0.2, 0.7)
        radiance = scale(COLOR, 10.0 ** (i - 2))
        g.mesh(f"light {i}", light, g.emitter(f"light {i}", radiance))
        total = add(total, reflected(oracles.mesh_irradiance(light.triangles(), ORIGIN, UP), radiance))
    g.light("point", 10.0, position=(-1.0, 2.0, 0.0))
    g.light("directional", 0.01, direction=(0.0, -1.0, 0.0))
    total = add(total, reflected(10.0 * (2 / math.sqrt(5.0)) ** 3 / 4 + 0.01, (1.0, 1.0, 1.0)))
    g.expect("the sum of each", total, flags(1024), estimators=NEEDS_LIGHT_SAMPLING)
    return g


def squares(name, about, shape, factor, **terms):
    g = Gltf(name)
    floor(g, g.lambert("receiver", ALBEDO), size=0.5)
    g.mesh("light", shape, g.emitter("light", COLOR))
    look_down(g, extent=0.5, height=0.5)
    g.expect(about, reflected(PI * factor), flags(), **terms)
    return g


def facing_squares():
    return squares("facing unit squares", "form factor between unit squares at distance 1: mean over the receiver",
                   rectangle(-0.5, 0.5, -0.5, 0.5), oracles.facing_squares_form_factor())


def adjacent_squares():
    wall = quad((-0.5, 0.0, -0.5), (0.5, 0.0, -0.5), (0.5, 1.0, -0.5), (-0.5, 1.0, -0.5))
    return squares("perpendicular unit squares",
                   "form factor between unit squares that share an edge: mean over the receiver", wall,
                   oracles.adjacent_squares_form_factor(), estimators=NO_NEE)


def inside_glowing_cube():
    g = Gltf("form factors inside a cube")
    x0, x1 = -0.5, 0.5
    ceiling_and_walls = join([rectangle(x0, x1, x0, x1),
                              quad((x0, 0.0, x0), (x1, 0.0, x0), (x1, 1.0, x0), (x0, 1.0, x0)),
                              quad((x1, 0.0, x1), (x0, 0.0, x1), (x0, 1.0, x1), (x1, 1.0, x1)),
                              quad((x0, 0.0, x1), (x0, 0.0, x0), (x0, 1.0, x0), (x0, 1.0, x1)),
                              quad((x1, 0.0, x0), (x1, 0.0, x1), (x1, 1.0, x1), (x1, 1.0, x0))])
    floor(g, g.lambert("receiver", ALBEDO), size=0.5)
    g.mesh("light", ceiling_and_walls, g.emitter("light", COLOR))
    look_down(g, extent=0.4, height=0.5)
    g.expect("the form factors of five faces sum to 1", product(ALBEDO, COLOR), flags())
    return g


def enclosure():
    g = Gltf("closed sphere of albedo 0.5 that glows")
    rho, le = (0.5, 0.25, 0.75), (0.5, 0.75, 0.25)
    g.mesh("sphere", sphere(16, smooth=False).flipped(), g.emitter("wall", le, rho))
    g.camera(ORIGIN, (1.0, 0.0, 0.0), yfov=1.0)
    g.expect("L = Le/(1-rho), any closed shape", each(lambda r, e: e / (1 - r), rho, le),
             flags(depth=128))
    return g


def truncated_enclosure():
    g = Gltf("closed box of albedo 0.9, eight bounces")
    inside = box((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0)).flipped()
    g.mesh("box", inside, g.emitter("wall", (0.1, 0.1, 0.1), (0.9, 0.9, 0.9)))
    g.camera(ORIGIN, (1.0, 0.0, 0.0), yfov=1.0)
    g.expect("L = Le (1-rho^9)/(1-rho)", [1 - 0.9 ** 9] * 3, flags(depth=8), estimators=NO_NEE)
    return g


def point_light_in_sphere():
    g = Gltf("point light at the centre of a closed sphere")
    g.mesh("sphere", sphere(64, smooth=False).flipped(), g.lambert("wall", (0.5, 0.5, 0.5)))
    g.light("point", PI, position=ORIGIN)
    g.camera((0.0, 0.0, 0.1), (1.0, 0.0, 0.1), yfov=1.0)
    g.expect("L = rho I/(pi R^2 (1-rho)), I = pi, rho = 1/2, R = 1", [1.0] * 3,
             flags(depth=128),
             slack=2e-3, estimators=NEEDS_LIGHT_SAMPLING)
    return g


def lit_ceiling():
    """The receiver sees no light but by way of the ceiling: the sun shines past its edge, from below."""
    g = Gltf("small ceiling that the sun lights from below")
    white = (0.9, 0.6, 0.3)
    floor(g, g.lambert("receiver", ALBEDO), size=0.2)
    g.mesh("ceiling", rectangle(-0.25, 0.25, -0.25, 0.25), g.lambert("ceiling", white))
    g.light("directional", 10.0, COLOR_UNIT, direction=(1.0, 1.0, 0.0))
    look_down(g)
    f = 4 * oracles.corner_rectangle_form_factor(0.25, 0.25, 1)
    ceiling = each(lambda r, e: r * e / PI, white, scale(COLOR_UNIT, 10.0 / math.sqrt(2.0)))
    g.expect("E = pi L F of a ceiling whose L = albedo E_sun cos/pi", reflected(PI * f, ceiling), flags(1024, depth=2),
             estimators=NEEDS_LIGHT_SAMPLING)
    return g


def ambient_occlusion(name, about, walls, expected):
    g = Gltf(name)
    floor(g, g.lambert("receiver", (1.0, 1.0, 1.0)), size=1000.0)
    g.mesh("walls", join(walls), g.lambert("black", (0.0, 0.0, 0.0), doubleSided=True))
    look_down(g)
    g.expect(about, [expected] * 3, flags(256, 1, "--env", "1,1,1"), slack=3e-4)
    return g


def occlusion_by_wall():
    wall = quad((-1.0, 0.0, -FAR), (-1.0, 1.0, -FAR), (-1.0, 1.0, FAR), (-1.0, 0.0, FAR))
    return ambient_occlusion("long wall of height 1 at distance 1", "1 - (1 - d/sqrt(d^2+h^2))/2", [wall],
                             1 - (1 - math.sqrt(0.5)) / 2)


def occlusion_in_wedge():
    d = 0.1
    wall = quad((-d, 0.0, -FAR), (-d, FAR, -FAR), (-d, FAR, FAR), (-d, 0.0, FAR))
    return ambient_occlusion("beside a tall wall", "wedge of opening angle b: (1 - cos b)/2", [wall], 0.5)


def occlusion_in_corner():
    d = 0.1
    walls = [quad((-d, 0.0, -d), (-d, FAR, -d), (-d, FAR, FAR), (-d, 0.0, FAR)),
             quad((-d, 0.0, -d), (FAR, 0.0, -d), (FAR, FAR, -d), (-d, FAR, -d))]
    return ambient_occlusion("corner of three planes", "an octant of the cosine-weighted sphere: 1/4", walls, 0.25)


def occlusion_in_open_box():
    x0, x1 = -0.5, 0.5
    walls = [quad((x0, 0.0, x0), (x1, 0.0, x0), (x1, 1.0, x0), (x0, 1.0, x0)),
             quad((x1, 0.0, x1), (x0, 0.0, x1), (x0, 1.0, x1), (x1, 1.0, x1)),
             quad((x0, 0.0, x1), (x0, 0.0, x0), (x0, 1.0, x0), (x0, 1.0, x1)),
             quad((x1, 0.0, x0), (x1, 0.0, x1), (x1, 1.0, x1), (x1, 1.0, x0))]
    return ambient_occlusion("floor of an open unit cube", "the form factor of its opening", walls,
                             4 * oracles.corner_rectangle_form_factor(0.5, 0.5, 1))


def scenes():
    """File stem, scene."""
    for build in (disc_light, half_hidden_disc_light, sphere_light, tilted_sphere_light, rectangle_light_corner,
                  rectangle_light_centre, rectangle_light_below_horizon, touching_light, point_light,
                  point_light_with_range, luminaire,
                  roof_under_the_sun, directional_light, spot_light, flat_scales, lights_of_all_sizes, facing_squares,
                  adjacent_squares, inside_glowing_cube, enclosure,
                  truncated_enclosure, point_light_in_sphere, lit_ceiling, occlusion_by_wall, occlusion_in_wedge,
                  occlusion_in_corner, occlusion_in_open_box):
        yield build.__name__, build()
