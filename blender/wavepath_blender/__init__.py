"""wavepath as a render engine of Blender, by a program that runs beside it. See docs/blender.md."""

bl_info = {
    "name": "wavepath",
    "author": "The wavepath authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "Properties > Render > Render Engine",
    "description": "Renders with the path tracer wavepath, on any Vulkan device or the CPU",
    "category": "Render",
}

if "bpy" in locals():  # "Reload Scripts"
    import importlib

    for module in (tev, process, settings, telling, binary, copy_scene, passes, command, engine, panels):
        importlib.reload(module)
else:
    import bpy  # noqa: F401

    from . import binary, command, copy_scene, engine, panels, passes, process, settings, telling, tev


def register():
    settings.register()
    telling.register()
    engine.register()
    panels.register()


def unregister():
    panels.unregister()
    engine.unregister()
    telling.unregister()
    settings.unregister()
