"""Closed forms that analytic.py expects renders to reproduce."""

import math

from gltf import add, cross, dot, normalize, scale, sub


def polygon_irradiance(polygon, point, normal):
    """Irradiance at `point` from a polygon of radiance 1 above its horizon, front face towards it (Lambert 1760)."""
    to = [normalize(sub(v, point)) for v in polygon]
    total = 0.0
    for a, b in zip(to, to[1:] + to[:1]):
        total += math.acos(max(-1.0, min(1.0, dot(a, b)))) * dot(normal, normalize(cross(b, a)))
    return total / 2


def mesh_irradiance(triangles, point, normal):
    """The same from a convex body: the sum over the triangles that face the point."""
    facing = [t for t in triangles if dot(cross(sub(t[1], t[0]), sub(t[2], t[0])), sub(point, t[0])) > 0]
    return sum(polygon_irradiance(list(t), point, normal) for t in facing)


def corner_rectangle_form_factor(a, b, h):
    """From a point to a parallel rectangle a x b at distance h that has one corner right above it."""
    x, y = a / h, b / h
    u, v = math.sqrt(1 + x * x), math.sqrt(1 + y * y)
    return (x / u * math.atan(y / u) + y / v * math.atan(x / v)) / (2 * math.pi)


def facing_squares_form_factor():
    """Between unit squares that face each other at distance 1 (Howell's catalogue, C-11)."""
    s = math.sqrt(2.0)
    return 2 / math.pi * (math.log(2 / math.sqrt(3.0)) + 2 * s * math.atan(1 / s) - 2 * math.atan(1.0))


def adjacent_squares_form_factor():
    """Between perpendicular unit squares that share an edge: what is left of a closed cube."""
    return (1 - facing_squares_form_factor()) / 4


def schlick(f0, cosine):
    return f0 + (1 - f0) * (1 - cosine) ** 5


def fresnel(cosine, ior):
    """Of unpolarized light that enters a body of that ior."""
    inside = math.sqrt(1 - (1 - cosine * cosine) / (ior * ior))
    s = (cosine - ior * inside) / (cosine + ior * inside)
    p = (ior * cosine - inside) / (ior * cosine + inside)
    return (s * s + p * p) / 2


def slab(f, transmittance=1.0):
    """Transmittance of a slab with reflectance f at each face, all internal reflections summed."""
    return (1 - f) ** 2 * transmittance / (1 - (f * transmittance) ** 2)


def scattering_albedo(color, g):
    """Of a single event, where a deep body reflects `color` (KHR_materials_volume_scatter; Kulla and Conty Estevez
    2017)."""
    s = 4.09712 + 4.20863 * color - math.sqrt(9.59217 + 41.6808 * color + 17.7126 * color * color)
    return (1 - s * s) / (1 - g * s * s)


def henyey_greenstein(g, cosine):
    return (1 - g * g) / (4 * math.pi * (1 + g * g - 2 * g * cosine) ** 1.5)


def spot_falloff(cosine, inner, outer):
    """KHR_lights_punctual's recommended cone."""
    s = 1 / max(0.001, math.cos(inner) - math.cos(outer))
    return max(0.0, min(1.0, cosine * s - math.cos(outer) * s)) ** 2
