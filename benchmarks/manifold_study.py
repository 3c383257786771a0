#!/usr/bin/env python3
"""Caustics of a lamp behind smooth glass: manifold sampling against merging with photons, at equal numbers of rays.

    OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 nice -n 19 python3 benchmarks/manifold_study.py --json study.json

A picture of a diffuse floor, whose light is that of a point lamp through a chain of smooth dielectrics of ior 1.5.
Pixels are means of irradiance over their squares, and every sample falls elsewhere in its pixel. Normals, curvatures
and intersections are exact and in double precision, which is the best case of manifold sampling. Needs numpy.

manifold  Specular manifold sampling (Zeltner, Georgiev, Jakob 2020), unbiased: one walk a sample, by Newton steps that
          are halved where the chain breaks or ends no nearer. Once it has found a root, walks until that is found again
          count for its reciprocal probability, --most-trials at most: what is lacking then is the bias. The lamp's
          directions are the two unknowns. Walks begin all over the cone around what can light the picture, as light
          paths do.
near      The same where walks begin within the reach of glass, which only the reference tells: directions that without
          glass would light a disk around the place, as large as any light of the picture is displaced.
several   Biased: all different roots that --walks of these walks have found.
aimed     Merging as docs/bidirectional.md has it: a pass has one light path and one place to gather at for each pixel;
          the radius is 2 pixels times passes to the power of -1/6. At each surface chance picks refraction or
          reflection, and what is reflected is not followed. Light paths begin in the cone.
emitted   The same with light paths in all directions, as the renderer has them.

Rays: each surface that a chain meets or misses is one, also in steps that are taken back; derivatives are free; a root
costs one more, for what is between the last surface and the floor. A light path costs one for each surface and one to
the floor; the look-up is free. A sample of a pixel costs --camera-rays more, with either method.

relMSE is the mean over pixels of (x - r)^2 / (r^2 + 0.01 mean(r)^2), and over seeds. The reference r is the light of a
dense lattice of directions, without derivatives; its floor is what its two halves tell of its own error.
"""

import argparse
import json
import math

import numpy as np

IOR = 1.5
STEPS, ARRIVED, SAME = 20, 1e-8, 1e-4  # most of a walk; metres on the floor; between directions of one root
FIRST_RADIUS, SHRINK = 2.0, -1 / 6  # pixels; power of passes
LANES = 1 << 13  # at once
WAVES = ((0.030, 0.80, 0.4, 0.3), (0.018, 0.55, 1.7, 1.1), (0.010, 0.37, 2.6, 4.0), (0.006, 0.30, 0.9, 2.2))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def unit(a):
    return a / np.sqrt(dot(a, a))


def column(values):
    return np.array(values, float)[:, None]


def across(d):
    """Two directions at right angles to each d, none of which is along x."""
    side = unit(np.stack([np.zeros_like(d[0]), d[2], -d[1]]))
    return side, np.cross(d, side, axis=0)


class Ball:
    def __init__(self, centre, radius):
        self.centre, self.radius = column(centre), radius

    def distance(self, p, d, entering):
        offset = p - self.centre
        middle = -dot(offset, d)
        half = np.sqrt(middle * middle - dot(offset, offset) + self.radius**2)
        return middle - half if entering else middle + half

    def normal(self, p):
        """And its change with a change of p."""
        return (p - self.centre) / self.radius, lambda dp: dp / self.radius


class Water:
    """y = level + a sum of sines, inside of a round window; waves: height, length, angle, phase; `finer`: in all of
    them."""

    def __init__(self, level, radius, finer=1):
        self.level, self.radius = level, radius
        self.waves = [(height / finer, 2 * math.pi * finer / length * math.cos(angle),
                       2 * math.pi * finer / length * math.sin(angle), phase) for height, length, angle, phase in WAVES]

    def sines(self, x, z):
        for height, a, b, phase in self.waves:
            angle = a * x + b * z + phase
            yield a, b, height * np.sin(angle), height * np.cos(angle)

    def distance(self, p, d, entering):
        t = (self.level - p[1]) / d[1]
        for _ in range(3):  # Newton, down to some 1e-12 m at these slopes
            above, falling = p[1] + t * d[1] - self.level, d[1]
            for a, b, sine, cosine in self.sines(p[0] + t * d[0], p[2] + t * d[2]):
                above, falling = above - sine, falling - cosine * (a * d[0] + b * d[2])
            t = t - above / falling
        inside = (p[0] + t * d[0]) ** 2 + (p[2] + t * d[2]) ** 2 < self.radius**2
        return np.where(inside & (d[1] < 0), t, np.nan)

    def normal(self, p):
        waves, zero = list(self.sines(p[0], p[2])), np.zeros_like(p[0])
        n = np.stack([-sum(a * cosine for a, _, _, cosine in waves), zero + 1,
                      -sum(b * cosine for _, b, _, cosine in waves)])
        length = np.sqrt(dot(n, n))
        n = n / length

        def change(dp):
            bent = [(a, b, sine * (a * dp[0] + b * dp[2])) for a, b, sine, _ in waves]
            dn = np.stack([sum(a * c for a, _, c in bent), zero, sum(b * c for _, b, c in bent)]) / length
            return dn - dot(dn, n) * n
        return n, change


