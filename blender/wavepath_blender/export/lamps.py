"""Lamps: those with a size as meshes that shine, the others as lights of glTF. Radiance and power are Cycles'."""

import math
from dataclasses import dataclass, field

import bmesh
import bpy
import mathutils

CORNERS = 64  # of a disc
SUBDIVISIONS = 4  # of an icosahedron
STEPS = 1000
# Watts of an area lamp for each unit of radiance and square metre: Cycles has the true one since Blender 4.0.
AREA_WATTS = 4.0 if bpy.app.version < (4, 0, 0) else math.pi
SPOTS_HAVE_COSINE = bpy.app.version < (4, 0, 0)  # Cycles' cones grow dimmer with the cosine until there


@dataclass
class Shining:
    radiance: dict = field(default_factory=dict)  # name of the material: R, G, B
    lights: list = field(default_factory=list)  # (name, matrix, light of KHR_lights_punctual)
    flags: list = field(default_factory=list)


def to_meshes(found, job, told):
    shining = Shining()
    soft = [lamp for lamp in found.lamps if lamp.light.type in ("POINT", "SPOT")]
    radii = {round(lamp.light.shadow_soft_size, 6) for lamp in soft}
    one_radius = len(radii) == 1 and job["soft_lamps"]
    if one_radius and radii != {0.0}:
        shining.flags += ["--lamp-radius", repr(radii.pop())]
    suns = [lamp for lamp in found.lamps if lamp.light.type == "SUN"]
    angles = {round(lamp.light.angle, 6) for lamp in suns}
    if angles and angles != {0.0}:
        if job["soft_lamps"]:
            brightest = max(suns, key=lambda lamp: max(colour_of(lamp, None)))
            shining.flags += ["--sun-angle", repr(math.degrees(brightest.light.angle))]
        for lamp in suns:
            if not job["soft_lamps"]:
                told.add("angle of a sun: 0, as the integrator has hard suns alone", lamp.name)
            elif lamp.light.angle != brightest.light.angle:
                told.add("angle of a sun: that of the brightest", lamp.name)
    for lamp in found.lamps:
        kind, size = lamp.light.type, getattr(lamp.light, "shadow_soft_size", 0.0)
        if max(colour_of(lamp, told)) <= 0:
            continue
        if kind == "AREA" or (kind == "POINT" and size > 0 and not one_radius):
            told.add("lamp with a surface: is seen and throws a shadow", lamp.name)
        if kind == "AREA":
            area_mesh(lamp, found, shining, told)
        elif kind == "POINT" and size > 0 and not one_radius:
            sphere_mesh(lamp, found, shining, told)
        else:
            if kind == "SPOT" and size > 0 and not one_radius:
                told.add("radius of a spot beside lamps of other radii: shadows have hard edges", lamp.name)
            shining.lights.append((lamp.name, lamp.matrix.normalized(), punctual(lamp)))
    return shining


def colour_of(lamp, told):
    """Watts (of a sun: W/m^2) as red, green and blue."""
    light = lamp.light
    energy = light.energy * 2.0 ** getattr(light, "exposure", 0.0)
    colour = mathutils.Vector(light.color)
    if getattr(light, "use_temperature", False):
        colour = mathutils.Vector(a * b for a, b in zip(colour, light.temperature_color))
    if light.use_nodes and light.node_tree:
        factor = node_factor(light.node_tree)
        if factor is not None:
            colour = mathutils.Vector(a * b for a, b in zip(colour, factor))
        elif told is not None:
            told.add("nodes of a lamp: left out", lamp.name)
    return [energy * value for value in colour]


def node_factor(tree):
    """Colour times strength of a lone Emission node; None for any other tree."""
    output = next((n for n in tree.nodes if n.type == "OUTPUT_LIGHT" and n.is_active_output), None)
    if output is None or not output.inputs["Surface"].links:
        return None
    emission = output.inputs["Surface"].links[0].from_node
    if emission.type != "EMISSION" or any(socket.links for socket in emission.inputs):
        return None
    strength = emission.inputs["Strength"].default_value
    return [strength * value for value in emission.inputs["Color"].default_value[:3]]


