"""Everything that Blender would render at one moment, as plain objects in a scene of its own.

A render engine alone sees modifiers, instances and visibility as renders have them, so this is one. Objects become
meshes of evaluated geometry: no modifiers, curves, instances, parents or animation are left to export.
"""

import traceback
from dataclasses import dataclass, field

import bpy
import mathutils

FLAT = "wavepath flat"
MESH_LIKE = ("MESH", "CURVE", "SURFACE", "META", "FONT")
WITHOUT_SURFACE = ("LIGHT", "CAMERA", "EMPTY", "ARMATURE", "LATTICE", "SPEAKER", "LIGHT_PROBE")
LOST_KINDS = {"VOLUME": "volume: left out", "CURVES": "hair curves: left out",
              "GPENCIL": "grease pencil: left out", "GREASEPENCIL": "grease pencil: left out",
              "POINTCLOUD": "point cloud: left out"}


@dataclass
class Lamp:
    light: object
    name: str
    matrix: mathutils.Matrix


@dataclass
class Found:
    flat: object = None
    lamps: list = field(default_factory=list)
    camera: object = None  # Camera, if there is one
    originals: dict = field(default_factory=dict)  # name in the flat scene: (name, pass index)
    meshes: dict = field(default_factory=dict)
    problem: str = ""


@dataclass
class Camera:
    name: str
    matrix: mathutils.Matrix
    projection: mathutils.Matrix
    data: object
    focus: float


class Collector(bpy.types.RenderEngine):
    bl_idname = "WAVEPATH_COLLECT"
    bl_label = "wavepath export"

    def render(self, depsgraph):
        found, job, told = Collector.now
        try:
            gather(depsgraph, found, job, told)
        except Exception:  # Blender would print it and go on
            found.problem = traceback.format_exc()


def collect(scene, job, told):
    found = Found(flat=bpy.data.scenes.new(FLAT))
    if not Collector.is_registered:
        bpy.utils.register_class(Collector)
    Collector.now = (found, job, told)
    render = scene.render
    render.engine = Collector.bl_idname
    render.resolution_x = render.resolution_y = 16
    render.use_border = render.use_compositing = render.use_sequencer = render.use_multiview = False
    bpy.ops.render.render()
    if found.problem:
        raise RuntimeError(found.problem)
    return found


def clear(found, scene):
    """Leaves the given scene alone, as it was opened."""
    bpy.context.window.scene = scene
    bpy.data.batch_remove([*found.flat.objects, *found.meshes.values()])
    bpy.data.scenes.remove(found.flat)


def gather(depsgraph, found, job, told):
    camera = depsgraph.scene.camera
    if camera is not None:
        camera = camera.evaluated_get(depsgraph)
        found.camera = camera_of(camera, depsgraph, job)
    for instance in depsgraph.object_instances:
        thing = instance.object
        if thing.type == "LIGHT":
            if instance.show_self or instance.is_instance:
                found.lamps.append(Lamp(thing.data.copy(), thing.name, instance.matrix_world.copy()))
            continue
        tell_of(thing, told)
        if thing.type in MESH_LIKE and (instance.show_self or instance.is_instance):
            add_surface(instance, depsgraph, found)


def camera_of(thing, depsgraph, job):
    data = thing.data
    width, height = job["size"]
    projection = thing.calc_matrix_camera(depsgraph, x=width, y=height, scale_x=job["pixel_aspect"][0],
                                          scale_y=job["pixel_aspect"][1])
    matrix = thing.matrix_world.normalized()
    focus = data.dof.focus_distance
    if data.dof.focus_object is not None:
        target = data.dof.focus_object.evaluated_get(depsgraph).matrix_world.translation
        focus = abs((matrix.inverted() @ target).z)
    return Camera(thing.name, matrix, projection, data.copy(), focus)


def tell_of(thing, told):
    if thing.type in LOST_KINDS:
        told.add(LOST_KINDS[thing.type], thing.name)
    if any(s.settings.type == "HAIR" and s.settings.render_type == "PATH" for s in thing.particle_systems):
        told.add("hair: left out", thing.name)
    if thing.is_holdout:
        told.add("holdout: shown as a surface", thing.name)
    if thing.is_shadow_catcher:
        told.add("shadow catcher: shown as a surface", thing.name)
    rays = ("camera", "diffuse", "glossy", "transmission", "volume_scatter", "shadow")
    if thing.type in MESH_LIKE and not all(getattr(thing, "visible_" + ray) for ray in rays):
        told.add("visibility to kinds of rays: seen by all", thing.name)


def add_surface(instance, depsgraph, found):
    thing, matrix = instance.object, instance.matrix_world.copy()
    slots = tuple(slot.material.name if slot.material else "" for slot in thing.material_slots)
    # Evaluated meshes are shared unless modifiers or slots differ. Of curves and such, each object has its own shape.
    key = (thing.data.as_pointer(), "" if thing.type == "MESH" else thing.name, slots)
    if key not in found.meshes:
        mesh = bpy.data.meshes.new_from_object(thing, preserve_all_data_layers=True, depsgraph=depsgraph)
        drop_unused_colours(mesh)
        found.meshes[key] = mesh
    mesh = found.meshes[key]
    if not mesh.polygons:
        return
    place, turn, scale = matrix.decompose()
    if largest_difference(mathutils.Matrix.LocRotScale(place, turn, scale), matrix) > 1e-5:  # sheared
        mesh = mesh.copy()
        mesh.transform(matrix)
        matrix = mathutils.Matrix()
        found.meshes[len(found.meshes)] = mesh
    copy = bpy.data.objects.new(thing.name, mesh)
    copy.matrix_world = matrix
    found.flat.collection.objects.link(copy)
    found.originals[copy.name] = (thing.name, thing.pass_index)


def largest_difference(a, b):
    return max(abs(x - y) for row, other in zip(a, b) for x, y in zip(row, other)) / max(1.0, b.median_scale)


def drop_unused_colours(mesh):
    """glTF multiplies them onto the base colour; Blender shows them only where a node reads them."""
    read = any(node.bl_idname in ("ShaderNodeVertexColor", "ShaderNodeAttribute")
               for material in mesh.materials if material and material.use_nodes for node in material.node_tree.nodes)
    if not read:
        for layer in list(mesh.color_attributes):
            mesh.color_attributes.remove(layer)
