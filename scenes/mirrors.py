#!/usr/bin/env python3
"""Writes a room with mirrors as one .glb; the same bytes every time.

  mirrors.py FILE.glb         a mirror for a floor, and a mirrored ball
  mirrors.py facing FILE.glb  mirrors on two walls that face each other, and one that leans
"""

import pathlib
import sys

from gltf import Gltf, box, quad, sphere


def room(g, floor, left, right):
    """A room with a lamp and things in it; walls in the materials given. Returns the material of mirrors."""
    white, red = g.lambert("white", (0.73, 0.73, 0.73)), g.lambert("red", (0.57, 0.06, 0.05))
    green, blue = g.lambert("green", (0.10, 0.38, 0.08)), g.lambert("blue", (0.08, 0.16, 0.5))
    mirror = g.material("mirror", (0.85, 0.85, 0.88), metallic=1.0, roughness=0.0)
    materials = {"white": white, "red": red, "green": green, "mirror": mirror}
    g.mesh("floor", quad((-2.0, 0.0, -2.0), (-2.0, 0.0, 2.0), (2.0, 0.0, 2.0), (2.0, 0.0, -2.0)), materials[floor])
    g.mesh("ceiling", quad((-2.0, 2.4, -2.0), (2.0, 2.4, -2.0), (2.0, 2.4, 2.0), (-2.0, 2.4, 2.0)), white)
    g.mesh("back", quad((-2.0, 0.0, -2.0), (2.0, 0.0, -2.0), (2.0, 2.4, -2.0), (-2.0, 2.4, -2.0)), white)
    g.mesh("front", quad((2.0, 0.0, 2.0), (-2.0, 0.0, 2.0), (-2.0, 2.4, 2.0), (2.0, 2.4, 2.0)), blue)
    g.mesh("left", quad((-2.0, 0.0, 2.0), (-2.0, 0.0, -2.0), (-2.0, 2.4, -2.0), (-2.0, 2.4, 2.0)), materials[left])
    g.mesh("right", quad((2.0, 0.0, -2.0), (2.0, 0.0, 2.0), (2.0, 2.4, 2.0), (2.0, 2.4, -2.0)), materials[right])
    g.mesh("block", box((-1.2, 0.0, -1.2), (-0.5, 1.1, -0.6)), blue)
    g.mesh("plinth", box((0.4, 0.0, -1.1), (1.1, 0.35, -0.4)), white)
    g.mesh("shelf", box((-0.3, 0.55, 0.1), (0.3, 0.62, 0.5)), red)
    return mirror


def lamp_and_camera(g, eye, target):
    g.mesh("lamp", quad((-0.4, 2.39, -0.4), (0.4, 2.39, -0.4), (0.4, 2.39, 0.4), (-0.4, 2.39, 0.4)),
           g.emitter("lamp", (12.0, 11.0, 9.0), (0.0, 0.0, 0.0)))
    g.camera(eye, target, yfov=0.95)


def mirrors():
    g = Gltf("mirrors")
    mirror = room(g, "mirror", "red", "green")
    g.mesh("ball", sphere(32), mirror, translation=[0.75, 0.70, -0.75], scale=[0.35, 0.35, 0.35])
    lamp_and_camera(g, (0.2, 1.25, 1.9), (0.0, 0.55, -0.9))
    return g


def facing():
    g = Gltf("facing mirrors")
    mirror = room(g, "white", "mirror", "mirror")
    g.mesh("leaning", quad((-0.4, 0.3, -1.7), (1.6, 0.3, -1.1), (1.6, 1.8, -1.3), (-0.4, 1.8, -1.9)), mirror)
    lamp_and_camera(g, (1.5, 1.3, 1.4), (-1.4, 0.9, -0.9))
    return g


if __name__ == "__main__":
    if len(sys.argv) == 2:
        pathlib.Path(sys.argv[1]).write_bytes(mirrors().binary())
    elif len(sys.argv) == 3 and sys.argv[1] == "facing":
        pathlib.Path(sys.argv[2]).write_bytes(facing().binary())
    else:
        sys.exit(__doc__)
