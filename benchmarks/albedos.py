#!/usr/bin/env python3
"""What a ball of one material returns of even light all around, by quadrature: a third opinion for material_study.py.

Prints the mean over the ball's disc: GGX that reflects all, GGX by the Fresnel term of ior 1.5, with height-correlated
and with separable shadowing, one bounce between microfacets; and the sheen of Estevez and Kulla.
"""

import math

from material_study import RADIUS, ROWS, SIZE

LINES, PER_AXIS = 24, 48  # of the disc; of a direction's integral


def fresnel(cosine, ior=1.5):
    g = math.sqrt(cosine * cosine + ior * ior - 1)
    ratio = (cosine * (g + cosine) - 1) / (cosine * (g - cosine) + 1)
    return 0.5 * ((g - cosine) / (g + cosine)) ** 2 * (1 + ratio**2)


def smith_lambda(mu, alpha):
    return (math.sqrt(1 + alpha * alpha * (1 - mu * mu) / (mu * mu)) - 1) / 2


def visible_facet(o, alpha, u, v):
    """Heitz 2018; o lies in the plane y = 0."""
    x, z = alpha * o[0], o[2]
    length = math.hypot(x, z)
    x, z = x / length, z / length
    r, phi = math.sqrt(u), 2 * math.pi * v
    t1, t2 = r * math.cos(phi), r * math.sin(phi)
    s = 0.5 * (1 + z)
    t2 = (1 - s) * math.sqrt(1 - t1 * t1) + s * t2
    up = math.sqrt(max(0.0, 1 - t1 * t1 - t2 * t2))
    h = (alpha * (up * x - t2 * z), alpha * t1, max(0.0, up * z + t2 * x))
    length = math.sqrt(sum(c * c for c in h))
    return tuple(c / length for c in h)


def ggx(mu, alpha, reflectance, correlated):
    """Share of the light along a direction that one bounce reflects."""
    o, total = (math.sqrt(1 - mu * mu), 0.0, mu), 0.0
    for i in range(PER_AXIS):
        for j in range(PER_AXIS):
            h = visible_facet(o, alpha, (i + 0.5) / PER_AXIS, (j + 0.5) / PER_AXIS)
            cosine = sum(a * b for a, b in zip(o, h))
            up = 2 * cosine * h[2] - mu
            if up > 0:
                there, back = smith_lambda(mu, alpha), smith_lambda(up, alpha)
                passed = (1 + there) / (1 + there + back) if correlated else 1 / (1 + back)
                total += passed * reflectance(cosine)
    return total / PER_AXIS**2


def sheen_lambda(cosine, alpha):
    t = (1 - alpha) ** 2
    a, b, c, d, e = (p + (q - p) * t for p, q in ((21.5473, 25.3245), (3.82987, 3.32435), (0.19823, 0.16801),
                                                  (-1.97760, -1.27393), (-4.32054, -4.85967)))

    def curve(x):
        return a / (1 + b * x**c) + d * x + e
    return math.exp(curve(cosine) if cosine < 0.5 else 2 * curve(0.5) - curve(1 - cosine))


def sheen(mu, alpha):
    o, total = (math.sqrt(1 - mu * mu), 0.0, mu), 0.0
    for i in range(PER_AXIS):
        z = (i + 0.5) / PER_AXIS
        for j in range(PER_AXIS):
            phi = 2 * math.pi * (j + 0.5) / PER_AXIS
            h = (o[0] + math.sqrt(1 - z * z) * math.cos(phi), math.sqrt(1 - z * z) * math.sin(phi), mu + z)
            sine2 = max(1 - h[2] ** 2 / sum(c * c for c in h), 0.0)
            distribution = (2 + 1 / alpha) * sine2 ** (0.5 / alpha)
            total += distribution * min(1 / (4 * mu * (1 + sheen_lambda(mu, alpha) + sheen_lambda(z, alpha))), z)
    return total / PER_AXIS**2


def mean_over_ball(albedo):
    """Over what material_study.py counts of a ball."""
    radius = RADIUS * SIZE[1] / ROWS
    reach = ((radius - 1) / radius) ** 2
    return sum(albedo(math.sqrt(1 - (k + 0.5) / LINES * reach)) for k in range(LINES)) / LINES


def main():
    print("| roughness | metal, correlated | separable | ior 1.5, correlated | separable |\n| --- | --- | --- | --- | "
          "--- |")
    for roughness in (0.3, 0.6, 1.0):
        means = [mean_over_ball(lambda mu: ggx(mu, roughness**2, reflectance, correlated))
                 for reflectance in (lambda _: 1.0, fresnel) for correlated in (True, False)]
        print(f"| {roughness} | " + " | ".join(f"{m:.4f}" for m in means) + " |")
    print("\n| roughness | sheen |\n| --- | --- |")
    for roughness in (0.2, 0.4, 0.6, 1.0):
        print(f"| {roughness} | {mean_over_ball(lambda mu: sheen(mu, roughness**2)):.4f} |")


if __name__ == "__main__":
    main()