class Scene:
    """chain: surface, whether light enters what it is around, ior before over ior behind. The cone: axis, cosine.
    The picture: centre, half of its side in metres, its side in pixels."""

    def __init__(self, lamp, chain, axis, cosine, centre, half, side):
        self.lamp, self.chain, self.axis, self.cosine = column(lamp), chain, unit(column(axis)), cosine
        self.corner, self.pixel, self.side, self.pixels = column(centre) - half, 2 * half / side, side, side * side
        self.cone = 2 * math.pi * (1 - cosine)  # its solid angle

    def directions(self, u, v):
        cosine, (side, up) = 1 - u * (1 - self.cosine), across(self.axis)
        sine, turn = np.sqrt(1 - cosine**2), 2 * math.pi * v
        return cosine * self.axis + sine * (np.cos(turn) * side + np.sin(turn) * up)

    def places(self, rng, samples):
        """One in each pixel: 2 x samples x pixels."""
        z, x = np.divmod(np.arange(self.pixels), self.side)
        pixels = np.stack([x, z])[:, None]
        return (pixels + rng.random((2, samples, self.pixels))) * self.pixel + self.corner[:, :, None]

    def cells(self, places):
        return np.floor((places - self.corner) / self.pixel).astype(int)

    def inside(self, cells):
        return (cells >= 0).all(0) & (cells < self.side).all(0)

    def picture(self, cells, light):
        return np.bincount(cells[0] + self.side * cells[1], light, self.pixels)


def make_scenes(side):
    def glass(surface):
        return [(surface, True, 1 / IOR)]

    def bulb(y):
        return [(Ball((0.02, y, 0.05), 0.45), False, 1 / IOR), (Ball((0.0, y, 0.0), 0.5), False, IOR)]
    ball, sheet, fine = Ball((0.0, 1.3, 0.0), 1.0), Water(1.6, 1.1), Water(1.6, 1.1, finer=3)
    cosine = math.sqrt(1 - 1 / math.dist((0.8, 4.0, 0.5), (0.0, 1.3, 0.0)) ** 2)
    lamp, axis, down, middle = (0.3, 5.0, 0.2), (-0.3, -3.4, -0.2), (0.0, -1.0, 0.0), (0.0, 0.0)
    return {
        "ball": Scene((0.8, 4.0, 0.5), glass(ball) + [(ball, False, IOR)], (-0.8, -2.7, -0.5), cosine,
                      (-0.32, -0.2), 0.4, side),
        "water": Scene(lamp, glass(sheet), axis, 0.948, middle, 0.5, side),
        "ripples": Scene(lamp, glass(fine), axis, 0.948, middle, 0.5, side),
        "bulb": Scene((0.0, 2.1, 0.0), bulb(2.0), down, 0.7, middle, 1.0, side),
        "bulb over water": Scene((0.0, 4.1, 0.0), bulb(4.0) + glass(sheet), down, 0.905, middle, 0.5, side)}


def reflectance(before, behind, eta):
    """Fresnel's; of cosines."""
    s, p = (eta * before - behind) / (eta * before + behind), (before - eta * behind) / (before + eta * behind)
    return (s * s + p * p) / 2


