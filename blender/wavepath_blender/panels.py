"""Panels: our own, and those of Blender that apply to wavepath as well."""

import bpy

OF_BLENDER = {
    "RENDER_PT_color_management", "RENDER_PT_color_management_curves", "RENDER_PT_dimensions", "RENDER_PT_output",
    "RENDER_PT_format", "RENDER_PT_frame_range", "RENDER_PT_time_stretching", "RENDER_PT_post_processing",
    "RENDER_PT_stamp", "RENDER_PT_encoding", "RENDER_PT_encoding_video", "RENDER_PT_output_color_management",
    "RENDER_PT_output_views",
    "DATA_PT_lens", "DATA_PT_camera", "DATA_PT_camera_dof", "DATA_PT_camera_dof_aperture", "DATA_PT_camera_display",
    "DATA_PT_camera_safe_areas", "DATA_PT_context_camera", "DATA_PT_context_light", "DATA_PT_preview",
    "DATA_PT_EEVEE_light", "DATA_PT_spot", "DATA_PT_EEVEE_spot", "DATA_PT_light", "DATA_PT_area",
    "EEVEE_MATERIAL_PT_context_material", "EEVEE_MATERIAL_PT_surface", "EEVEE_MATERIAL_PT_settings",
    "EEVEE_WORLD_PT_surface", "WORLD_PT_context_world", "MATERIAL_PT_preview",
    "TEXTURE_PT_context", "PARTICLE_PT_render", "VIEWLAYER_PT_layer",
    "VIEWLAYER_PT_eevee_layer_passes_cryptomatte",
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


CLASSES = (WAVEPATH_PT_sampling, WAVEPATH_PT_motion_blur, WAVEPATH_PT_film, WAVEPATH_PT_bake, WAVEPATH_PT_passes)


def of_blender():
    return [kind for kind in bpy.types.Panel.__subclasses__()
            if kind.__name__ in OF_BLENDER and hasattr(kind, "COMPAT_ENGINES")]


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
