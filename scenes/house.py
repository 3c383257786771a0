"""The scenes to look at: Cornell box, furnaces, and the one that shows off."""

import math

from gltf import Gltf, box, join, prism, quad, sphere


def cornell_box():
    """The box measured at Cornell (Goral et al. 1984; geometry as published in millimetres), here in metres.

    The walls are single sheets that face inwards; the light hangs 1 mm under the ceiling and shines down only.
    """
    g = Gltf("Cornell box")

    def points(*corners):
        return quad(*((x / 1000, y / 1000, z / 1000) for x, y, z in corners))

    white = g.lambert("white", (0.73, 0.73, 0.73))
    red = g.lambert("red", (0.57, 0.043, 0.044))
    green = g.lambert("green", (0.105, 0.378, 0.076))
    light = g.emitter("light", (17.0, 12.0, 4.0), (0.78, 0.78, 0.78))
    g.mesh("floor", points((552.8, 0, 0), (0, 0, 0), (0, 0, 559.2), (549.6, 0, 559.2)), white)
    g.mesh("ceiling", points((556, 548.8, 0), (556, 548.8, 559.2), (0, 548.8, 559.2), (0, 548.8, 0)), white)
    g.mesh("back wall", points((549.6, 0, 559.2), (0, 0, 559.2), (0, 548.8, 559.2), (556, 548.8, 559.2)), white)
    g.mesh("right wall", points((0, 0, 559.2), (0, 0, 0), (0, 548.8, 0), (0, 548.8, 559.2)), green)
    g.mesh("left wall", points((552.8, 0, 0), (549.6, 0, 559.2), (556, 548.8, 559.2), (556, 548.8, 0)), red)
    g.mesh("light", points((343, 547.8, 227), (343, 547.8, 332), (213, 547.8, 332), (213, 547.8, 227)), light)
    short = [(0.130, 0.065), (0.082, 0.225), (0.240, 0.272), (0.290, 0.114)]
    tall = [(0.423, 0.247), (0.265, 0.296), (0.314, 0.456), (0.472, 0.406)]
    g.mesh("short block", prism(short, 0.165), white)
    g.mesh("tall block", prism(tall, 0.330), white)
    g.camera((0.278, 0.273, -0.8), (0.278, 0.273, 0.0), yfov=2 * math.atan(0.0125 / 0.035))
    return g