def shine(scene, d, rng=None, derivatives=False):
    """Follows the lamp's light in directions d: where it lands, which share (with an rng, chance decides at each
    surface and the share is 1 or 0), rays, and the change of the place by changes of d across it: 2 x 2 x
    directions."""
    p, share, rays = np.broadcast_to(scene.lamp, d.shape), np.ones(d.shape[1]), np.zeros(d.shape[1], int)
    changes = [(np.zeros_like(d), dd) for dd in across(d)] if derivatives else []
    for surface, entering, eta in scene.chain:
        rays += share > 0
        t = surface.distance(p, d, entering)
        p = p + t * d
        n, turn = surface.normal(p)
        facing = 1.0 if entering else -1.0
        n = facing * n
        before = -dot(d, n)
        behind = np.sqrt(1 - eta * eta * (1 - before * before))  # not a number: reflected totally, or missed
        bend = eta * before - behind
        for i, (dp, dd) in enumerate(changes):
            dp = dp + t * dd
            dp = dp + dot(dp, n) / before * d
            dn = facing * turn(dp)
            change = -dot(dd, n) - dot(d, dn)
            changes[i] = dp, eta * dd + bend * dn + eta * (1 - eta * before / behind) * change * n
        d = eta * d + bend * n
        passes = np.nan_to_num(1 - reflectance(before, behind, eta))
        share = share * (passes if rng is None else rng.random(len(passes)) < passes)
    share = np.where(d[1] < 0, share, 0.0)
    t = -p[1] / d[1]
    changes = [dp + t * dd for dp, dd in changes]
    return (p + t * d)[[0, 2]], share, rays, [(dp - dp[1] / d[1] * d)[[0, 2]] for dp in changes]


def walk(scene, places, rng, reach):
    """Once for each place from a random direction: direction, irradiance there (0: no root found), rays."""
    count = places.shape[1]
    root, light, rays, at = np.zeros((3, count)), np.zeros(count), np.zeros(count, int), np.arange(count)
    u, v = rng.random((2, count))
    if reach:
        x, z = places + reach * np.sqrt(u) * np.stack([np.cos(2 * math.pi * v), np.sin(2 * math.pi * v)])
        trial = unit(np.stack([x, np.zeros(count), z]) - scene.lamp)
    else:
        trial = scene.directions(u, v)
    d, step, length, nearest = trial, np.zeros_like(trial), np.ones(count), np.full(count, np.inf)
    for _ in range(STEPS + 1):
        place, share, used, (by_side, by_up) = shine(scene, trial, derivatives=True)
        rays[at] += used
        miss = place - places[:, at]
        area = by_side[0] * by_up[1] - by_side[1] * by_up[0]
        side, up = across(trial)
        newton = ((by_up[0] * miss[1] - by_up[1] * miss[0]) * side +
                  (by_side[1] * miss[0] - by_side[0] * miss[1]) * up) / area
        off = np.sqrt(dot(miss, miss))
        better = (share > 0) & (off < nearest)
        d, step, nearest = np.where(better, trial, d), np.where(better, newton, step), np.where(better, off, nearest)
        length = np.where(better, np.minimum(1, 2 * length), length / 2)
        there = better & (off < ARRIVED)
        root[:, at[there]], light[at[there]] = trial[:, there], (share / abs(area))[there]
        on = ~there & (nearest < np.inf)
        at, d, step, length, nearest = at[on], d[:, on], step[:, on], length[on], nearest[on]
        if not len(at):
            break
        trial = unit(d + length * step)
    return root, light, rays


def is_same(root, other):
    return abs(root - other).max(0) < SAME


