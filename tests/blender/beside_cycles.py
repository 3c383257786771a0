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


def sky_file(scene):
    """A picture with a bright spot and a bright half, turned: glass and depth of field before it."""
    width, height = 256, 128
    u, v = numpy.meshgrid((numpy.arange(width) + 0.5) / width, (numpy.arange(height) + 0.5) / height)
    pixels = numpy.ones((height, width, 4), numpy.float32)
    pixels[..., 0], pixels[..., 1], pixels[..., 2] = 0.2 + 0.6 * v, 0.3 + 0.3 * v, 0.4 + 0.4 * u
    pixels[(abs(u - 0.3) < 0.04) & (abs(v - 0.75) < 0.06), :3] = 30
    image = bpy.data.images.new("sky", width, height, float_buffer=True)
    image.pixels = pixels.ravel()
    image.pack()
    tree = stage.world((1, 1, 1), 0.8).node_tree
    texture, mapping = tree.nodes.new("ShaderNodeTexEnvironment"), tree.nodes.new("ShaderNodeMapping")
    coordinate = tree.nodes.new("ShaderNodeTexCoord")
    texture.image = image
    mapping.inputs["Rotation"].default_value = (0, 0, 0.7)
    tree.links.new(coordinate.outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], tree.nodes["Background"].inputs["Color"])


def glass(scene):
    sky_file(scene)
    bpy.data.objects["ball"].data.materials[0] = stage.material("glass", "ShaderNodeBsdfGlass", IOR=1.45, Roughness=0)
    data = scene.camera.data
    data.dof.use_dof = True
    data.dof.focus_distance, data.dof.aperture_fstop, data.dof.aperture_blades = 3.8, 0.2, 6


def principled(scene):
    sky_file(scene)
    ball, box = bpy.data.objects["ball"].data.materials, bpy.data.objects["box"].data.materials
    ball[0] = stage.material("metal", "ShaderNodeBsdfPrincipled", Base_Color=(0.9, 0.6, 0.3, 1), Metallic=1,
                             Roughness=0.3)
    box[0] = stage.material("plastic", "ShaderNodeBsdfPrincipled", Base_Color=(0.2, 0.3, 0.7, 1), Roughness=0.4)


def see_through(scene):
    """By a number, on the box, and by a texture with holes on a card that faces away."""
    sky_file(scene)
    bpy.data.objects["box"].data.materials[0] = stage.material(
        "half", "ShaderNodeBsdfPrincipled", Base_Color=(0.1, 0.2, 0.7, 1), Alpha=0.4, Roughness=1)
    image = bpy.data.images.new("holes", 8, 8, alpha=True)
    image.pixels = [value for k in range(64) for value in (0.8, 0.5, 0.1, (k + k // 8) % 2)]
    image.pack()
    made = stage.material("holes", "ShaderNodeBsdfPrincipled", Roughness=1)
    tree = made.node_tree
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image, texture.interpolation = image, "Closest"
    node = next(n for n in tree.nodes if n.type == "BSDF_PRINCIPLED")
    tree.links.new(texture.outputs["Color"], node.inputs["Base Color"])
    tree.links.new(texture.outputs["Alpha"], node.inputs["Alpha"])
    made.use_backface_culling = True
    card = stage.plane(0.6, made, "card")
    layer = card.data.uv_layers.new(name="UVMap")
    for loop, corner in zip(layer.data, ((0, 0), (1, 0), (1, 1), (0, 1))):
        loop.uv = corner
    card.matrix_world = stage.look((0, -0.7, 0.7), (0, -2, 1.0)) @ stage.mathutils.Matrix.Rotation(math.pi, 4, "Y")


def baked(scene):
    """Noise on colour, roughness and bumps, on two meshes of which one has two materials."""
    sky_file(scene)
    scene.wavepath.bake, scene.wavepath.bake_size = True, 512
    made = stage.material("marble", "ShaderNodeBsdfPrincipled", Specular=0.0) if bpy.app.version < (4, 0, 0) else \
        stage.material("marble", "ShaderNodeBsdfPrincipled", Specular_IOR_Level=0.0)
    tree = made.node_tree
    node = next(n for n in tree.nodes if n.type == "BSDF_PRINCIPLED")
    noise, ramp, bump = (tree.nodes.new("ShaderNode" + kind) for kind in ("TexNoise", "ValToRGB", "Bump"))
    noise.inputs["Scale"].default_value = 3
    ramp.color_ramp.elements[0].color, ramp.color_ramp.elements[1].color = (0.6, 0.05, 0.02, 1), (0.1, 0.6, 0.8, 1)
    ramp.color_ramp.elements[0].position, ramp.color_ramp.elements[1].position = 0.4, 0.6
    bump.inputs["Strength"].default_value = 0.5
    tree.links.new(noise.outputs["Fac"], ramp.inputs["Fac"])
    tree.links.new(ramp.outputs["Color"], node.inputs["Base Color"])
    tree.links.new(noise.outputs["Fac"], node.inputs["Roughness"])
    tree.links.new(noise.outputs["Fac"], bump.inputs["Height"])
    tree.links.new(bump.outputs["Normal"], node.inputs["Normal"])
    bpy.data.objects["ball"].data.materials[0] = made
    box = bpy.data.objects["box"].data
    box.materials.append(made)
    for face in box.polygons:
        face.material_index = face.index % 2


def parallel(scene):
    stage.world((0.7, 0.8, 1.0), 0.8)
    scene.camera.data.type = "ORTHO"
    scene.camera.data.ortho_scale = 3.5
    scene.camera.data.shift_x, scene.camera.data.shift_y = 0.1, -0.05


def clipped(scene):
    """The ball's front and the floor's far end are cut off."""
    stage.world((0.7, 0.8, 1.0), 0.8)
    scene.camera.data.clip_start, scene.camera.data.clip_end = 5.1, 7.0


def shifted(scene):
    stage.world((0.7, 0.8, 1.0), 0.8)
    scene.camera.data.sensor_fit = "AUTO"
    scene.camera.data.shift_x, scene.camera.data.shift_y = 0.15, -0.1


def upright(scene):
    shifted(scene)
    scene.render.resolution_x, scene.render.resolution_y = 64, 96


def wide_pixels(scene):
    shifted(scene)
    scene.render.pixel_aspect_x = 2


def sphere(scene):
    sky_file(scene)
    scene.camera.data.type = "PANO"
    kind = scene.camera.data if hasattr(scene.camera.data, "panorama_type") else scene.camera.data.cycles
    kind.panorama_type = "EQUIRECTANGULAR"


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
    "sky_file": sky_file,
    "glass": glass,
    "principled": principled,
    "see_through": see_through,
    "baked": baked,
    "parallel": parallel,
    "clipped": clipped,
    "shifted": shifted,
    "upright": upright,
    "wide_pixels": wide_pixels,
    "sphere": sphere,
}
# Rims of cones have another shape. Lamps with a size of their own are noisier, and throw shadows themselves. Caustics
# of glass and gloss are noisy in both.
PIXELS = {"spot": 0.25, "spot_wide_rim": 0.25, "lamps": 0.15, "glass": 0.2, "principled": 0.1}

wanted = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
for case in [case for case in CASES if not wanted or case in wanted]:
    compare(case, CASES[case], of_pixels=PIXELS.get(case, 0.06))
print("BESIDE CYCLES DONE")
