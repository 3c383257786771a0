#!/usr/bin/env python3
"""Time to a given error, wavepath against Cycles: the same glTF, camera, light and depth on the same cores.

Each renderer is judged against its own pictures of many samples, so what the two model differently costs neither. Needs
Debian's blender and python3-numpy. See --help; results in benchmarks/results.
"""

import argparse
import hashlib
import importlib.util
import json
import os
import pathlib
import shutil
import statistics
import struct
import sys

from error_time import TARGETS, net_error, plot, summarize, table
from peers import Cycles, PeerError, Wavepath, compare
from scene_files import make_scenes

ROOT = pathlib.Path(__file__).resolve().parent.parent

MAX_DEPTH = 5
REFERENCE_SEEDS = (1000, 1001)

# `reference`: samples a pixel of two references together; what these differ by is taken off the error. Sponza is lit
# through its roof alone: twice the sky makes it as bright as a photograph would be. `made`: by scenes/*.py on demand.
# `lambert`: which materials have no specular part, all or those that the file says it of. `punctual`: lights without
# extent count. The lamps of the caustics are bodies: Cycles finds them too.
SCENES = {
    "cornell": {"scene": ROOT / "scenes/cornell_box.gltf", "lambert": "all", "reference": 2048,
                "eye": [0.278, 0.273, -0.8], "look_at": [0.278, 0.273, 0], "yfov": 39.3076},
    "helmet": {"scene": "DamagedHelmet/glTF-Binary/DamagedHelmet.glb", "environment": "env/studio_small_03_1k.hdr",
               "reference": 2048, "eye": [2, 0.7, 3.2], "look_at": [0, -0.05, 0], "yfov": 40},
    "dragon": {"scene": "StanfordDragon/dragon-plain.glb", "environment": "env/studio_small_03_1k.hdr",
               "reference": 2048, "eye": [-2.5, 2.2, 4.5], "look_at": [0.05, 0.95, 0], "yfov": 35},
    "sponza": {"scene": "Sponza/Sponza.gltf", "environment": "env/venice_sunset_1k.hdr", "intensity": 2,
               "reference": 1024, "eye": [4, 1.8, 0.2], "look_at": [-10, 2.2, -0.3], "yfov": 65},
    "sponza_sky": {"scene": "Sponza/Sponza.gltf", "environment": "1,1,1", "reference": 1024,
                   "eye": [4, 1.8, 0.2], "look_at": [-10, 2.2, -0.3], "yfov": 65},
    "sponza_lamp": {"made": "sponza_lamp.glb", "environment": "1,1,1", "lambert": "all", "reference": 1024,
                    "eye": [4, 1.8, 0.2], "look_at": [-10, 2.2, -0.3], "yfov": 65},
    "hotel": {"scene": "HotelRoom/HotelRoom-plain.glb", "environment": "env/venice_sunset_1k.hdr", "reference": 1024,
              "eye": [10000, 1200, -6000], "look_at": [10200, 1100, -7000], "yfov": 75},
    "showcase": {"scene": ROOT / "scenes/showcase.glb", "lambert": "told", "reference": 2048,
                 "eye": [0, 2.35, 7.4], "look_at": [0, 0.86, 0], "yfov": 26.3561},
    "slit": {"scene": ROOT / "scenes/rooms/slit_room.glb", "lambert": "all", "reference": 4096,
             "eye": [0.3, 1.5, 1.4], "look_at": [3.6, 1.1, 1.6], "yfov": 57.2958},
    "door": {"scene": ROOT / "scenes/rooms/door_ajar.glb", "lambert": "told", "reference": 4096, "max_depth": 8,
             "eye": [0.3, 1.6, 3.0], "look_at": [3.2, 0.9, 1.8], "yfov": 51.5662},
    "veach_ajar": {"scene": "VeachAjar/VeachAjar.glb", "lambert": "told", "reference": 2048, "max_depth": 8,
                   "eye": [4.05402, 1.61647, -2.30652], "look_at": [3.064005, 1.584172, -2.443733], "yfov": 35.9834},
    "many_lights": {"made": "many_lights.glb", "lambert": "all", "punctual": True, "reference": 2048,
                    "eye": [0.35, 2.4, 0.35], "look_at": [1.35, 1.95, 1.2], "yfov": 63.0254},
    "bulb": {"scene": ROOT / "scenes/caustics/bulb_lamp.glb", "lambert": "told", "reference": 8192, "max_depth": 8,
             "eye": [0.5, 0.9, 2.1], "look_at": [0, 0.35, -0.1], "yfov": 42.9718},
    "mirror": {"scene": ROOT / "scenes/caustics/mirror_caustic.glb", "lambert": "told", "reference": 8192,
               "max_depth": 8, "eye": [-0.1, 0.6, 1.9], "look_at": [0, 0.22, -0.4], "yfov": 40.107},
}


