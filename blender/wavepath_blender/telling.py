"""Tells the user, in the status bar and the Info editor.

Blender with a window moves the reports of a render there once, soon after it has begun, and drops all later ones. So
those wait here for an operator of our own, which runs in the main thread.
"""

import time

import bpy

EARLY = 0.5  # seconds, in which Blender has certainly not moved them yet or has just done so
waiting = []
begun = 0.0


def begin():
    global begun
    begun = time.monotonic()


def tell(engine, kind, sentence):
    """``kind``: WARNING or ERROR. An error also ends an animation, and keeps Blender from writing a picture that there
    is none of."""
    if kind == "ERROR":
        engine.error_set(sentence)  # in the window of the picture
    if bpy.app.background or kind == "ERROR":
        engine.report({kind}, sentence)
    if not bpy.app.background and not (kind == "ERROR" and time.monotonic() - begun < EARLY):
        waiting.append((kind, sentence))
        if not bpy.app.timers.is_registered(start):
            bpy.app.timers.register(start)


def start():
    """In the main thread. Begins the operator in the first window."""
    windows = bpy.context.window_manager.windows
    if not windows:
        return 1.0
    with bpy.context.temp_override(window=windows[0]):
        bpy.ops.wavepath.tell("INVOKE_DEFAULT")
    return None


class WAVEPATH_OT_tell(bpy.types.Operator):
    """Shows what a render has to tell"""

    bl_idname = "wavepath.tell"
    bl_label = "wavepath"
    bl_options = {"INTERNAL"}

    def invoke(self, context, _event):
        # Reports of operators that scripts call are theirs. Those of one that ends by an event are the user's.
        self.timer = context.window_manager.event_timer_add(0.05, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        context.window_manager.event_timer_remove(self.timer)
        while waiting:
            kind, sentence = waiting.pop(0)
            self.report({kind}, sentence)
        return {"FINISHED"}


def register():
    bpy.utils.register_class(WAVEPATH_OT_tell)


def unregister():
    if bpy.app.timers.is_registered(start):
        bpy.app.timers.unregister(start)
    bpy.utils.unregister_class(WAVEPATH_OT_tell)
