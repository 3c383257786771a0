"""Surfaces whose radiance has a closed form: mirrors, glass, rough metal, transparency, emission."""

import math

import oracles
from analytic import COLOR, COLOR_UNIT, NEEDS_LIGHT_SAMPLING, flags, look_down, product, receiver, reflected
from gltf import Gltf, box, quad

WIDE = 0.1


def backdrop(g, height=-1.0, size=50.0):
    """An emissive floor that faces up."""
    s = size
    sheet = quad((-s, height, -s), (-s, height, s), (s, height, s), (s, height, -s))
    g.mesh("backdrop", sheet, g.emitter("backdrop", COLOR))


def emitter():
    g = Gltf("emission seen directly")
    backdrop(g)
    look_down(g, WIDE, 1.0)
    g.expect("emissiveFactor * emissiveStrength", COLOR, flags(16, 0), exact=1e-6)
    return g


def unlit():
    g = Gltf("unlit surface")
    index = g.material("unlit", (0.75, 0.5, 0.25))
    g.extend(g.doc["materials"][index], KHR_materials_unlit={})
    g.mesh("sheet", quad((-1.0, 0.0, -1.0), (-1.0, 0.0, 1.0), (1.0, 0.0, 1.0), (1.0, 0.0, -1.0)), index)
    look_down(g, WIDE, 1.0)
    g.expect("the base colour, whatever the light", (0.75, 0.5, 0.25), flags(16), exact=1e-6)
    return g


def alpha(name, about, expected, render, exact=None, **mode):
    g = Gltf(name)
    backdrop(g)
    sheet = quad((-1.0, 0.0, -1.0), (-1.0, 0.0, 1.0), (1.0, 0.0, 1.0), (1.0, 0.0, -1.0))
    g.mesh("sheet", sheet, g.lambert("black", (0.0, 0.0, 0.0), alpha=0.25, **mode))
    look_down(g, WIDE, 1.0)
    terms = {"exact": exact} if exact else {}
    g.expect(about, expected, render, **terms)
    return g


def alpha_blend():
    return alpha("black sheet of opacity 1/4", "L = (1 - alpha) Le", product(COLOR, (0.75,) * 3),
                 flags(1024), alphaMode="BLEND")


def alpha_mask_kept():
    return alpha("masked sheet, kept", "alpha >= cutoff is opaque", (0.0, 0.0, 0.0), flags(16), exact=1e-6,
                 alphaMode="MASK", alphaCutoff=0.25)


def alpha_mask_cut():
    return alpha("masked sheet, cut", "alpha < cutoff is not there", COLOR, flags(16), exact=1e-6, alphaMode="MASK",
                 alphaCutoff=0.3)


def mirror():
    g = Gltf("gold mirror at 45 degrees")
    gold = (1.0, 0.76, 0.33)
    s = 1.0
    g.mesh("mirror", quad((-s, 0.0, -s), (-s, 0.0, s), (s, 0.0, s), (s, 0.0, -s)),
           g.material("mirror", gold, metallic=1.0, roughness=0.0))
    light = quad((-9.0, 0.5, -5.0), (9.0, 0.5, -5.0), (9.0, 9.0, -5.0), (-9.0, 9.0, -5.0))
    g.mesh("light", light, g.emitter("light", COLOR))
    g.camera((0.0, 1.0, 1.0), (0.0, 0.0, 0.0), extent=WIDE)
    f = tuple(oracles.schlick(c, math.sqrt(0.5)) for c in gold)
    g.expect("L = F Le with Schlick's F", product(f, COLOR), flags(16), exact=1e-5)
    return g


# Rays begin off the surface by its rounding, 6e-7 m on triangles of 10 m; 16.1/m of absorption makes 1e-5 of that.
ABSORBING_SLACK = 1e-5


def slab(name, about, expected, slack=None, **glass):
    g = Gltf(name)
    backdrop(g)
    g.mesh("slab", box((-5.0, 0.0, -5.0), (5.0, 0.2, 5.0)), g.glass("glass", **glass))
    look_down(g, WIDE, 1.0)
    g.expect(about, product(COLOR, expected), flags(1024, 64), **({"slack": slack} if slack else {}))
    return g


def glass_slab():
    return slab("glass slab, seen along its normal", "T = (1-F)/(1+F), F = 0.04", (oracles.slab(0.04),) * 3, ior=1.5)


def absorbing_slab():
    tint = (0.9, 0.5, 0.2)
    return slab("absorbing slab without reflection", "Beer and Lambert: T = tint^(0.2 m/0.1 m)", [t * t for t in tint],
                slack=ABSORBING_SLACK, ior=1.0, attenuation=tint, distance=0.1)


