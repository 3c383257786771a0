"""What a user meets: Esc, a missing program, a folder that cannot be written, view layers, borders, frames, what is
lost. Each case renders an unsaved file."""

import json
import math
import os
import shutil
import signal
import sys
import threading
import time

import bpy
import numpy

import stage

SIZE = (64, 48)


def build(samples=16):
    scene = stage.empty(SIZE, samples)
    scene.wavepath.integrator = "path"
    stage.plane(3, stage.white(0.6), "floor")
    stage.ball(0.5, stage.material("red", Color=(0.7, 0.1, 0.1, 1)), (0, 0, 0.5))
    stage.camera((0, -4, 2), (0, 0, 0.4), math.radians(36))
    stage.lamp("POINT", 200, (1.5, -2, 3.5))
    return scene


def check(what, true):
    print("%-60s %s" % (what, "ok" if true else "WRONG"), flush=True)
    if not true:
        raise SystemExit(what)


def error_of(action):
    try:
        action()
    except RuntimeError as problem:
        return str(problem)
    return ""


def missing_program():
    build()
    kept = os.environ["WAVEPATH"]
    os.environ["WAVEPATH"] = "/no/such/wavepath"
    said = error_of(lambda: stage.render("missing"))
    os.environ["WAVEPATH"] = kept
    check("a missing program is told with a remedy", "/no/such/wavepath" in said and "Preferences" in said)


def program_that_fails():
    scene = build()
    scene.wavepath.flags = "--no-such-flag"
    said = error_of(lambda: stage.render("failing"))
    check("a refused flag is told in wavepath's words", "wavepath: error: " in said and "no-such-flag" in said)


def folder_read_only():
    """A folder that cannot be written even by root: its place is taken by a file."""
    build()
    engine = sys.modules["wavepath_blender.engine"]
    kept = engine.bpy

    class Bpy:
        class app:
            tempdir = os.path.join(stage.FOLDER, "taken", "folder")

    with open(os.path.join(stage.FOLDER, "taken"), "w"):
        pass
    engine.bpy = Bpy
    said = error_of(lambda: stage.render("read_only"))
    engine.bpy = kept
    check("a temporary folder that cannot be written is told", "cannot be written" in said and "Preferences" in said)


def mistake_of_ours():
    """As if Blender's interface had changed: an error as any other, no crash."""
    build()
    tev = sys.modules["wavepath_blender.tev"]
    kept, tev.Receiver = tev.Receiver, None
    said = error_of(lambda: stage.render("mistake"))
    tev.Receiver = kept
    check("a mistake of the add-on is an error", "TypeError" in said)


def nothing_left():
    build()
    before = set(os.listdir(bpy.app.tempdir))
    stage.render("tidy")
    check("nothing is left in the temporary folder", set(os.listdir(bpy.app.tempdir)) == before)


def esc():
    scene = build(1 << 20)
    scene.wavepath.max_depth = 64
    process = sys.modules["wavepath_blender.process"]
    started = []

    class Watched(process.Process):
        def __init__(self, command, environment=None):
            super().__init__(command, environment)
            if "render" in command:
                started.append(self)

    kept, process.Process = process.Process, Watched

    def press():
        while not started or started[0].fraction <= 0:
            time.sleep(0.05)
        time.sleep(2.5)
        os.kill(os.getpid(), signal.SIGINT)  # Esc, for a Blender without a window

    pressing = threading.Thread(target=press, daemon=True)
    pressing.start()
    begun = time.time()
    bpy.ops.render.render()
    process.Process = kept
    check("Esc ends the render", time.time() - begun < 120 and started[0].wait(0) == 130)
    path = os.path.join(stage.FOLDER, "esc.exr")
    bpy.data.images["Render Result"].save_render(path)
    check("the picture so far stays", stage.mean(stage.read_exr(path)) > 0.01)


def view_layers():
    scene = build()
    hidden = bpy.data.collections.new("hidden")
    scene.collection.children.link(hidden)
    ball = bpy.data.objects["ball"]
    for users in ball.users_collection:
        users.objects.unlink(ball)
    hidden.objects.link(ball)
    second = scene.view_layers.new("without ball")
    second.layer_collection.children["hidden"].exclude = True
    second.use_pass_object_index = True
    ball.pass_index = 4
    bpy.data.objects["floor"].pass_index = 2
    scene.view_layers[0].use_pass_object_index = True
    scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    picture = stage.render("layers")
    first = scene.view_layers[0].name
    check("the first view layer has the ball", (picture[first + ".IndexOB.X"] == 4).any())
    check("the second view layer does not", not (picture["without ball.IndexOB.X"] == 4).any())
    check("and shows what was behind it", (picture["without ball.IndexOB.X"] == 2).sum() >
          (picture[first + ".IndexOB.X"] == 2).sum())
    check("both have a picture", min(picture[n + ".Combined.R"].mean() for n in (first, "without ball")) > 0.01)


