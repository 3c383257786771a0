"""Passes: what wavepath calls them, and what Blender calls them."""

from dataclasses import dataclass
from typing import Callable, Optional

import numpy


@dataclass
class Pass:
    name: str
    channels: str  # as Blender names them
    kind: str  # of Blender: COLOR, VECTOR or VALUE
    aov: Optional[str]
    values: Callable  # of channels and answer of the export: an array (height, width, channel)
    wanted: Callable  # of a scene and its view layer


def stacked(*names):
    return lambda channels, _: numpy.stack([channels[name] for name in names], axis=-1)


def z_up(*names):
    """glTF has +Y up, Blender +Z."""

    def values(channels, _):
        x, y, z = (channels[name] for name in names)
        return numpy.stack([x, -z, y], axis=-1)

    return values


def looked_up(channel, key):
    """Pass indices of what the ids stand for; 0 for nothing."""

    def values(channels, answer):
        table = numpy.array([*answer[key], 0], numpy.float32)
        ids = channels[channel].astype(numpy.int64)
        ids[(ids < 0) | (ids >= len(table))] = len(table) - 1
        return table[ids][..., None]

    return values


def uv(channels, _):
    u, v = channels["uv.X"], channels["uv.Y"]
    hit = (channels["Z0"] < 1e9).astype(numpy.float32)
    has = (u != 0) | (v != 0)  # a surface without texture coordinates has zeros
    return numpy.stack([u, numpy.where(has, 1 - v, 0), hit], axis=-1)


def emitted(channels, _):
    """wavepath counts the environment among what shines."""
    return numpy.stack([channels["emission." + c] - channels["environment." + c] for c in "RGB"], axis=-1)


def noisy(channels, _):
    alpha = channels.get("A", numpy.ones_like(channels["R"]))
    return numpy.stack([*(channels[c] for c in "RGB"), alpha], axis=-1)


def layer_flag(name):
    return lambda _, layer: getattr(layer, name, False)


PASSES = (
    Pass("Depth", "Z", "VALUE", "depth0", stacked("Z0"), layer_flag("use_pass_z")),
    Pass("Position", "XYZ", "VECTOR", "position0", z_up("P0.X", "P0.Y", "P0.Z"), layer_flag("use_pass_position")),
    Pass("Normal", "XYZ", "VECTOR", "normal", z_up("N.X", "N.Y", "N.Z"), layer_flag("use_pass_normal")),
    Pass("UV", "UVA", "VECTOR", "uv,depth0", uv, layer_flag("use_pass_uv")),
    Pass("IndexOB", "X", "VALUE", "node", looked_up("id.node", "object_indices"),
         layer_flag("use_pass_object_index")),
    Pass("IndexMA", "X", "VALUE", "material", looked_up("id.material", "material_indices"),
         layer_flag("use_pass_material_index")),
    Pass("Emit", "RGB", "COLOR", "emission,environment", emitted, layer_flag("use_pass_emit")),
    Pass("Env", "RGB", "COLOR", "environment", stacked("environment.R", "environment.G", "environment.B"),
         layer_flag("use_pass_environment")),
    Pass("Denoising Albedo", "RGB", "COLOR", "albedo", stacked("albedo.R", "albedo.G", "albedo.B"),
         lambda _, layer: layer.wavepath.use_pass_denoising),
    Pass("Denoising Normal", "XYZ", "VECTOR", "normal", z_up("N.X", "N.Y", "N.Z"),
         lambda _, layer: layer.wavepath.use_pass_denoising),
    Pass("Debug Sample Count", "X", "VALUE", "samples", stacked("samples"),
         lambda _, layer: layer.wavepath.use_pass_samples),
    Pass("Noisy Image", "RGBA", "COLOR", None, noisy, lambda scene, _: scene.wavepath.denoise),
    *(Pass("Crypto%s%02d" % (kind, level), "rgba", "COLOR", "cryptomatte",
           stacked(*("Crypto%s%02d.%s" % (kind, level, channel) for channel in "RGBA")),
           layer_flag("use_pass_cryptomatte_" + kind.lower()))
      for kind in ("Object", "Material") for level in range(3)),
)


def wanted(scene, layer):
    return [one for one in PASSES if one.wanted(scene, layer)]


def register(engine, scene, layer):
    engine.register_pass(scene, layer, "Combined", 4, "RGBA", "COLOR")
    for one in wanted(scene, layer):
        engine.register_pass(scene, layer, one.name, len(one.channels), one.channels, one.kind)


def aovs(scene, layer):
    names = []
    for one in wanted(scene, layer):
        names += [name for name in (one.aov or "").split(",") if name and name not in names]
    return names


def add(engine, scene, layer):
    for one in wanted(scene, layer):
        engine.add_pass(one.name, len(one.channels), one.channels, layer=layer.name)


def fill(result, scene, layer, channels, answer):
    """Passes that are found after the last sample are black until then."""
    alpha = channels.get("A")
    if alpha is None:
        alpha = numpy.ones_like(channels["R"])
    shown = "denoised." if "denoised.R" in channels else ""  # of the last picture alone
    values = {"Combined": numpy.stack([*(channels[shown + c] for c in "RGB"), alpha], axis=-1)}
    for one in wanted(scene, layer):
        try:
            values[one.name] = one.values(channels, answer)
        except KeyError:
            continue
    slots = result.layers[0].passes
    height, width = alpha.shape
    rows = []
    for slot in slots:
        pixels = values.get(slot.name)
        if pixels is None:
            pixels = numpy.zeros((height, width, slot.channels), numpy.float32)
        rows.append(numpy.ascontiguousarray(pixels[::-1], numpy.float32).ravel())  # Blender has the bottom row first
    slots.foreach_set("rect", numpy.concatenate(rows))
