"""The scenes of pictures: Cornell box, furnaces, and the showcase."""

import math

from gltf import Gltf, box, join, prism, quad, sphere


def cornell_box(name="Cornell box", lamp=None, radiance=(17.0, 12.0, 4.0)):
    """The box measured at Cornell (Goral et al. 1984; geometry as published in millimetres), here in metres.

    The walls are single sheets that face inwards; the light hangs 1 mm under the ceiling and shines down only, or is
    `lamp`, a Shape in metres.
    """
    g = Gltf(name)

    def points(*corners):
        return quad(*((x / 1000, y / 1000, z / 1000) for x, y, z in corners))

    white = g.lambert("white", (0.73, 0.73, 0.73))
    red = g.lambert("red", (0.57, 0.043, 0.044))
    green = g.lambert("green", (0.105, 0.378, 0.076))
    light = g.emitter("light", radiance, (0.78, 0.78, 0.78))
    g.mesh("floor", points((552.8, 0, 0), (0, 0, 0), (0, 0, 559.2), (549.6, 0, 559.2)), white)
    g.mesh("ceiling", points((556, 548.8, 0), (556, 548.8, 559.2), (0, 548.8, 559.2), (0, 548.8, 0)), white)
    g.mesh("back wall", points((549.6, 0, 559.2), (0, 0, 559.2), (0, 548.8, 559.2), (556, 548.8, 559.2)), white)
    g.mesh("right wall", points((0, 0, 559.2), (0, 0, 0), (0, 548.8, 0), (0, 548.8, 559.2)), green)
    g.mesh("left wall", points((552.8, 0, 0), (549.6, 0, 559.2), (556, 548.8, 559.2), (556, 548.8, 0)), red)
    g.mesh("light", lamp or points((343, 547.8, 227), (343, 547.8, 332), (213, 547.8, 332), (213, 547.8, 227)), light)
    short = [(0.130, 0.065), (0.082, 0.225), (0.240, 0.272), (0.290, 0.114)]
    tall = [(0.423, 0.247), (0.265, 0.296), (0.314, 0.456), (0.472, 0.406)]
    g.mesh("short block", prism(short, 0.165), white)
    g.mesh("tall block", prism(tall, 0.330), white)
    g.camera((0.278, 0.273, -0.8), (0.278, 0.273, 0.0), yfov=2 * math.atan(0.0125 / 0.035))
    return g


def furnace(name, about, exact=None, **terms):
    """An environment of radiance 1, in which a body that absorbs nothing cannot be seen."""
    g = Gltf(name)
    g.camera((0.0, 1.2, 5.0), (0.0, 0.4, 0.0), yfov=0.7)
    flags = ["--size", "32x32", "--spp", "64", "--max-depth", "512", "--env", "1,1,1", "--filter", "box"]
    if exact:
        terms["exact"] = exact
    g.expect(about, [1.0] * 3, flags, **terms)
    return g


def furnace_lambert():
    g = furnace("white Lambert furnace", "albedo 1: L = 1, without variance as every path carries 1", exact=1e-6,
                estimators=["bsdf"])
    white = g.lambert("white", (1.0, 1.0, 1.0))
    g.mesh("ball", sphere(16, smooth=False), white, translation=[0.0, 1.0, 0.0])
    g.mesh("floor", quad((-2.0, 0.0, -2.0), (-2.0, 0.0, 2.0), (2.0, 0.0, 2.0), (2.0, 0.0, -2.0)), white)
    return g


def furnace_glass():
    """Faceted, because interpolated normals bend rays that flat ones would not."""
    g = furnace("glass furnace", "glass that absorbs nothing: L = 1, whatever its ior", exact=1e-5,
                estimators=["mis", "bsdf"])
    ball = g.shape(sphere(16, smooth=False))
    for i, ior in enumerate((1.0, 1.000001, 1.5, 2.4)):
        g.mesh(f"ior {ior}", ball, g.glass(f"ior {ior}", ior), translation=[i * 0.9 - 1.35, 0.4, 0.0], scale=[0.4] * 3)
    return g


def furnace_metal():
    """No single expected value: rougher metal loses more to the single-scattering model, but none may gain."""
    g = Gltf("metal furnace")
    ball = g.shape(sphere(16))
    for i in range(5):
        alpha = (0.01, 0.25, 0.5, 0.75, 1.0)[i]
        g.mesh(f"alpha {alpha}", ball, g.material(f"alpha {alpha}", metallic=1.0, roughness=math.sqrt(alpha)),
               translation=[i * 0.9 - 1.8, 0.0, 0.0], scale=[0.4] * 3)
    g.camera((0.0, 0.0, 6.0), (0.0, 0.0, 0.0), yfov=0.8, aspect=4.0)
    return g
