#!/usr/bin/env python3
"""The light that materials return, wavepath against Cycles: balls in a grid, one material each, in the same light.

Cycles renders each scene three times: as Blender's importer makes it; with all bounces between microfacets (multi);
with smooth layers that take their share from what is below, as glTF has it, instead of adding to it (mixed). That tells
what of a difference is the importer's, and what the model's. Needs Debian's blender, python3-numpy and
openimageio-tools. See --help; results in benchmarks/results/llvmpipe/materials.
"""

import argparse
import math
import pathlib
import statistics
import subprocess
import sys

from exr import read_exr
from peer_cycles import is_color
from peers import Cycles, PeerError, Wavepath, compare

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "scenes"))

from gltf import Gltf, sphere  # noqa: E402

SIZE, DISTANCE, RADIUS = (192, 144), 12.0, 0.3
COLUMNS, ROWS = 4, 3
MODELS = ("imported", "multi", "mixed")
SEEDS = (1, 2)

ROUGH = (0.0, 0.3, 0.6, 1.0)
WHITE, BLACK, GOLD, RED, GREEN = (1.0,) * 3, (0.0,) * 3, (1.0, 0.77, 0.34), (0.7, 0.05, 0.03), (0.5, 0.9, 0.6)
MATT = {"specular": {"specularFactor": 0.0}}


def rough(color, **terms):
    return [((color, {"roughness": r, **terms}), {}) for r in ROUGH]


def coated(color, layers={}, **terms):
    return [((color, terms), {**layers, "clearcoat": {"clearcoatFactor": 1.0, "clearcoatRoughnessFactor": r}})
            for r in ROUGH]


def glass(color, ior):
    layers = {"transmission": {"transmissionFactor": 1.0}, "ior": {"ior": ior}, "volume": {"thicknessFactor": 1.0}}
    return [((color, {"roughness": r}), layers) for r in ROUGH]


def glossy(layer, value, values, **terms):
    return [((BLACK, {"roughness": 0.2, **terms}), {layer: {value: v}}) for v in values]


def cloth(color):
    return [((color, {}), {**MATT, "sheen": {"sheenColorFactor": [1.0] * 3, "sheenRoughnessFactor": r}})
            for r in (0.2, 0.4, 0.6, 1.0)]


# By row: four balls, of (colour, other terms of the material) and extensions.
SCENES = {
    "metal": {"white metal": rough(WHITE, metallic=1.0), "gold": rough(GOLD, metallic=1.0),
              "half a metal": rough(GOLD, metallic=0.5)},
    "dielectric": {"white": rough(WHITE), "red": rough(RED), "black": rough(BLACK)},
    "coat": {"coat alone": coated(BLACK, MATT), "coat on red": coated(RED, MATT),
             "coat on gold": coated(GOLD, metallic=1.0, roughness=0.3)},
    "glass": {"glass, ior 1.5": glass(WHITE, 1.5), "green glass, ior 1.5": glass(GREEN, 1.5),
              "glass, ior 2.4": glass(WHITE, 2.4)},
    "terms": {"specular 0.1, 0.3, 0.6, 1": glossy("specular", "specularFactor", (0.1, 0.3, 0.6, 1.0)),
              "ior 1.2, 1.5, 1.8, 2.4": glossy("ior", "ior", (1.2, 1.5, 1.8, 2.4)),
              "emission 1, 2, 4, 16": glossy("emissive_strength", "emissiveStrength", (1.0, 2.0, 4.0, 16.0),
                                             emissiveFactor=[1.0, 0.5, 0.25])},
    "sheen": {"sheen on black": cloth(BLACK), "sheen on red": cloth(RED), "no sheen": [((RED, {}), MATT)] * 4},
}
LAYERED = ("dielectric", "coat", "terms")  # where layers mixed make a difference
FILES = {"helmet": ("DamagedHelmet/glTF-Binary/DamagedHelmet.glb", 2.6),
         "bottle": ("WaterBottle/glTF/WaterBottle.gltf", 0.4)}


def place(column, line):
    return (column - (COLUMNS - 1) / 2, (ROWS - 1) / 2 - line, 0.0)


def balls(name):
    """The scene, and by material what Blender's importer drops or Principled weighs otherwise."""
    g, told = Gltf(name), {}
    shape = g.shape(sphere(64))
    for line, (label, row) in enumerate(SCENES[name].items()):
        for column, ((color, terms), layers) in enumerate(row):
            title = f"{label} {column}"
            index = g.material(title, color, **terms)
            g.extend(g.doc["materials"][index], **{f"KHR_materials_{layer}": v for layer, v in layers.items()})
            g.mesh(title, shape, index, translation=list(place(column, line)), scale=[RADIUS] * 3)
            coat = layers.get("clearcoat", {})
            told[title] = {"specular": layers.get("specular", {}).get("specularFactor", 1.0),
                           "coat": coat.get("clearcoatFactor", 0.0),
                           "coat_roughness": coat.get("clearcoatRoughnessFactor", 0.0)}
    return g, told


def view_of(args, name, environment):
    view = {"environment": environment, "intensity": 1, "lambert": "none", "punctual": False,
            "max_depth": args.max_depth,
            "size": SIZE, "eye": [0, 0, DISTANCE], "look_at": [0, 0, 0], "told": {}}
    if name in FILES:
        path, height = FILES[name]
        return view | {"scene": str((args.assets / path).resolve()),
                       "yfov": math.degrees(2 * math.atan(height / 2 / DISTANCE))}
    g, view["told"] = balls(name)
    view["scene"] = str(args.work / f"{name}.glb")
    pathlib.Path(view["scene"]).write_bytes(g.binary())
    return view | {"yfov": math.degrees(2 * math.atan(ROWS / 2 / DISTANCE))}


