"""The steps of an export: open, flatten, write, and complete by what the exporter leaves out."""

import json
import os

import bpy

from . import bake, collect, gltf, lamps, lens, lost, materials, motion, world


def run(folder):
    with open(os.path.join(folder, "job.json")) as file:
        job = json.load(file)
    scene = open_scene(os.path.join(folder, "copy.blend"), job)
    told = lost.Lost()
    poses = [export_pose(folder, scene, job, moment, told) for moment in moments_of(scene, job)]
    flags, names = poses[0]
    if len(poses) > 1:
        if motion.join(os.path.join(folder, "0.glb"), os.path.join(folder, "1.glb"), told):
            flags += ["--animation", "0", "--shutter", "0,1"]
    os.replace(os.path.join(folder, "0.glb"), os.path.join(folder, "scene.glb"))
    flags += world.flags_of(scene, folder, told)
    answer = {"flags": flags, "lost": told.lines(), **names}
    with open(os.path.join(folder, "export.json.part"), "w") as file:
        json.dump(answer, file)
    os.replace(os.path.join(folder, "export.json.part"), os.path.join(folder, "export.json"))


def open_scene(path, job):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    empty = bpy.context.scene
    empty.name = "wavepath empty"
    with bpy.data.libraries.load(path, link=False) as (_, wanted):
        wanted.scenes = [job["scene"]]
    scene = wanted.scenes[0]
    bpy.context.window.scene = scene
    bpy.data.scenes.remove(empty)
    for layer in scene.view_layers:
        layer.use = layer.name == job["view_layer"]
    bpy.context.window.view_layer = scene.view_layers[job["view_layer"]]
    return scene


def moments_of(scene, job):
    """Frames to export: one, or with motion blur those at which the shutter opens and closes."""
    if not job["motion_blur"]:
        return [job["frame"]]
    render = scene.render
    cycles = getattr(scene, "cycles", None)
    shutter = render.motion_blur_shutter
    position = getattr(render, "motion_blur_position", None) or getattr(cycles, "motion_blur_position", "CENTER")
    begin = {"START": 0.0, "CENTER": -shutter / 2, "END": -shutter}[position]
    return [job["frame"] + begin, job["frame"] + begin + shutter]


def export_pose(folder, scene, job, moment, told):
    """Writes N.glb. Gives flags and what the names of nodes and materials stand for."""
    first = not os.path.exists(os.path.join(folder, "0.glb"))
    path = os.path.join(folder, "0.glb" if first else "1.glb")
    told = told if first else lost.Lost()
    if first:
        materials.simplify()
    frame = int(moment // 1)
    scene.frame_set(frame, subframe=moment - frame)
    found = collect.collect(scene, job, told)
    if first and job["bake"]:
        bake.replace(found, job["bake"])
    materials.tell(found.meshes.values(), told)
    shining = lamps.to_meshes(found, job, told)
    gltf.write(path, found.flat)
    flags = lens.flags_of(found, job, told) + shining.flags
    names = gltf.complete(path, found, shining)
    collect.clear(found, scene)
    return flags, names
