#!/usr/bin/env python3
"""Writes a room with a mirror for a floor and a mirrored ball, as one .glb; the same bytes every time.

  mirrors.py FILE.glb
"""

import pathlib
import sys

from gltf import Gltf, box, quad, sphere


def mirrors():
    g = Gltf("mirrors")
    white, red = g.lambert("white", (0.73, 0.73, 0.73)), g.lambert("red", (0.57, 0.06, 0.05))
    green, blue = g.lambert("green", (0.10, 0.38, 0.08)), g.lambert("blue", (0.08, 0.16, 0.5))
    mirror = g.material("mirror", (0.85, 0.85, 0.88), metallic=1.0, roughness=0.0)
    g.mesh("floor", quad((-2.0, 0.0, -2.0), (-2.0, 0.0, 2.0), (2.0, 0.0, 2.0), (2.0, 0.0, -2.0)), mirror)
    g.mesh("ceiling", quad((-2.0, 2.4, -2.0), (2.0, 2.4, -2.0), (2.0, 2.4, 2.0), (-2.0, 2.4, 2.0)), white)
    g.mesh("back", quad((-2.0, 0.0, -2.0), (2.0, 0.0, -2.0), (2.0, 2.4, -2.0), (-2.0, 2.4, -2.0)), white)
    g.mesh("front", quad((2.0, 0.0, 2.0), (-2.0, 0.0, 2.0), (-2.0, 2.4, 2.0), (2.0, 2.4, 2.0)), blue)
    g.mesh("left", quad((-2.0, 0.0, 2.0), (-2.0, 0.0, -2.0), (-2.0, 2.4, -2.0), (-2.0, 2.4, 2.0)), red)
    g.mesh("right", quad((2.0, 0.0, -2.0), (2.0, 0.0, 2.0), (2.0, 2.4, 2.0), (2.0, 2.4, -2.0)), green)
    g.mesh("block", box((-1.2, 0.0, -1.2), (-0.5, 1.1, -0.6)), blue)
    g.mesh("plinth", box((0.4, 0.0, -1.1), (1.1, 0.35, -0.4)), white)
    g.mesh("shelf", box((-0.3, 0.55, 0.1), (0.3, 0.62, 0.5)), red)
    g.mesh("ball", sphere(32), mirror, translation=[0.75, 0.70, -0.75], scale=[0.35, 0.35, 0.35])
    g.mesh("lamp", quad((-0.4, 2.39, -0.4), (0.4, 2.39, -0.4), (0.4, 2.39, 0.4), (-0.4, 2.39, 0.4)),
           g.emitter("lamp", (12.0, 11.0, 9.0), (0.0, 0.0, 0.0)))
    g.camera((0.2, 1.25, 1.9), (0.0, 0.55, -0.9), yfov=0.95)
    return g


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    pathlib.Path(sys.argv[1]).write_bytes(mirrors().binary())