def inside(column, line):
    """Indices of the pixels that a ball covers whole."""
    width, height = SIZE
    x, y, _ = place(column, line)
    unit = height / ROWS
    middle_x, middle_y = width / 2 + x * unit, height / 2 - y * unit
    return [j * width + i for j in range(height) for i in range(width)
            if math.hypot(i + 0.5 - middle_x, j + 0.5 - middle_y) < RADIUS * unit - 1.0]


def means(picture, pixels):
    return [statistics.fmean(picture[i][c] for i in pixels) for c in range(3)]


def ratio(ours, theirs, pixels):
    """Mean over mean by channel, and what the two seeds of each say of its error, all channels together."""
    def of(side):
        return [means(p, pixels) for p in side]
    a, b = of(ours), of(theirs)
    sums = [(sum(first), sum(second)) for first, second in (a, b)]
    error = math.hypot(*((x - y) / (x + y) for x, y in sums if x + y > 0))
    total = [sum(channel) for channel in zip(*a)], [sum(channel) for channel in zip(*b)]
    return [x / y if y else math.nan for x, y in zip(*total)], error


def told(ratios):
    """One figure where the channels agree."""
    low, high = min(ratios), max(ratios)
    return f"{ratios[0]:.3f}" if high - low < 0.004 else " ".join(f"{r:.2f}" for r in ratios)


def study(args, name, environment):
    """One scene in one light: prints its table; a row of pictures."""
    view = view_of(args, name, environment)
    light = "constant" if is_color(environment) else pathlib.Path(environment).stem
    paths = {key: [args.work / f"{name}-{light}-{key}-{seed}.exr" for seed in SEEDS] for key in ("wavepath", *MODELS)}
    models = MODELS if name in LAYERED else MODELS[:2]
    ours = Wavepath(args.wavepath, view)
    for seed, path in zip(SEEDS, paths["wavepath"]):
        ours.render(args.spp, seed, path)
    for model in models:
        with Cycles(args.blender, view | {"model": model}, args.work / "blender.log") as cycles:
            for seed, path in zip(SEEDS, paths[model]):
                cycles.render(args.spp, seed, path)
    pictures = {key: [read_exr(p)[2] for p in paths[key]] for key in ("wavepath", *models)}
    print(f"\n### {name}, {light}\n\n| what | ours | {' | '.join(models)} | +- |\n| --- | --- "
          f"|{' --- |' * len(models)} --- |")
    regions = {} if name in FILES else {f"{label}, {column + 1}": inside(column, line)
                                        for line, label in enumerate(SCENES[name]) for column in range(COLUMNS)}
    for label, pixels in (regions | {"**whole picture**": range(SIZE[0] * SIZE[1])}).items():
        found = [ratio(pictures["wavepath"], pictures[m], pixels) for m in models]
        print(f"| {label} | {' '.join(f'{m:.3f}' for m in means(pictures['wavepath'][0], pixels))} | "
              f"{' | '.join(told(r) for r, _ in found)} | {max(e for _, e in found):.3f} |")
    errors = [compare(args.wavepath, paths["wavepath"][0], paths[m][0])["relmse"] for m in models]
    print(f"| relMSE | | {' | '.join(f'{e:.1e}' for e in errors)} | |", flush=True)
    return [paths[m][0] for m in ("wavepath", "imported", models[-1])]


def strip(rows, out):
    """A row a scene: ours, Cycles' as imported, Cycles' nearest to ours."""
    subprocess.run(["oiiotool", *(tile for row in rows for tile in row), "--mosaic:pad=4", f"3x{len(rows)}", "--ch",
                    "R,G,B",
                    "--colorconvert", "linear", "sRGB", "--compression", "jpeg:85", "-d", "uint8", "-o", out],
                    check=True)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="SCENE", help=f"{', '.join([*SCENES, *FILES])} [default: all that "
                                                                  f"are there]")
    parser.add_argument("--env", default="1,1,1", help="a lat-long picture or three numbers [default: 1,1,1]")
    parser.add_argument("--assets", type=pathlib.Path, help="folder that has DamagedHelmet and WaterBottle")
    parser.add_argument("--wavepath", type=pathlib.Path, default=ROOT / "build/host/wavepath",
                        help="the program [default: build/host/wavepath]")
    parser.add_argument("--blender", default="blender", help="[default: blender]")
    parser.add_argument("--spp", type=int, default=128, help="of each of two seeds [default: 128]")
    parser.add_argument("--max-depth", type=int, default=32, help="[default: 32: rough glass]")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/material_study",
                        help="scenes and pictures [default: build/material_study]")
    parser.add_argument("--strip", type=pathlib.Path, metavar="FILE.jpg",
                        help="a row a scene: ours, Cycles' as imported, its nearest to ours")
    args = parser.parse_args()
    if unknown := [n for n in args.names if n not in SCENES | FILES]:
        parser.error(f"no scene {unknown[0]}; there are {', '.join([*SCENES, *FILES])}")
    return args


def main():
    args = arguments()
    args.work.mkdir(parents=True, exist_ok=True)
    names = args.names or [*SCENES, *(FILES if args.assets else ())]
    rows = [study(args, name, args.env) for name in names]
    if args.strip:
        strip(rows, args.strip)
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except PeerError as error:
        sys.exit(f"material_study: error: {error}")
