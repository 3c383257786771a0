"""Boxes and balls under each kind of lamp have the mean radiance that Cycles gives them, within 3 %."""

import math
import sys

import bpy
import numpy

import stage

SIZE, OURS, THEIRS = (96, 64), 64, 128


def room(scene):
    stage.plane(6, stage.white(0.6), "floor")
    stage.ball(0.5, stage.material("red", Color=(0.7, 0.1, 0.1, 1)), (-0.7, 0.2, 0.5))
    bpy.ops.mesh.primitive_cube_add(size=0.8, location=(0.7, 0, 0.4), rotation=(0, 0, 0.5))
    bpy.context.object.data.materials.append(stage.material("blue", Color=(0.1, 0.2, 0.7, 1)))
    bpy.context.object.name = "box"
    stage.camera((0, -5, 2.2), (0, 0, 0.35), math.radians(28))


def compare(name, set_up, tolerance=0.03, of_pixels=0.06):
    """`of_pixels`: largest root of the mean square of differences, relative to the mean."""
    scene = stage.empty(SIZE, OURS)
    room(scene)
    set_up(scene)
    ours = stage.render(name + "_wavepath")
    stage.cycles(scene, THEIRS)
    theirs = stage.render(name + "_cycles")
    stage.near(name + ": mean beside Cycles", stage.mean(ours), stage.mean(theirs), tolerance)
    difference = numpy.stack([ours[c] - theirs[c] for c in "RGB"])
    spread = float(numpy.sqrt(numpy.mean(difference**2))) / stage.mean(theirs)
    print("%-40s %.4f" % (name + ": differences of pixels", spread), flush=True)
    if spread > of_pixels:
        raise SystemExit(name)


EYE, TARGET = (1.5, -2, 3.5), (0, 0, 0.3)


def lamp(kind, power, **values):
    return lambda _: stage.lamp(kind, power, EYE, TARGET, **values)


def all_of_them(scene):
    """Each of its own size."""
    stage.lamp("POINT", 100, (-2, -1, 3), TARGET, "point", shadow_soft_size=0.2)
    stage.lamp("POINT", 60, (-1, 2, 3.5), TARGET, "point small", shadow_soft_size=0.05, color=(1, 0.5, 0.2))
    stage.lamp("AREA", 80, (2.5, 0, 3), TARGET, "area", shape="DISK", size=1.0, color=(0.3, 0.6, 1))
    stage.lamp("SUN", 0.5, (0, -3, 3), TARGET, "sun", angle=0.05)
    stage.world((0.2, 0.25, 0.3), 0.3)


CASES = {
    "point": lamp("POINT", 200, shadow_soft_size=0.1),
    "point_hard": lamp("POINT", 200),
    "spot": lamp("SPOT", 400, spot_size=math.radians(45), spot_blend=0.15, shadow_soft_size=0.1),
    "spot_wide_rim": lamp("SPOT", 400, spot_size=math.radians(60), spot_blend=1.0),
    "sun": lamp("SUN", 2.0, angle=math.radians(3)),
    "square": lamp("AREA", 200, shape="SQUARE", size=1.0),
    "ellipse": lamp("AREA", 200, shape="ELLIPSE", size=1.5, size_y=0.6),
    "world": lambda _: stage.world((0.7, 0.8, 1.0), 0.8),
    "lamps": all_of_them,
}
# Rims of cones have another shape. Lamps with a size of their own are noisier, and throw shadows themselves.
PIXELS = {"spot": 0.25, "spot_wide_rim": 0.25, "lamps": 0.15}

for case in sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else CASES:
    compare(case, CASES[case], of_pixels=PIXELS.get(case, 0.06))
print("BESIDE CYCLES DONE")