class Manifold:
    def __init__(self, scene, reach, most):
        self.scene, self.reach, self.most = scene, reach, most
        self.walks, self.roots, self.counted, self.lost = 0, 0, 0, 0

    def estimate(self, rng, done, samples):
        """Sum over samples, and rays."""
        places = self.scene.places(rng, samples).reshape(2, -1)
        root, light, rays = walk(self.scene, places, rng, self.reach)
        lit = np.flatnonzero(light)
        count, more = self.trials(places[:, lit], root[:, lit], rng)
        light[lit] *= count
        self.walks += len(light)
        self.roots += len(lit)
        self.counted += count.sum()
        return light.reshape(samples, -1).sum(0), rays.sum() + more + len(lit)

    def trials(self, places, root, rng):
        """Walks until each root is found again, and their rays. More go at once than may be needed; those do not
        count."""
        count, rays, done, pending = np.zeros(places.shape[1], int), 0, 0, np.arange(places.shape[1])
        while len(pending) and done < self.most:
            some = min(max(LANES // len(pending), 1), self.most - done)
            of = np.repeat(pending, some)
            other, light, used = walk(self.scene, places[:, of], rng, self.reach)
            again = (is_same(root[:, of], other) & (light > 0)).reshape(-1, some)
            needed = np.where(again.any(1), again.argmax(1) + 1, some)
            count[pending] += needed
            rays += used.reshape(-1, some)[np.arange(some) < needed[:, None]].sum()
            done, pending = done + some, pending[~again.any(1)]
        self.lost += len(pending)
        return count, rays


class Several:
    def __init__(self, scene, reach, walks):
        self.scene, self.reach, self.walks = scene, reach, walks

    def estimate(self, rng, done, samples):
        places = self.scene.places(rng, samples).reshape(2, -1)
        total, rays, known = np.zeros(places.shape[1]), 0, []
        for _ in range(self.walks):
            root, light, used = walk(self.scene, places, rng, self.reach)
            for other in known:
                light[is_same(root, other)] = 0
            known.append(root)
            total, rays = total + light, rays + used.sum() + (light > 0).sum()
        return total.reshape(samples, -1).sum(0), rays


class Merging:
    def __init__(self, scene, everywhere):
        self.scene, self.solid_angle = scene, 4 * math.pi if everywhere else scene.cone

    def estimate(self, rng, done, samples):
        scene, count = self.scene, samples * self.scene.pixels
        paths = np.flatnonzero(rng.random(count) < scene.cone / self.solid_angle)  # the others meet nothing
        places, share, rays, _ = shine(scene, scene.directions(*rng.random((2, len(paths)))), rng)
        landed = share > 0
        rays = rays.sum() + landed.sum() + count - len(paths)
        radius = FIRST_RADIUS * scene.pixel * (done + 1 + np.arange(samples)) ** SHRINK
        places, of = places[:, landed], paths[landed] // scene.pixels
        cells, eyes, total = scene.cells(places), scene.places(rng, samples), np.zeros(scene.pixels)
        reach = math.ceil(radius[0] / scene.pixel)
        for z in range(-reach, reach + 1):
            for x in range(-reach, reach + 1):
                near = cells + np.array([[x], [z]])
                i = np.flatnonzero(scene.inside(near))
                offset = places[:, i] - eyes[:, of[i], near[0, i] + scene.side * near[1, i]]
                i = i[dot(offset, offset) < radius[of[i]] ** 2]
                total += scene.picture(near[:, i], radius[of[i]] ** -2)
        return total * self.solid_angle / (math.pi * scene.pixels), rays


def reference(scene, count):
    """The picture by two lattices of directions, its own relMSE, and how far glass displaces its light at most."""
    pictures, reach = [], 0.0
    for shift in (0.25, 0.75):
        total = np.zeros(scene.pixels)
        for start in range(0, count, LANES):
            i = np.arange(start, min(start + LANES, count)) + shift
            d = scene.directions(i / count, i * (math.sqrt(5) - 1) / 2 % 1)
            places, share, *_ = shine(scene, d)
            cells = scene.cells(places)
            lit = (share > 0) & scene.inside(cells)
            total += scene.picture(cells[:, lit], share[lit])
            away = ((scene.lamp - scene.lamp[1] / d[1] * d)[[0, 2]] - places)[:, lit]
            reach = max(reach, math.sqrt(dot(away, away).max(initial=0)))
        pictures.append(total * scene.cone / count / scene.pixel**2)
    return sum(pictures) / 2, errors(*pictures)[0] / 4, reach


def errors(picture, truth):
    """relMSE; MSE over the square of the mean."""
    square, mean = (picture - truth) ** 2, truth.mean()
    return np.mean(square / (truth**2 + 0.01 * mean**2)), np.mean(square) / mean**2


def run(method, truth, seed, grid, camera_rays):
    """Both errors at the numbers of rays of the grid, and the light of all pixels over the reference's at the end."""
    rng, total, done, rays, points = np.random.default_rng(seed), np.zeros(len(truth)), 0, 0, []
    while rays < grid[-1]:
        samples = min(max(done // 4, 1), max(LANES // len(truth), 1))
        picture, used = method.estimate(rng, done, samples)
        total, done, rays = total + picture, done + samples, rays + used + camera_rays * samples * len(truth)
        points.append((rays, *errors(total / done, truth)))
    at, *both = np.log(points).T
    return [np.exp(np.interp(np.log(grid), at, error, left=np.nan)) for error in both], total.sum() / done / truth.sum()


def study(scene, args, grid):
    truth, floor, reach = reference(scene, args.directions)
    reach *= 1.02  # what the lattice may have missed
    if reach > scene.lamp[1, 0] * math.sqrt(1 / scene.cosine**2 - 1):
        reach = 0.0  # the cone is narrower
    methods = {"manifold": Manifold(scene, 0.0, args.most_trials), "near": Manifold(scene, reach, args.most_trials),
               "several": Several(scene, reach, args.walks), "aimed": Merging(scene, False),
               "emitted": Merging(scene, True)}
    if not reach:
        del methods["near"]
    told = {}
    for name, method in methods.items():
        runs = [run(method, truth, seed, grid, args.camera_rays) for seed in range(1, args.seeds + 1)]
        relmse, mse = np.mean([both for both, _ in runs], 0).tolist()
        told[name] = {"relmse": relmse, "mse": mse, "light": float(np.mean([light for _, light in runs]))}
        if isinstance(method, Manifold):
            told[name] |= {"found": method.roots / method.walks, "trials": float(method.counted / max(method.roots, 1)),
                           "lost": method.lost / max(method.roots, 1)}
    return {"floor": floor, "reach": reach, "methods": told}


def crossing(grid, one, other):
    """From how many rays on the first error is the smaller one, in words."""
    below = np.array(one) < other
    if below[-1]:
        return f"less from at most {grid[len(grid) - np.argmin(np.append(below[::-1], False))]:.0e} rays on"
    return f"more; as 1/rays meets rays^(-2/3), less from some {grid[-1] * (one[-1] / other[-1]) ** 3:.0e} rays on"


def report(name, result, grid):
    methods, decades = result["methods"], np.flatnonzero(np.isclose(np.log10(grid) % 1, 0))
    best = "near" if "near" in methods else "manifold"
    print(f"\n{name}: floor of the reference {result['floor']:.1e}, reach {result['reach']:.2f} m")
    print(f"{'rays':>8}" + "".join(f"{m:>10}" for m in methods) + "  relMSE")
    for k in decades:
        print(f"{grid[k]:8.0e}" + "".join(f"{m['relmse'][k]:10.2g}" for m in methods.values()))
    slopes = [math.log10(m["relmse"][-1] / m["relmse"][-5]) for m in methods.values()]  # over the last decade
    print(f"{'slope':>8}" + "".join(f"{slope:10.2f}" for slope in slopes))
    print(f"{'light':>8}" + "".join(f"{m['light']:10.4f}" for m in methods.values()))
    for m, told in list(methods.items())[:-3]:
        print(f"  {m}: {told['found']:.1%} of walks find a root, {told['trials']:.1f} walks find it again, "
              f"none of most trials does for {told['lost']:.2%} of roots")
    for error in ("relmse", "mse"):
        for m in ("aimed", "emitted"):
            ratios = ", ".join(f"{methods[best][error][k] / methods[m][error][k]:.2g}" for k in decades)
            where = crossing(grid, methods[best][error], methods[m][error])
            print(f"  {error} of {best} over {m}: {ratios}; {where}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", default=",".join(make_scenes(1)), help="default: all, %(default)s")
    parser.add_argument("--side", type=int, default=24, help="of the picture, in pixels")
    parser.add_argument("--rays", type=float, default=1e7, help="the most, of all pixels")
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--walks", type=int, default=8, help="of `several`")
    parser.add_argument("--most-trials", type=int, default=1000)
    parser.add_argument("--camera-rays", type=int, default=2, help="of a sample of a pixel: to glass, and behind it")
    parser.add_argument("--directions", type=int, default=1 << 22, help="of each of the reference's two lattices")
    parser.add_argument("--json", help="file for all numbers")
    args = parser.parse_args()
    if args.rays < 1e5:
        parser.error("--rays is less than 1e5: slopes are of the last of two decades")
    np.seterr(all="ignore")  # rays that miss are not numbers
    grid, results, scenes = 10 ** (np.arange(16, 4 * math.log10(args.rays) + 1e-6) / 4), {}, make_scenes(args.side)
    for name in args.scenes.split(","):
        results[name] = study(scenes[name], args, grid)
        report(name, results[name], grid)
    if args.json:
        with open(args.json, "w") as file:
            json.dump({"arguments": vars(args), "rays": grid.tolist(), "scenes": results}, file, indent=1)


if __name__ == "__main__":
    main()
