"""Settings: of a scene, of a view layer, and of the add-on."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty


class WavepathScene(bpy.types.PropertyGroup):
    samples: IntProperty(name="Samples", default=64, min=1, max=1 << 20, description="Samples per pixel")
    time: FloatProperty(name="Time", default=0.0, min=0.0, subtype="TIME_ABSOLUTE", unit="TIME_ABSOLUTE",
                        description="Longest rendering time in seconds; 0: no limit")
    target_error: FloatProperty(
        name="Target Error", default=0.0, min=0.0, max=1.0, precision=4,
        description="Stop when the estimated relative error is below this; 0: render all samples")
    max_depth: IntProperty(name="Bounces", default=8, min=0, max=1024,
                           description="Longest path in bounces. 1: direct light only")
    integrator: EnumProperty(
        name="Integrator", default="auto",
        items=(("auto", "Automatic", "Short pilots choose"), ("path", "Path", "Path tracing"),
               ("bidirectional", "Bidirectional", "Paths from the camera and from lights; for caustics"),
               ("hybrid", "Hybrid", "Real-time techniques: rasterized first hits, direct light, ambient occlusion"),
               ("whitted", "Whitted", "Direct light, mirrors and glass"), ("ao", "Ambient Occlusion", "Only that")))
    seed: IntProperty(name="Seed", default=0, min=0, description="Seed of the noise; the same gives the same picture")
    animate_seed: BoolProperty(name="Animate Seed", default=True, description="Other noise in every frame")
    denoise: BoolProperty(name="Denoise", default=False, description="Filter the noise of the finished picture")
    clamp: FloatProperty(name="Clamp", default=0.0, min=0.0,
                         description="Dim samples brighter than this, as fireflies are; 0: none. Needs Path")
    bake: BoolProperty(
        name="Bake Nodes", default=False,
        description="Let Cycles paint what glTF has no nodes for on image textures, before each render")
    bake_size: IntProperty(name="Texture Size", default=1024, min=16, max=8192, subtype="PIXEL",
                           description="Width and height of these textures, one for each mesh and socket")
    flags: StringProperty(name="More Flags", description="Further flags of `wavepath render`, as on a command line")


class WavepathLayer(bpy.types.PropertyGroup):
    use_pass_denoising: BoolProperty(
        name="Denoising Data", description="Passes Denoising Albedo and Denoising Normal, for the Denoise node")
    use_pass_samples: BoolProperty(name="Sample Count", description="Samples of each pixel: Debug Sample Count")


class WavepathPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    program: StringProperty(name="Program", subtype="FILE_PATH",
                            description="The program wavepath; empty: the one in PATH")
    device: StringProperty(name="Device", description="Name or number of the Vulkan device, as `wavepath info` lists "
                                                      "them; empty: the best one")

    def draw(self, _context):
        self.layout.prop(self, "program")
        self.layout.prop(self, "device")


CLASSES = (WavepathScene, WavepathLayer, WavepathPreferences)


def preferences():
    addon = bpy.context.preferences.addons.get(__package__)
    return addon.preferences if addon else None


def register():
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    bpy.types.Scene.wavepath = PointerProperty(type=WavepathScene)
    bpy.types.ViewLayer.wavepath = PointerProperty(type=WavepathLayer)


def unregister():
    del bpy.types.ViewLayer.wavepath
    del bpy.types.Scene.wavepath
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