def hidden_objects():
    scene = build()
    scene.view_layers[0].use_pass_object_index = True
    bpy.data.objects["ball"].pass_index = 4
    bpy.data.objects["ball"].hide_render = True
    scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    picture = stage.render("hidden")
    check("what is hidden in renders is", not (picture["ViewLayer.IndexOB.X"] == 4).any())
    bpy.data.objects["ball"].hide_render = False
    bpy.data.objects["ball"].hide_viewport = True
    picture = stage.render("hidden")
    check("what is hidden in the viewport alone is not", (picture["ViewLayer.IndexOB.X"] == 4).any())


def instances():
    scene = build()
    group = bpy.data.collections.new("group")
    ball = bpy.data.objects["ball"]
    for users in ball.users_collection:
        users.objects.unlink(ball)
    group.objects.link(ball)
    ball.pass_index = 4
    for x in (-1.2, 1.2):
        empty = stage.link("instance", None, stage.mathutils.Matrix.Translation((x, 0, 0)))
        empty.instance_type, empty.instance_collection = "COLLECTION", group
    array = bpy.data.objects["floor"].modifiers.new("array", "ARRAY")
    array.count = 2
    scene.view_layers[0].use_pass_object_index = True
    scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    engine = sys.modules["wavepath_blender.engine"]
    kept, meshes = engine.run, []

    def watched(*arguments):
        with open(os.path.join(arguments[2], "scene.glb"), "rb") as file:
            head = file.read(20)
            meshes.extend(json.loads(file.read(int.from_bytes(head[12:16], "little")))["meshes"])
        kept(*arguments)

    engine.run = watched
    ids = stage.render("instances")["ViewLayer.IndexOB.X"]
    engine.run = kept
    check("they share their mesh", len(meshes) == 2)
    left, middle, right = (ids[:, k * 22 : k * 22 + 20] == 4 for k in range(3))
    check("instances of a collection stand in their places", left.any() and right.any() and not middle.any())


def border():
    scene = build()
    whole = stage.render("whole")
    render = scene.render
    render.use_border = True
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.25, 0.75, 0.5, 1.0
    part = stage.render("border")
    check("a border leaves the size", part["R"].shape == whole["R"].shape)
    inside = slice(0, 24), slice(16, 48)
    check("the border has the bits of the whole", same_bits(part["R"][inside], whole["R"][inside]))
    check("outside it is black", part["R"][30:].max() == 0)
    render.use_crop_to_border = True
    cropped = stage.render("cropped")
    check("a cropped border has its own size", cropped["R"].shape == (24, 32))
    check("and the same bits", same_bits(cropped["R"], whole["R"][inside]))


def same_bits(a, b):
    """Blender's threads sum normals of a smooth mesh in any order, so that last bits of some differ."""
    return float(numpy.mean(a == b)) > 0.97


def exact():
    """At the end Blender has the bits of the file that wavepath writes."""
    scene = build()
    scene.render.image_settings.color_mode = "RGBA"
    engine = sys.modules["wavepath_blender.engine"]
    kept = engine.run
    path = os.path.join(stage.FOLDER, "of_wavepath.exr")

    def watched(*arguments):
        kept(*arguments)
        shutil.copy(os.path.join(arguments[2], "picture.exr"), path)

    engine.run = watched
    shown = stage.render("exact")
    engine.run = kept
    written = stage.read_exr(path)
    check("the picture is exact at the end", all((shown[name] == written[name]).all() for name in "RGBA"))


def frames():
    scene = build()
    ball = bpy.data.objects["ball"]
    for frame, x in ((1, -1.0), (3, 1.0)):
        ball.location.x = x
        ball.keyframe_insert("location", frame=frame)
    scene.frame_start, scene.frame_end = 1, 3
    scene.render.filepath = os.path.join(stage.FOLDER, "frame_")
    bpy.ops.render.render(animation=True)
    middles = []
    for frame in (1, 2, 3):
        picture = stage.read_exr(os.path.join(stage.FOLDER, "frame_%04d.exr" % frame))
        red = picture["R"] > 3 * picture["G"]
        middles.append(float(numpy.mean(numpy.nonzero(red)[1])))
    print("columns of the ball:", middles)
    check("each frame of an animation has its own pose", middles[0] + 5 < middles[1] < middles[2] - 5)


def motion_blur():
    scene = build(64)
    ball = bpy.data.objects["ball"]
    for frame, x in ((0, -0.8), (2, 0.8)):
        ball.location.x = x
        ball.keyframe_insert("location", frame=frame)
    for curve in ball.animation_data.action.fcurves:
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
    scene.frame_set(1)
    still = stage.render("still")
    scene.render.use_motion_blur = True
    scene.render.motion_blur_shutter = 1.0
    moved = stage.render("moved")
    stage.cycles(scene, 128)
    theirs = stage.render("moved_cycles")
    far = [float(numpy.sqrt(numpy.mean((moved["R"] - other["R"]) ** 2))) for other in (still, theirs)]
    print("from the still picture %.4f, from Cycles' blurred one %.4f" % tuple(far))
    check("a moving ball is blurred", far[0] > 0.01)
    check("as Cycles blurs it", far[1] < 0.3 * far[0])
    stage.near("and as bright", stage.mean(moved), stage.mean(theirs), 0.03)


