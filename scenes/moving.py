#!/usr/bin/env python3
"""Writes a room in which things move within a second, as one .glb; the same bytes every time. Its animation is "move".

  moving.py FILE.glb
"""

import math
import pathlib
import sys

from gltf import Gltf, box, quad, sphere


def turned(degrees):
    """About +Z."""
    half = math.radians(degrees) / 2
    return (0.0, 0.0, math.sin(half), math.cos(half))


def moving():
    g = Gltf("moving")
    white, red = g.lambert("white", (0.73, 0.73, 0.73)), g.lambert("red", (0.57, 0.06, 0.05))
    green, blue = g.lambert("green", (0.10, 0.38, 0.08)), g.lambert("blue", (0.08, 0.16, 0.5))
    dark = g.lambert("dark", (0.12, 0.11, 0.1))
    for i in range(8):  # a floor of strips, before whose edges the bodies pass
        x = -2.0 + 0.5 * i
        g.mesh(f"floor {i}", quad((x, 0.0, -2.0), (x, 0.0, 2.0), (x + 0.5, 0.0, 2.0), (x + 0.5, 0.0, -2.0)),
               dark if i % 2 else white)
    for i in range(16):
        x = -2.0 + 0.25 * i
        g.mesh(f"back {i}", quad((x, 0.0, -2.0), (x + 0.25, 0.0, -2.0), (x + 0.25, 2.4, -2.0), (x, 2.4, -2.0)),
               green if i % 2 else white)
    crate = g.mesh("crate", box((-0.3, 0.0, -0.3), (0.3, 0.6, 0.3)), red, translation=[-1.2, 0.0, -0.6])
    ball = g.mesh("ball", sphere(24), blue, translation=[0.9, 1.7, -0.9], scale=[0.3, 0.3, 0.3])
    bar = g.mesh("bar", box((-0.7, -0.08, -0.05), (0.7, 0.08, 0.05)), white, translation=[0.0, 1.2, -1.4])
    g.mesh("post", box((-0.06, 0.0, 0.5), (0.06, 1.3, 0.62)), dark, translation=[-0.3, 0.0, 0.0])
    g.animate("move", crate, "translation", {0.0: (-1.2, 0.0, -0.6), 1.0: (1.8, 0.0, -0.6)})
    g.animate("move", ball, "translation", {0.0: (0.9, 1.7, -0.9), 1.0: (0.9, 0.3, 0.3)})
    g.animate("move", bar, "rotation", {0.25 * i: turned(90.0 * i) for i in range(5)})
    g.mesh("lamp", quad((-0.4, 2.39, -0.4), (0.4, 2.39, -0.4), (0.4, 2.39, 0.4), (-0.4, 2.39, 0.4)),
           g.emitter("lamp", (12.0, 11.0, 9.0), (0.0, 0.0, 0.0)))
    g.camera((0.2, 1.25, 2.6), (0.0, 0.85, -0.9), yfov=0.95)
    return g


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    pathlib.Path(sys.argv[1]).write_bytes(moving().binary())