def view_of(name, assets, made, size):
    """The scene as both renderers get it, or None where its files are not there."""
    view = {"environment": None, "intensity": 1, "lambert": "none", "punctual": False, "max_depth": MAX_DEPTH,
            "size": size, **SCENES[name]}
    del view["reference"]
    if "made" in view:
        view["scene"] = made / view.pop("made")
    for key in ("scene", "environment"):
        if view[key] and not is_color(view[key]):
            path = pathlib.Path(view[key])
            if not path.is_absolute():
                path = assets / path if assets else path
            if not path.exists():
                return None
            view[key] = str(path.resolve())
    if view["lambert"] == "told":
        view["lambert"] = without_specular(view["scene"])
    return view


def without_specular(scene):
    """Names of the materials that a glTF file, .gltf or .glb, gives a specular factor of 0."""
    data = pathlib.Path(scene).read_bytes()
    if data[:4] == b"glTF":  # a header of 12 bytes and one of 8 for the JSON, which begins with its length
        data = data[20:20 + struct.unpack_from("<I", data, 12)[0]]
    return sorted(m["name"] for m in json.loads(data).get("materials", [])
                  if m.get("extensions", {}).get("KHR_materials_specular", {}).get("specularFactor") == 0)


def is_color(environment):
    return str(environment)[0].isdigit()


def without_folders(view):
    """The same, wherever the files are."""
    return view | {key: pathlib.Path(view[key]).name for key in ("scene", "environment") if view[key]}


def references_of(renderer, view, spp, folder, fresh):
    """Two pictures, rendered once and kept: a converged picture does not change while the renderer gets faster."""
    told = json.dumps([renderer.name, renderer.version, without_folders(view), spp], sort_keys=True)
    sources = [pathlib.Path(view["scene"])]
    if hasattr(renderer, "driver"):
        sources.append(renderer.driver)  # decides which scene its renderer gets
    key = hashlib.sha256(told.encode() + b"".join(s.read_bytes() for s in sources)).hexdigest()[:16]
    paths = []
    for seed in REFERENCE_SEEDS:
        path = folder / f"{renderer.name}-{pathlib.Path(view['scene']).stem}-{spp}-{seed}-{key}.exr"
        if fresh or not path.exists():
            print(f"  reference of {renderer.name}: {spp} samples a pixel ...", file=sys.stderr, flush=True)
            half = path.with_suffix(".part.exr")
            renderer.render(spp, seed, half)
            os.replace(half, path)
        paths.append(path)
    return paths


def count_processor(points):
    """Seconds become those of the processor that the samples past the first took, spread over all cores: what an idle
    machine would need, and hardly more on a busy one."""
    first = min(r["processor"] for r in points[0]["runs"])
    for p in points:
        p["clock_seconds"] = p["seconds"]
        spent = statistics.median(r["processor"] for r in p["runs"]) - first
        p["seconds"] = max(spent, 1e-3) * p["spp"] / (p["spp"] - 1) / os.cpu_count() if p["spp"] > 1 else None
    points[0]["seconds"] = points[1]["seconds"] / 2


