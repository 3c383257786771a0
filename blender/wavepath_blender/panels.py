"""Panels: our own, and those of Blender that apply to wavepath as well."""

import bpy

# Of Eevee, beside all panels that any engine has.
OF_EEVEE = {"EEVEE_MATERIAL_PT_context_material", "EEVEE_MATERIAL_PT_surface", "EEVEE_WORLD_PT_surface",
            "DATA_PT_camera_dof", "DATA_PT_camera_dof_aperture"}
# Of any engine, for what wavepath does not have or has a panel of its own for.
WITHOUT_EFFECT = {
    "DATA_PT_light", "DATA_PT_area", "DATA_PT_spot", "DATA_PT_EEVEE_light", "DATA_PT_falloff_curve",
    "DATA_PT_camera_stereoscopy", "MATERIAL_PT_freestyle_line", "RENDER_PT_freestyle", "RENDER_PT_gpencil",
    "RENDER_PT_simplify_greasepencil", "RENDER_PT_stereoscopy", "VIEWLAYER_PT_layer_passes",
    "VIEWLAYER_PT_eevee_layer_passes_cryptomatte", "VIEWLAYER_PT_layer_passes_cryptomatte",
}


class WavepathPanel:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    COMPAT_ENGINES = {"WAVEPATH"}

    @classmethod
    def poll(cls, context):
        return context.engine in cls.COMPAT_ENGINES


class WAVEPATH_PT_sampling(WavepathPanel, bpy.types.Panel):
    bl_label = "Sampling"
    bl_context = "render"

    def draw(self, context):
        options, layout = context.scene.wavepath, self.layout
        layout.use_property_split = True
        for name in ("integrator", "samples", "time", "target_error", "max_depth", "clamp", "denoise", "seed",
                     "animate_seed", "flags"):
            layout.prop(options, name)


class WAVEPATH_PT_film(WavepathPanel, bpy.types.Panel):
    bl_label = "Film"
    bl_context = "render"

    def draw(self, context):
        self.layout.use_property_split = True
        self.layout.prop(context.scene.render, "film_transparent", text="Transparent")


class WAVEPATH_PT_motion_blur(WavepathPanel, bpy.types.Panel):
    bl_label = "Motion Blur"
    bl_context = "render"

    def draw_header(self, context):
        self.layout.prop(context.scene.render, "use_motion_blur", text="")

    def draw(self, context):
        self.layout.use_property_split = True
        render = context.scene.render
        if hasattr(render, "motion_blur_position"):
            self.layout.prop(render, "motion_blur_position")
        self.layout.prop(render, "motion_blur_shutter")


class WAVEPATH_PT_bake(WavepathPanel, bpy.types.Panel):
    bl_label = "Bake Nodes"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context):
        self.layout.prop(context.scene.wavepath, "bake", text="")

    def draw(self, context):
        self.layout.use_property_split = True
        self.layout.active = context.scene.wavepath.bake
        self.layout.prop(context.scene.wavepath, "bake_size")


class WAVEPATH_PT_light(WavepathPanel, bpy.types.Panel):
    bl_label = "Light"
    bl_context = "data"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and getattr(context, "light", None) is not None

    def draw(self, context):
        light, layout = context.light, self.layout
        layout.row().prop(light, "type", expand=True)
        layout.use_property_split = True
        names = ["color", "use_temperature", "temperature", "energy", "exposure"]  # some are of later versions
        names += {"POINT": ["shadow_soft_size"], "SUN": ["angle"], "AREA": ["shape", "size"],
                  "SPOT": ["shadow_soft_size", "spot_size", "spot_blend"]}[light.type]
        if light.type == "AREA" and light.shape in ("RECTANGLE", "ELLIPSE"):
            names.append("size_y")
        for name in names:
            if hasattr(light, name):
                layout.prop(light, name)


class WAVEPATH_PT_passes(WavepathPanel, bpy.types.Panel):
    bl_label = "Passes"
    bl_context = "view_layer"

    def draw(self, context):
        layer, layout = context.view_layer, self.layout
        layout.use_property_split = True
        for name in ("use_pass_z", "use_pass_position", "use_pass_normal", "use_pass_uv", "use_pass_object_index",
                     "use_pass_material_index", "use_pass_emit", "use_pass_environment",
                     "use_pass_cryptomatte_object", "use_pass_cryptomatte_material"):
            layout.prop(layer, name)
        layout.prop(layer.wavepath, "use_pass_denoising")
        layout.prop(layer.wavepath, "use_pass_samples")


CLASSES = (WAVEPATH_PT_light, WAVEPATH_PT_sampling, WAVEPATH_PT_motion_blur, WAVEPATH_PT_film, WAVEPATH_PT_bake,
           WAVEPATH_PT_passes)


def of_blender():
    """Panels that draw themselves for wavepath as well."""
    for kind in bpy.types.Panel.__subclasses__():
        engines = getattr(kind, "COMPAT_ENGINES", ())
        name = kind.__name__
        if name.startswith("NODE_"):  # the same in the sidebar of the node editor: they share their set of engines
            name = name[len("NODE_") :]
        left_out = name in WITHOUT_EFFECT or name.startswith("VIEWLAYER_PT_freestyle") or name.endswith("_PT_preview")
        if name in OF_EEVEE or ("BLENDER_RENDER" in engines and not left_out):
            yield kind


def register():
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    for kind in of_blender():
        kind.COMPAT_ENGINES.add("WAVEPATH")


def unregister():
    for kind in of_blender():
        kind.COMPAT_ENGINES.discard("WAVEPATH")
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
