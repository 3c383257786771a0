"""The zip, installed as a user does, renders; `-- FILE` is the zip, of the kind for this Blender."""

import math
import sys

import bpy

import stage

archive = sys.argv[sys.argv.index("--") + 1]
bpy.ops.wm.read_factory_settings(use_empty=True)
if bpy.app.version < (4, 2, 0):
    bpy.ops.preferences.addon_install(filepath=archive)
    bpy.ops.preferences.addon_enable(module="wavepath_blender")
else:
    bpy.ops.extensions.package_install_files(filepath=archive, repo="user_default", enable_on_install=True)
if not hasattr(bpy.types.Scene, "wavepath"):
    raise SystemExit("not installed")
stage.add_on = lambda: None
addons = [name for name in bpy.context.preferences.addons.keys() if name.endswith("wavepath_blender")]
if not sys.modules[addons[0]].__file__.startswith(stage.FOLDER):
    raise SystemExit("%s is another one" % sys.modules[addons[0]].__file__)
preferences = bpy.context.preferences.addons[addons[0]].preferences
print("installed as", addons, "with", [p.identifier for p in preferences.bl_rna.properties][-2:])
scene = bpy.context.scene
scene.render.engine = "WAVEPATH"
scene.render.resolution_x = scene.render.resolution_y = 32
scene.render.resolution_percentage = 100
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.image_settings.color_depth = "32"
stage.plane(4, stage.white(0.8))
stage.camera((3, 0, 3), (0, 0, 0), 0.004)
stage.lamp("POINT", 100)
stage.near("a plane under a lamp", stage.mean(stage.render("installed")), 0.8 / math.pi * 100 / (16 * math.pi), 0.005)
preferences.program = "/no/such/program"
try:
    bpy.ops.render.render()
    raise SystemExit("the program of the preferences is not used")
except RuntimeError as problem:
    print("told:", problem)
bpy.ops.preferences.addon_disable(module=addons[0])
if hasattr(bpy.types.Scene, "wavepath"):
    raise SystemExit("not removed")
print("INSTALLED DONE")
