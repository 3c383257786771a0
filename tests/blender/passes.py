"""Passes have the names, sizes and values that Cycles' have."""

import math

import bpy
import numpy

import stage

BY_CYCLES = {"z": "Depth", "position": "Position", "normal": "Normal", "uv": "UV", "object_index": "IndexOB",
             "material_index": "IndexMA", "emit": "Emit", "environment": "Env",
             "cryptomatte_object": "CryptoObject", "cryptomatte_material": "CryptoMaterial"}


def build():
    scene = stage.empty((96, 64), 64)
    scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    floor = stage.plane(2, stage.white(0.6), "floor")
    floor.pass_index = 3
    layer = floor.data.uv_layers.new(name="UVMap")
    for loop, corner in zip(layer.data, ((0, 0), (1, 0), (1, 1), (0, 1))):
        loop.uv = corner
    tree = floor.active_material.node_tree
    image = bpy.data.images.new("checker", 4, 4)
    image.pixels = [value for k in range(16) for value in ((0.6, 0.6, 0.6, 1) if k % 2 else (0.3, 0.3, 0.3, 1))]
    image.pack()
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image, texture.interpolation = image, "Closest"
    tree.links.new(texture.outputs["Color"], next(n for n in tree.nodes if n.type == "BSDF_DIFFUSE").inputs["Color"])
    ball = stage.ball(0.5, stage.material("red", Color=(0.7, 0.1, 0.1, 1)), (-0.6, 0.2, 0.5))
    ball.pass_index = 5
    ball.active_material.pass_index = 9
    stage.plane(0.3, stage.material("glow", "ShaderNodeEmission", Color=(1, 0.5, 0.2, 1), Strength=4), "glow",
                (0.8, 0, 0.5)).pass_index = 7
    stage.camera((0, -4, 2.2), (0, 0, 0.35), math.radians(36))
    stage.lamp("POINT", 200, (1.5, -2, 3.5))
    stage.world((0.2, 0.3, 0.5), 0.5)
    for name in BY_CYCLES:
        setattr(scene.view_layers[0], "use_pass_" + name, True)
    scene.view_layers[0].wavepath.use_pass_denoising = True
    scene.view_layers[0].wavepath.use_pass_samples = True
    return scene


scene = build()
ours = stage.render("passes_wavepath")
stage.cycles(scene, 64)
scene.view_layers[0].cycles.denoising_store_passes = True
scene.view_layers[0].cycles.pass_debug_sample_count = True
theirs = stage.render("passes_cycles")

not_ours = ("Composite", "ViewLayer.Denoising Depth", "ViewLayer.Noisy Image")
missing = [name for name in theirs if name not in ours and not name.startswith(not_ours)]
strange = [name for name in ours if name not in theirs]
print("only Cycles has", missing, "only wavepath has", strange)
if missing or strange:
    raise SystemExit("channels")
wrong = []
for name in sorted(ours):
    # Denoising: Cycles has normals of the camera's axes, and an albedo of what shines. Samples: it has their share.
    if any(word in name for word in ("Composite", "Combined", "Crypto", "Denoising", "Sample")):
        continue
    a, b = ours[name].astype(float), theirs[name].astype(float)
    alike = abs(a - b) <= 0.02 * numpy.maximum(abs(b), 0.5)
    if ".UV." in name:  # wavepath keeps coordinates where a texture needs them: on the floor
        alike = alike[theirs["ViewLayer.IndexOB.X"] == 3]
    agree = float(numpy.mean(alike))
    print("%-40s agrees in %.3f of the pixels; means %.5g and %.5g" % (name, agree, a.mean(), b.mean()), flush=True)
    if agree < 0.9:
        wrong.append(name)
for kind in ("Object", "Material"):
    rank = "ViewLayer.Crypto%s00." % kind
    same = float(numpy.mean(ours[rank + "r"].view("<u4") == theirs[rank + "r"].view("<u4")))
    print("Cryptomatte of %s: the same id in %.3f of the pixels" % (kind, same))
    if same < 0.9:
        wrong.append(rank)
if wrong:
    raise SystemExit("passes: " + ", ".join(wrong))
print("PASSES DONE")
