"""A white plane under each kind of lamp has the radiance of its closed form, within 0.5 %."""

import math

import bpy

import stage

ALBEDO, HEIGHT, POWER = 0.8, 2.0, 100.0


def radiance(set_up, name, samples=64):
    """Of the plane's middle."""
    scene = stage.empty(samples=samples)
    scene.wavepath.integrator = "path"
    stage.plane(4, stage.white(ALBEDO))
    stage.camera((3, 0, 3), (0, 0, 0), 0.004)
    set_up(scene)
    return stage.mean(stage.render("lamp_" + name))


def check(name, set_up, irradiance, samples=64):
    stage.near(name, radiance(set_up, name, samples), ALBEDO / math.pi * irradiance, 0.005)


def lamp(kind, **values):
    return lambda _: stage.lamp(kind, POWER, (0, 0, HEIGHT), (0, 0, 0), **values)


INTENSITY = POWER / (4 * math.pi)
BELOW = INTENSITY / HEIGHT**2
AREA_WATTS = 4 if bpy.app.version < (4, 0, 0) else math.pi  # of a unit of radiance and a square metre

check("point", lamp("POINT"), BELOW)
check("point with a radius", lamp("POINT", shadow_soft_size=0.3), BELOW, 256)


def two_radii(_):
    """One of them out of sight, so that both become meshes."""
    stage.lamp("POINT", POWER, (0, 0, HEIGHT), shadow_soft_size=0.3)
    stage.lamp("POINT", POWER, (0, 0, -HEIGHT), shadow_soft_size=0.2, name="below")


check("point as a sphere of triangles", two_radii, BELOW, 256)
check("spot", lamp("SPOT", spot_size=math.radians(40), spot_blend=0.3), BELOW)
check("spot with a radius", lamp("SPOT", spot_size=math.radians(60), spot_blend=0.1, shadow_soft_size=0.05), BELOW, 256)
check("sun", lambda _: stage.lamp("SUN", 3.0), 3.0)
check("slanting sun", lambda _: stage.lamp("SUN", 3.0, (2, 0, 2)), 3.0 * math.sqrt(0.5))
check("sun with an angle", lambda _: stage.lamp("SUN", 3.0, angle=math.radians(5)), 3.0, 256)

for shape, x, y in (("SQUARE", 1.2, 1.2), ("RECTANGLE", 1.5, 0.5), ("DISK", 1.2, 1.2), ("ELLIPSE", 1.6, 0.7)):
    is_round = shape in ("DISK", "ELLIPSE")
    form = (stage.patch_of_ellipse if is_round else stage.patch_of_rectangle)(x, y, HEIGHT)
    area = x * y * (math.pi / 4 if is_round else 1)
    check("area lamp, " + shape.lower(), lamp("AREA", shape=shape, size=x, size_y=y),
          form * POWER / (AREA_WATTS * area), 256)


def scaled(_):
    stage.lamp("AREA", POWER, (0, 0, HEIGHT), shape="SQUARE", size=0.6).scale = (2, 2, 2)


check("area lamp, scaled", scaled, stage.patch_of_rectangle(1.2, 1.2, HEIGHT) * POWER / (AREA_WATTS * 1.44), 256)


def with_nodes(_):
    data = stage.lamp("POINT", POWER).data
    data.use_nodes = True
    emission = next(n for n in data.node_tree.nodes if n.type == "EMISSION")
    emission.inputs["Strength"].default_value = 0.5


check("point with an emission node", with_nodes, BELOW / 2)


def shining_plane(_):
    plane = stage.plane(0.6, stage.material("glow", "ShaderNodeEmission", Color=(1, 1, 1, 1), Strength=20), "glow")
    plane.matrix_world = stage.look((0, 0, HEIGHT), (0, 0, 10))


check("shining mesh", shining_plane, 20 * stage.patch_of_rectangle(1.2, 1.2, HEIGHT), 256)
check("world of one colour", lambda _: stage.world((1, 1, 1), 0.7), math.pi * 0.7)


def gradient(_):
    """Radiance 3 z above the horizon: irradiance 2 pi."""
    tree = stage.world((1, 1, 1)).node_tree
    coordinate = tree.nodes.new("ShaderNodeTexCoord")
    parts = tree.nodes.new("ShaderNodeSeparateXYZ")
    times = tree.nodes.new("ShaderNodeMath")
    times.operation = "MULTIPLY"
    times.inputs[1].default_value = 3
    tree.links.new(coordinate.outputs["Generated"], parts.inputs[0])
    tree.links.new(parts.outputs["Z"], times.inputs[0])
    tree.links.new(times.outputs[0], tree.nodes["Background"].inputs["Strength"])


check("world of nodes", gradient, 2 * math.pi, 256)


def side_light(sign):
    """Light from the half of the world where sign * x > 0; on a wall that faces +X."""

    def set_up(scene):
        tree = stage.world((1, 1, 1)).node_tree
        coordinate = tree.nodes.new("ShaderNodeTexCoord")
        parts = tree.nodes.new("ShaderNodeSeparateXYZ")
        above = tree.nodes.new("ShaderNodeMath")
        above.operation = "GREATER_THAN" if sign > 0 else "LESS_THAN"
        above.inputs[1].default_value = 0
        tree.links.new(coordinate.outputs["Generated"], parts.inputs[0])
        tree.links.new(parts.outputs["Y"], above.inputs[0])
        tree.links.new(above.outputs[0], tree.nodes["Background"].inputs["Strength"])
        bpy.data.objects["plane"].matrix_world = stage.look((0, 0, 0), (0, -5, 0))  # its normal: +Y
        bpy.data.objects["camera"].matrix_world = stage.look((0, 3, 0.5), (0, 0, 0))

    return set_up


check("half a world, before the wall", side_light(1), math.pi, 256)
behind = radiance(side_light(-1), "behind", 16)
if behind > 0.01:
    raise SystemExit("half a world, behind the wall: %g" % behind)
print("LAMPS DONE")
