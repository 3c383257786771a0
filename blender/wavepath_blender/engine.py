"""The render engine: exports, runs wavepath, shows what it sends."""

import os
import shutil
import tempfile
import traceback

import bpy

from . import binary, command, copy_scene, passes, process, tev
from .export import lost
from .telling import begin, tell

POLL = 0.1  # seconds


class Failed(Exception):
    """With a sentence for the user."""


class Stopped(Exception):
    """By Esc."""


class WavepathEngine(bpy.types.RenderEngine):
    # Neither __init__ nor __del__: what they must take has changed with Blender 4.4.
    bl_idname = "WAVEPATH"
    bl_label = "wavepath"
    bl_use_preview = False
    bl_use_eevee_viewport = True
    bl_use_shading_nodes_custom = False

    def update_render_passes(self, scene=None, renderlayer=None):
        passes.register(self, scene, renderlayer)

    def render(self, depsgraph):
        folder = None
        begin()
        try:
            program = binary.find()
            folder = temporary_folder()
            answer = export(self, depsgraph, folder)
            run(self, depsgraph, folder, program, answer)
        except Stopped:
            pass
        except (binary.Missing, Failed) as problem:
            tell(self, "ERROR", str(problem))
        except Exception as problem:
            traceback.print_exc()
            tell(self, "ERROR", "the add-on failed: %s: %s" % (type(problem).__name__, problem))
        finally:
            if folder:
                shutil.rmtree(folder, ignore_errors=True)


def temporary_folder():
    try:
        return tempfile.mkdtemp(prefix="wavepath-", dir=bpy.app.tempdir)
    except OSError as problem:
        raise Failed("%s: cannot be written (%s); choose another temporary folder in Preferences > File Paths"
                     % (bpy.app.tempdir, problem.strerror)) from None


def export(engine, depsgraph, folder):
    """What the export tells of itself."""
    engine.update_stats("wavepath", "Export")
    scene = depsgraph.scene
    try:
        copy_scene.write_copy(folder, depsgraph, whole_size(scene))
    except (OSError, RuntimeError) as problem:
        raise Failed("%s: the copy of the scene cannot be written: %s" % (folder, problem)) from None
    child = process.Process(copy_scene.command(folder))
    wait(engine, child, child.kill)
    answer = copy_scene.read_answer(folder)
    if answer is None:
        raise Failed(error_of(child) or "the export ended without a scene: %s" % "; ".join(child.lines[-3:]))
    unsaved = copy_scene.unsaved_images()
    if unsaved:
        answer["lost"].append(lost.line("unsaved changes of an image: left out", unsaved))
    if scene.render.use_motion_blur and scene.wavepath.integrator not in ("auto", "path"):
        answer["lost"].append("motion blur: off, as it needs the integrator Path or Automatic")
    if depsgraph.view_layer.use_pass_uv and not answer["textures"]:
        answer["lost"].append("pass UV: empty in a scene without image textures")
    for line in answer["lost"]:
        tell(engine, "WARNING", "wavepath: not carried: " + line)
    return answer


def run(engine, depsgraph, folder, program, answer):
    scene, layer = depsgraph.scene, depsgraph.view_layer
    size, crop = whole_size(scene), border(scene)
    width, height = (crop[2], crop[3]) if crop else size
    receiver = tev.Receiver()
    passes.add(engine, scene, layer)
    result = engine.begin_result(0, 0, width, height, layer=layer.name)
    try:
        line = command.build(program, folder, depsgraph, size, crop, answer, receiver.address)
        try:
            child = process.Process(line)
        except OSError as problem:
            raise Failed("%s: cannot be run: %s" % (program, problem.strerror)) from None

        def show():
            channels = receiver.take()
            if channels is not None:
                passes.fill(result, scene, layer, channels, answer)
                engine.update_result(result)

        try:
            code = wait(engine, child, child.interrupt, show)
        except Stopped:
            receiver.wait(2)
            show()
            raise
        except BaseException:
            child.kill()
            raise
        receiver.wait(10)
        show()
        for text in child.lines:
            if text.startswith("wavepath: warning: "):
                tell(engine, "WARNING", text)
        if code not in (0, 3):
            raise Failed(error_of(child) or "wavepath ended with code %d: %s" % (code, "; ".join(child.lines[-3:])))
        if code == 3:
            tell(engine, "WARNING", "wavepath: the target error was not reached")
        if receiver.problem:
            raise Failed("the picture did not arrive: %s" % receiver.problem)
    finally:
        receiver.close()
        engine.end_result(result)


def error_of(child):
    return next((line for line in reversed(child.lines) if line.startswith("wavepath: error: ")), None)


def wait(engine, child, stop, meanwhile=None):
    """The exit code. On Esc the child is stopped, first kindly."""
    while True:
        code = child.wait(POLL)
        if meanwhile:
            meanwhile()
        if code is not None:
            return code
        if child.status:
            engine.update_progress(child.fraction)
            engine.update_stats("wavepath", child.status)
        if engine.test_break():
            stop()
            if child.wait(10) is None:
                child.kill()
                child.wait(10)
            raise Stopped


def whole_size(scene):
    render = scene.render
    factor = render.resolution_percentage / 100
    return [max(int(render.resolution_x * factor), 1), max(int(render.resolution_y * factor), 1)]


def border(scene):
    """The rectangle to render, from the left top corner: X, Y, width and height. None: all of it."""
    render = scene.render
    if not render.use_border:
        return None
    width, height = whole_size(scene)
    left, right = int(render.border_min_x * width), int(render.border_max_x * width)
    bottom, top = int(render.border_min_y * height), int(render.border_max_y * height)
    if right <= left or top <= bottom:
        return None
    return [left, height - top, right - left, top - bottom]


def register():
    bpy.utils.register_class(WavepathEngine)


def unregister():
    bpy.utils.unregister_class(WavepathEngine)