def half_octave_after(spp):
    """1, 2, 3, 4, 6, 8, 12 ..."""
    power_of_two = spp & (spp - 1) == 0
    return spp + max(spp // 2, 1) if power_of_two else spp // 3 * 4


def measure(renderers, references, folder, reps, seconds, processor):
    """One series a renderer: 1, 2, 3, 4, 6, 8, 12 ... samples a pixel, taking turns, till the last target or the limit,
    which is of the processor's seconds where these count. Half octaves: an error that falls faster than by halves, as
    where pilots begin to pay, is reached well before the straight line between two octaves."""
    binary = renderers[0].binary

    def relmse(picture, reference):
        return compare(binary, picture, reference)["relmse"]

    between = {name: relmse(*pictures) for name, pictures in references.items()}
    series = {r.name: [] for r in renderers}
    running = set(series)
    spp = 1
    while running:
        runs = {name: [] for name in running}
        for rep in range(reps):
            for renderer in renderers:
                if renderer.name in running:
                    picture = folder / f"{renderer.name}.exr"
                    run = renderer.render(spp, 1 + rep, picture)
                    errors = [relmse(picture, r) for r in references[renderer.name]]
                    run["relmse"] = net_error(errors, between[renderer.name])
                    runs[renderer.name].append(run)
        for name, done in runs.items():
            point = {"spp": spp, "seconds": statistics.median(r["seconds"] for r in done),
                     "relmse": statistics.fmean(r["relmse"] for r in done), "runs": done}
            if point["relmse"] < between[name] / 4:  # half the references' own error: too rough to tell less
                point["relmse"] = between[name] / 4
                if len(series[name]) >= 2:  # a slope needs two
                    print(f"  {name:9} {spp:5} spp: its references are too rough for more samples", file=sys.stderr)
                    running.discard(name)
                    continue
            series[name].append(point)
            print(f"  {name:9} {spp:5} spp {point['seconds']:8.3f} s  relMSE {point['relmse']:.3e}", file=sys.stderr)
            took = min(r["processor"] for r in done) / os.cpu_count() if processor else point["seconds"]
            if spp > 1 and (point["relmse"] < TARGETS[-1] or took > seconds):
                running.discard(name)
        spp = half_octave_after(spp)
    return series


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="SCENE", help=f"{', '.join(SCENES)} [default: all that are there]")
    parser.add_argument("--assets", type=pathlib.Path,
                        help="folder that has Sponza, DamagedHelmet, HotelRoom, StanfordDragon, VeachAjar and env")
    parser.add_argument("--wavepath", type=pathlib.Path, default=ROOT / "build/host/wavepath",
                        help="the program [default: build/host/wavepath]")
    parser.add_argument("--flags", default="", help="of `wavepath render`, besides those of the view: --flags=--guide")
    parser.add_argument("--blender", default="blender", help="[default: blender]")
    parser.add_argument("--reps", type=int, default=3, help="runs of each, by turns; the median counts [default: 3]")
    parser.add_argument("--max-seconds", type=float, default=30,
                        help="a series ends after a run this long [default: 30]")
    parser.add_argument("--quick", action="store_true", help="one run of each, short series, rough references")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/peer_cycles",
                        help="pictures; references are kept there [default: build/peer_cycles]")
    parser.add_argument("--reference", type=int, metavar="N",
                        help="samples a pixel of each renderer's references together [default: by scene]")
    parser.add_argument("--size", default="256x192", help="[default: 256x192]")
    parser.add_argument("--processor", action="store_true",
                        help="count the processor's seconds, by core, instead of the clock's: for a busy machine")
    parser.add_argument("--fresh", action="store_true", help="render the references again")
    parser.add_argument("--json", type=pathlib.Path, metavar="FILE", help="write everything measured")
    parser.add_argument("--plot", type=pathlib.Path, metavar="FILE.png",
                        help="draw relMSE against seconds; needs matplotlib")
    args = parser.parse_args()
    if unknown := [n for n in args.names if n not in SCENES]:
        parser.error(f"no scene {unknown[0]}; there are {', '.join(SCENES)}")
    args.size = [int(n) for n in args.size.split("x")]
    return args


def main():
    args = arguments()
    if not shutil.which(args.blender):
        print(f"there is no {args.blender} to compare with; apt install blender python3-numpy", file=sys.stderr)
        return 2
    if args.plot and not importlib.util.find_spec("matplotlib"):
        print("matplotlib is not there, so there can be no --plot; apt install python3-matplotlib", file=sys.stderr)
        return 2
    reps, seconds, share = (1, 3, 16) if args.quick else (args.reps, args.max_seconds, 1)
    args.work.mkdir(parents=True, exist_ok=True)
    made = make_scenes(args.work / "scenes", args.assets)
    results = {}
    for name in args.names or SCENES:
        view = view_of(name, args.assets, made, args.size)
        if not view:
            print(f"{name}: its files are not there; give their folder with --assets", file=sys.stderr)
            continue
        print(name, file=sys.stderr)
        ours = Wavepath(args.wavepath, view)
        with Cycles(args.blender, view, args.work / "blender.log") as cycles:
            spp = max((args.reference or SCENES[name]["reference"]) // share // 2, 1)  # of each of both
            references = {r.name: references_of(r, view, spp, args.work, args.fresh) for r in (ours, cycles)}
            ours.flags = args.flags.split()  # all integrators have one picture, so that the references serve them all
            series = measure([ours, cycles], references, args.work, reps, seconds, args.processor)
            if args.processor:
                for points in series.values():
                    count_processor(points)
            results[name] = summarize(without_folders(view), series)
            results[name]["reference_spp"], results[name]["flags"] = spp, args.flags
            results[name]["cycles_version"], results[name]["device"] = cycles.version, ours.device
            # Of the two pictures themselves: view, light and depth agree if these are near 1.
            between = compare(args.wavepath, references["wavepath"][0], references["cycles"][0])
            results[name]["mean_ratio"] = between["mean_ratio"]
    print(table(results))
    if args.json:
        args.json.write_text(json.dumps({"size": args.size, "scenes": results}, indent=1) + "\n")
    if args.plot:
        plot(results, args.plot)
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except PeerError as error:
        sys.exit(f"peer_cycles: error: {error}")