def absorbing_glass_slab():
    tint = (0.9, 0.5, 0.2)
    return slab("absorbing glass slab", "T = (1-F)^2 a/(1 - F^2 a^2), a = tint^(0.2 m/0.1 m)",
                [oracles.slab(0.04, t * t) for t in tint], slack=ABSORBING_SLACK, ior=1.5, attenuation=tint,
                distance=0.1)


SLANTED_SUN = (0.6, -0.8, 0.0)


def fog(tint, color=0.0, g=0.0):
    """A material of ior 1, and its extinction and scattering by channel, per metre."""
    extinction = [-math.log(t) for t in tint]
    return dict(ior=1.0, attenuation=tint, distance=1.0), extinction, [e * oracles.scattering_albedo(color, g)
                                                                       for e in extinction]


def floor_in_fog():
    g = receiver("floor in a box of fog that absorbs, under a slanted sun")
    glass, extinction, _ = fog((0.9, 0.6, 0.3))
    g.mesh("fog", box((-5.0, -0.5, -5.0), (5.0, 2.0, 5.0)), g.glass("fog", **glass))
    g.light("directional", 10.0, COLOR_UNIT, direction=SLANTED_SUN)
    way = 2.0 / 0.8 + 0.05
    g.expect("L = albedo E cos/pi exp(-extinction x (2 m/cos + 0.05 m)): shadow rays pass walls of ior 1",
             product(reflected(8.0, COLOR_UNIT), [math.exp(-e * way) for e in extinction]), flags(16, 2), exact=2e-5,
             estimators=NEEDS_LIGHT_SAMPLING)
    return g


def sunbeam_in_fog():
    g = Gltf("slanted sun, scattered once in a box of fog")
    color, forward = 0.6, 0.5
    glass, extinction, scattering = fog((0.9, 0.6, 0.3), color, forward)
    index = g.glass("fog", **glass)
    g.extend(g.doc["materials"][index], KHR_materials_volume_scatter={"multiscatterColor": [color] * 3,
                                                                      "scatterAnisotropy": forward})
    g.mesh("fog", box((-9.0, 0.0, -1.0), (9.0, 2.0, 1.0)), index)
    g.light("directional", 10.0, COLOR_UNIT, direction=SLANTED_SUN)
    g.camera((0.0, 1.0, 3.0), (0.0, 1.0, 0.0), extent=1e-6)
    phase = oracles.henyey_greenstein(forward, 0.0)
    once = [s * phase * math.exp(-e / 0.8) * (1 - math.exp(-2 * e)) / e for e, s in zip(extinction, scattering)]
    g.expect("L = E p(90 deg) exp(-extinction x 1 m/cos) integral of scattering exp(-extinction z) over 2 m: three "
             "bounces are two walls and one event", product([10.0] * 3, COLOR_UNIT, once), flags(1024, 3),
             estimators=NEEDS_LIGHT_SAMPLING)
    return g


def rough_metal(alpha, cosine):
    g = Gltf(f"GGX alpha {alpha}, F = 1, cosine {cosine}")
    g.mesh("sheet", quad((-1.0, 0.0, -1.0), (-1.0, 0.0, 1.0), (1.0, 0.0, 1.0), (1.0, 0.0, -1.0)),
           g.material("metal", metallic=1.0, roughness=math.sqrt(alpha)))
    sine = math.sqrt(1 - cosine * cosine)
    g.camera((0.0, cosine, sine), (0.0, 0.0, 0.0), up=(0.0, sine, -cosine), extent=WIDE)
    # A single bounce returns 1 - ln 2 at alpha 1 and cosine 1; the rest comes by table (kernels/surface/multiple.glsl).
    g.expect("metal that absorbs nothing returns all light, after however many bounces between its facets", [1.0] * 3,
             flags(1024, 1, "--env", "1,1,1"), slack=2e-3)
    return g


def scenes():
    """File stem, scene."""
    for build in (emitter, unlit, alpha_blend, alpha_mask_kept, alpha_mask_cut, mirror, glass_slab, absorbing_slab,
                  absorbing_glass_slab, floor_in_fog, sunbeam_in_fog):
        yield build.__name__, build()
    for alpha_value, cosine in ((0.25, 1.0), (0.25, 0.5), (0.5, 1.0), (0.5, 0.5), (1.0, 1.0), (1.0, 0.5)):
        yield f"ggx_alpha_{alpha_value:g}_cosine_{cosine:g}".replace(".", "_"), rough_metal(alpha_value, cosine)