def punctual(lamp):
    light = lamp.light
    colour = colour_of(lamp, None)
    largest = max(colour)
    told = {"type": {"SUN": "directional", "SPOT": "spot"}.get(light.type, "point"), "name": lamp.name,
            "color": [value / largest for value in colour],
            "intensity": largest if light.type == "SUN" else largest / (4 * math.pi)}
    if light.type == "SPOT":
        outer = light.spot_size / 2
        told["spot"] = {"outerConeAngle": outer, "innerConeAngle": inner_angle(outer, light.spot_blend)}
    return told


def inner_angle(outer, blend, with_cosine=SPOTS_HAVE_COSINE):
    """On the axis both send out the same; at the rim glTF falls with a square, Cycles by a smooth step. This is the
    angle that gives the cone the light that it has in Cycles."""
    edge = math.cos(outer)
    light = 0.0
    for k in range(STEPS):  # over the cosine, from the edge to the axis
        share = (k + 0.5) / STEPS
        t = min(share / blend, 1.0) if blend > 0 else 1.0
        light += t * t * (3 - 2 * t) * (edge + share * (1 - edge) if with_cosine else 1.0) / STEPS
    return min(math.acos(min(edge + 1.5 * (1 - edge) * (1 - light), 1.0)), outer * 0.9999)


def area_mesh(lamp, found, shining, told):
    light, matrix = lamp.light, lamp.matrix
    if not getattr(light, "normalize", True):  # of later versions
        told.add("area lamp whose power is not normalized: normalized", lamp.name)
    if getattr(light, "spread", math.pi) < math.pi - 1e-4:
        told.add("spread of an area lamp: 180 degrees", lamp.name)
    across = light.size
    along = light.size_y if light.shape in ("RECTANGLE", "ELLIPSE") else light.size
    x, y = across * matrix.col[0].to_3d().length, along * matrix.col[1].to_3d().length
    round_ = light.shape in ("DISK", "ELLIPSE")
    area = x * y * (math.pi / 4 if round_ else 1.0)
    if area <= 0:
        told.add("area lamp of no extent: left out", lamp.name)
        return
    if round_:
        # A polygon of the ellipse's area.
        radius = 0.5 * math.sqrt(2 * math.pi / CORNERS / math.sin(2 * math.pi / CORNERS))
        turns = [2 * math.pi * k / CORNERS for k in range(CORNERS)]
        corners = [(radius * math.cos(t), radius * math.sin(t)) for t in turns]
    else:
        corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
    mesh = bpy.data.meshes.new(lamp.name)
    # Lamps shine along -Z: seen from there, these corners go counter-clockwise.
    mesh.from_pydata([(x * u, y * v, 0.0) for u, v in reversed(corners)], [], [tuple(range(len(corners)))])
    add_shining(lamp, mesh, rigid(matrix), found, shining, 1 / (AREA_WATTS * area))


def sphere_mesh(lamp, found, shining, told):
    radius = lamp.light.shadow_soft_size
    shape = bmesh.new()
    bmesh.ops.create_icosphere(shape, subdivisions=SUBDIVISIONS, radius=1.0)
    surface = sum(face.calc_area() for face in shape.faces)
    grow = radius * math.sqrt(4 * math.pi / surface)  # it shows the disc that the sphere would, on average
    for vertex in shape.verts:
        vertex.co *= grow
    mesh = bpy.data.meshes.new(lamp.name)
    shape.to_mesh(mesh)
    shape.free()
    add_shining(lamp, mesh, rigid(lamp.matrix), found, shining, 1 / (4 * math.pi**2 * radius**2))


def rigid(matrix):
    place, turn, _ = matrix.decompose()
    return mathutils.Matrix.LocRotScale(place, turn, (1, 1, 1))


def add_shining(lamp, mesh, matrix, found, shining, radiance_of_watt):
    material = bpy.data.materials.new("wavepath lamp")
    material.use_backface_culling = True
    mesh.materials.append(material)
    thing = bpy.data.objects.new(lamp.name, mesh)
    thing.matrix_world = matrix
    found.flat.collection.objects.link(thing)
    found.meshes[thing.name] = mesh
    found.originals[thing.name] = (lamp.name, 0)
    shining.radiance[material.name] = [radiance_of_watt * value for value in colour_of(lamp, None)]
