"""Hands a copy of the scene to a second Blender, which writes it as glTF."""

import json
import os

import bpy

MAIN = os.path.join(os.path.dirname(os.path.abspath(__file__)), "export", "main.py")


def write_copy(folder, depsgraph, size):
    """Everything that the scene needs, saved or not; files beside it by their whole paths."""
    scene = depsgraph.scene.original
    bpy.data.libraries.write(os.path.join(folder, "copy.blend"), {scene}, path_remap="ABSOLUTE", fake_user=True)
    render = scene.render
    job = {
        "scene": scene.name,
        "view_layer": depsgraph.view_layer.name,
        "frame": scene.frame_current + scene.frame_subframe,
        "size": size,
        "pixel_aspect": [render.pixel_aspect_x, render.pixel_aspect_y],
        "motion_blur": render.use_motion_blur and scene.wavepath.integrator in ("auto", "path"),
        "bake": scene.wavepath.bake_size if scene.wavepath.bake else 0,
        "soft_lamps": scene.wavepath.integrator not in ("whitted", "ao"),
    }
    with open(os.path.join(folder, "job.json"), "w") as file:
        json.dump(job, file)


def unsaved_images():
    """Painted images whose changes are in memory alone."""
    return [image.name for image in bpy.data.images if image.is_dirty and not image.packed_file and image.users]


def command(folder):
    flags = ["--enable-autoexec"] if bpy.context.preferences.filepaths.use_scripts_auto_execute else []
    return [bpy.app.binary_path, "--background", "--factory-startup", *flags, "--python", MAIN, "--", folder]


def read_answer(folder):
    """None if the second Blender has not got that far."""
    path = os.path.join(folder, "export.json")
    if not os.path.exists(path):
        return None
    with open(path) as file:
        return json.load(file)
