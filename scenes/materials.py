"""Stages for the gallery: one ball for each layer that a material may have, and cut gems."""

import math

from gltf import Gltf, Shape, sphere
from showcase import backdrop, brilliant


def mapped(ball):
    """A sphere with longitude and latitude, whose seam is behind; the poles are where the texture ends."""
    uvs = [((math.atan2(x, z) / (2 * math.pi)) + 0.5, math.acos(max(-1.0, min(1.0, y))) / math.pi)
           for x, y, z in ball.positions]
    return Shape(ball.positions, ball.indices, ball.normals, uvs)


def materials():
    g = Gltf("materials")
    g.mesh("backdrop", backdrop(), g.lambert("backdrop", (0.2, 0.2, 0.215)))
    ball = g.shape(mapped(sphere(48)))

    def layered(name, color, layers, **terms):
        index = g.material(name, color, **terms)
        g.extend(g.doc["materials"][index], **{f"KHR_materials_{layer}": values for layer, values in layers.items()})
        return index

    row = [
        layered("car paint", (0.45, 0.01, 0.02), {"clearcoat": {"clearcoatFactor": 1.0,
                                                                "clearcoatRoughnessFactor": 0.03}},
                metallic=0.7, roughness=0.45),
        layered("velvet", (0.05, 0.01, 0.12),
                {"sheen": {"sheenColorFactor": [0.5, 0.25, 0.8], "sheenRoughnessFactor": 0.45}}, roughness=0.95),
        layered("soap", (1.0, 1.0, 1.0),
                {"transmission": {"transmissionFactor": 1.0}, "ior": {"ior": 1.0},
                 "specular": {"specularFactor": 1.0},
                 "iridescence": {"iridescenceFactor": 1.0, "iridescenceIor": 1.33,
                                 "iridescenceThicknessMaximum": 480.0}},
                roughness=0.0),
        layered("brushed steel", (0.7, 0.71, 0.73), {"anisotropy": {"anisotropyStrength": 0.85}}, metallic=1.0,
                roughness=0.28),
        layered("tempered titanium", (0.62, 0.58, 0.55),
                {"iridescence": {"iridescenceFactor": 1.0, "iridescenceIor": 2.2,
                                 "iridescenceThicknessMaximum": 210.0}},
                metallic=1.0, roughness=0.18),
        layered("paper", (0.75, 0.7, 0.6), {"diffuse_transmission": {"diffuseTransmissionFactor": 0.6,
                                                                    "diffuseTransmissionColorFactor": [1.0, 0.75, 0.4]},
                                            "specular": {"specularFactor": 0.0}}, doubleSided=True),
        layered("rough gold", (1.0, 0.77, 0.34), {}, metallic=1.0, roughness=0.75),
        layered("crystal", (1.0, 1.0, 1.0),
                {"transmission": {"transmissionFactor": 1.0}, "ior": {"ior": 1.62}, "dispersion": {"dispersion": 0.8},
                 "volume": {"thicknessFactor": 1.0}}, roughness=0.0),
    ]
    for i, material in enumerate(row):
        x, z = (i % 4 - 1.75) * 1.3 + (0.65 if i >= 4 else 0.0), 0.0 if i < 4 else 1.5
        g.mesh(g.doc["materials"][material]["name"], ball, material, translation=[x, 0.55, z], scale=[0.55] * 3)
    g.camera((0.0, 3.9, 8.0), (0.0, 0.42, 0.6), yfov=0.44, aspect=16 / 9)
    return g


def gems():
    g = Gltf("gems")
    floor = g.material("slate", (0.02, 0.022, 0.026), roughness=0.12)
    g.mesh("floor", backdrop(), floor)
    shape = g.shape(brilliant(16))

    def gem(name, x, z, size, turn, ior, dispersion, attenuation=None):
        index = g.glass(name, ior=ior, attenuation=attenuation, distance=0.5)
        g.extend(g.doc["materials"][index], KHR_materials_dispersion={"dispersion": dispersion})
        # It lies on a facet of its pavilion: turned about z by the angle of that.
        lean = math.pi / 2 - math.atan2(0.86, 1.0) + 0.04
        a, b = math.sin(lean / 2), math.cos(lean / 2)
        c, d = math.sin(turn / 2), math.cos(turn / 2)
        rest = 0.86 * math.cos(math.atan2(0.86, 1.0)) * size
        g.mesh(name, shape, index, translation=[x, rest, z], scale=[size] * 3,
               rotation=[c * a, c * b, d * a, d * b])

    gem("diamond", 0.0, 0.5, 0.62, 0.4, 2.417, 0.362)
    gem("sapphire", -1.45, 0.1, 0.5, 2.0, 1.77, 0.278, (0.08, 0.18, 0.9))
    gem("ruby", 1.4, 0.0, 0.52, 3.6, 1.77, 0.278, (0.9, 0.05, 0.1))
    gem("emerald", 0.75, 1.6, 0.34, 5.1, 1.58, 0.3, (0.1, 0.8, 0.3))
    gem("zircon", -0.8, 1.5, 0.3, 1.1, 1.95, 0.78)
    g.camera((0.3, 1.9, 6.0), (0.0, 0.3, 0.4), yfov=0.42, aspect=16 / 9)
    return g