def mattes():
    """The compositor finds an object by its name."""
    scene = build()
    scene.view_layers[0].use_pass_cryptomatte_object = True
    scene.use_nodes = True
    tree = scene.node_tree
    tree.nodes.clear()
    layers, out = tree.nodes.new("CompositorNodeRLayers"), tree.nodes.new("CompositorNodeComposite")
    matte = tree.nodes.new("CompositorNodeCryptomatteV2")
    matte.matte_id = "ball"
    tree.links.new(layers.outputs["Image"], matte.inputs[0])
    tree.links.new(matte.outputs["Matte"], out.inputs[0])
    picture = stage.render("mattes")["R"]
    check("Cryptomatte takes the ball out", picture[20:28, 28:36].min() == 1 and picture[40].max() == 0)


def saved_file():
    """A texture beside the file, by a path from there; a collection linked from another file."""
    scene = build()
    folder = os.path.join(stage.FOLDER, "saved")
    os.makedirs(folder, exist_ok=True)
    image = bpy.data.images.new("green", 4, 4)
    image.pixels = [0.0, 1.0, 0.0, 1.0] * 16
    image.filepath_raw, image.file_format = os.path.join(folder, "green.png"), "PNG"
    image.save()
    library = bpy.data.collections.new("library")
    blue = stage.ball(0.4, stage.material("blue", Color=(0.0, 0.0, 1.0, 1)), (1, 0, 0.4), "blue")
    for users in blue.users_collection:
        users.objects.unlink(blue)
    library.objects.link(blue)
    bpy.data.libraries.write(os.path.join(folder, "library.blend"), {library})
    bpy.data.collections.remove(library)
    bpy.data.objects.remove(blue)
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(folder, "scene.blend"))
    image.filepath = "//green.png"
    tree = bpy.data.objects["ball"].active_material.node_tree
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    tree.links.new(texture.outputs["Color"], next(n for n in tree.nodes if n.type == "BSDF_DIFFUSE").inputs["Color"])
    with bpy.data.libraries.load("//library.blend", link=True, relative=True) as (_, wanted):
        wanted.collections = ["library"]
    instance = stage.link("instance", None, stage.mathutils.Matrix())
    instance.instance_type, instance.instance_collection = "COLLECTION", wanted.collections[0]
    bpy.ops.wm.save_mainfile()
    picture = stage.render("saved")
    green = (picture["G"] > 0.1) & (picture["R"] < 0.02)
    blue = (picture["B"] > 0.1) & (picture["G"] < 0.02)
    check("a texture by a relative path is found", green.sum() > 50)
    check("what is linked from another file is rendered", blue.sum() > 30)


def integrators():
    for name in ("auto", "path", "bidirectional", "hybrid", "whitted", "ao"):
        scene = build(4)
        stage.world((0.2, 0.2, 0.2))
        bpy.data.lights["lamp"].shadow_soft_size = 0.1
        scene.wavepath.integrator = name
        check("integrator " + name, stage.mean(stage.render("integrator")) > 0.05)


def denoised():
    scene = build(4)
    noisy = stage.render("noisy")
    scene.wavepath.denoise = True
    scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    both = stage.render("denoised")
    check("the denoised picture comes with the noisy one", same_bits(both["ViewLayer.Noisy Image.R"], noisy["R"]))
    check("and is another", (both["ViewLayer.Combined.R"] != noisy["R"]).any())


def transparent():
    scene = build()
    stage.world((0.5, 0.6, 0.7))
    scene.render.film_transparent = True
    scene.render.image_settings.color_mode = "RGBA"
    picture = stage.render("transparent")
    check("a transparent background has no alpha", picture["A"][0].max() == 0 and picture["A"][40].min() == 1)
    check("and no colour", picture["R"][0].max() == 0)


def lost():
    scene = build()
    for name in ("marble", "wood"):
        made = stage.white()
        made.name = name
        tree = made.node_tree
        noise = tree.nodes.new("ShaderNodeTexNoise")
        tree.links.new(noise.outputs["Color"], next(n for n in tree.nodes if n.type == "BSDF_DIFFUSE").inputs["Color"])
        stage.ball(0.2, made, (1, 0, 0.2), name)
    stage.lamp("AREA", 10, spread=1.0, name="softbox")
    reports = []
    engine = sys.modules["wavepath_blender.engine"]
    kept = engine.export

    def watched(*arguments):
        answer = kept(*arguments)
        reports.extend(answer["lost"])
        return answer

    engine.export = watched
    stage.render("lost")
    engine.export = kept
    print("\n".join(reports))
    check("lost nodes are told with count and names", any(line.startswith("material nodes") and "2: " in line and
          "marble, wood" in line and "Noise" in line for line in reports))
    check("and lost spread", any("spread" in line and "softbox" in line for line in reports))


CASES = [missing_program, program_that_fails, mistake_of_ours, folder_read_only, nothing_left, view_layers,
         hidden_objects, instances, border, exact, frames, motion_blur, mattes, saved_file, integrators, denoised,
         transparent, lost, esc]
wanted = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
for case in CASES:
    if not wanted or case.__name__ in wanted:
        case()
print("BEHAVIOUR DONE")
