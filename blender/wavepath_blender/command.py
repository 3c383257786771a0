"""The command line of a render."""

import os
import shlex

from . import passes, settings


def build(program, folder, depsgraph, size, crop, answer, address):
    scene, layer = depsgraph.scene, depsgraph.view_layer
    options = scene.wavepath
    flags = [program, "render", os.path.join(folder, "scene.glb"), "-o", os.path.join(folder, "picture.exr")]
    flags += ["--tev", address, "--size", "%dx%d" % tuple(size), "--integrator", options.integrator]
    flags += ["--spp", str(options.samples), "--max-depth", str(options.max_depth), "--seed", str(seed(scene))]
    if crop:
        flags += ["--crop", "%d,%d,%d,%d" % tuple(crop)]
    if options.time > 0:
        flags += ["--time", repr(options.time)]
    if options.target_error > 0:
        flags += ["--target-error", repr(options.target_error)]
    if options.clamp > 0:
        flags += ["--clamp", repr(options.clamp)]
    if options.denoise:
        flags += ["--denoise"]
    aovs = passes.aovs(scene, layer)
    if aovs:
        flags += ["--aov", ",".join(aovs)]
    preferences = settings.preferences()
    if preferences and preferences.device:
        flags += ["--device", preferences.device]
    return flags + answer["flags"] + shlex.split(options.flags)


def seed(scene):
    options = scene.wavepath
    if not options.animate_seed:
        return options.seed
    return (options.seed + 7919 * scene.frame_current) % (1 << 31)
