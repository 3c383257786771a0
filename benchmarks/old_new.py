#!/usr/bin/env python3
"""Whether one executable renders slower than another: the same scenes with both in turns, the order changing each time.
Prints for each scene the median seconds of the whole process, which is what a user waits for, their ratio (new / old),
and the smallest and largest ratio among the pairs that ran one after the other; then the ratio of the fastest runs,
which other load on the machine disturbs least, and those of the medians of seconds.render, which need not count the
same in both (before estimates of the error ran beside the waves they did not count), and of CPU time. On a busy
machine, only the last of these means anything.

Usage: old_new.py [flags] OLD NEW
The exit code is 1 if a scene's ratio of medians is above --limit, and the last lines name it: `slower` if every pair
says so, `unclear` if in some pair the new executable was not the slower one."""

import argparse
import json
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
SHARED = ROOT.parent / "shared/scenes"
# Name, scene, flags of `wavepath render`. Scenes of SHARED that are missing are left out.
SCENES = [
    ("cornell", ROOT / "scenes/cornell_box.gltf", "--size 512x512 --spp 16 --adaptive off"),
    ("showcase", ROOT / "scenes/showcase.glb", "--size 512x512 --spp 8 --adaptive off"),
    ("showcase, 64 spp", ROOT / "scenes/showcase.glb", "--size 128x128 --spp 64"),
    ("showcase, adaptive", ROOT / "scenes/showcase.glb", "--size 256x256 --spp 32 --adaptive"),
    ("showcase, hybrid", ROOT / "scenes/showcase.glb", "--size 512x512 --spp 8 --integrator hybrid"),
    ("cornell, denoised", ROOT / "scenes/cornell_box.gltf", "--size 512x512 --spp 8 --integrator hybrid --denoise"),
    ("showcase, ao", ROOT / "scenes/showcase.glb", "--size 512x512 --spp 8 --integrator ao"),
    ("Sponza", SHARED / "Sponza/Sponza.gltf", "--size 512x288 --spp 4 --env 1,1,1 --adaptive off"),
    ("Sponza, hybrid", SHARED / "Sponza/Sponza.gltf", "--size 512x288 --spp 4 --env 1,1,1 --integrator hybrid"),
    ("DamagedHelmet", SHARED / "DamagedHelmet/glTF-Binary/DamagedHelmet.glb", "--size 512x512 --spp 8 --adaptive off"),
    ("HotelRoom", SHARED / "HotelRoom/HotelRoom-meshopt.glb", "--size 512x288 --spp 8 --adaptive off"),
    ("VeachAjar", SHARED / "VeachAjar/VeachAjar.glb", "--size 512x288 --spp 4 --adaptive off"),
]


def run(executable, scene, flags, folder):
    """Seconds of one run: of rendering, of the whole process, of the CPU."""
    command = [executable, "render", scene, *flags.split(), "--json", "-q", "-o", f"{folder}/picture.exr"]
    begin = time.monotonic()
    log = pathlib.Path(folder, "log")
    with log.open("w") as messages:
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=messages)
        document = process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
    total = time.monotonic() - begin
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"old_new.py: {' '.join(map(str, command))} failed: {log.read_text()}")
    return {"render": json.loads(document)["seconds"]["render"], "wall": total, "cpu": usage.ru_utime + usage.ru_stime}


def measure(executables, scene, flags, repetitions):
    """Pairs of runs, (old, new). The first pair, which compiles kernels and reads files for the first time, does not
    count."""
    pairs = []
    with tempfile.TemporaryDirectory() as folder:
        for i in range(repetitions + 1):
            pair = [None, None]
            for side in ((0, 1) if i % 2 else (1, 0)):
                pair[side] = run(executables[side], scene, flags, folder)
            pairs.append(pair)
    return pairs[1:]


def ratios(pairs):
    """What a row of the table shows."""
    def column(side, key):
        return [pair[side][key] for pair in pairs]

    def ratio(key, pick):
        return pick(column(1, key)) / pick(column(0, key))

    of_pairs = [new["wall"] / old["wall"] for old, new in pairs]
    return {"old": statistics.median(column(0, "wall")), "new": statistics.median(column(1, "wall")),
            "ratio": ratio("wall", statistics.median), "least": min(of_pairs), "most": max(of_pairs),
            "fastest": ratio("wall", min), "render": ratio("render", statistics.median),
            "cpu": ratio("cpu", statistics.median)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("-n", type=int, default=5, metavar="N", help="pairs of runs a scene [default: 5]")
    parser.add_argument("-r", default="", metavar="REGEX", help="only the scenes whose name matches")
    parser.add_argument("--limit", type=float, default=1.02, metavar="X",
                        help="largest ratio of medians [default: 1.02]")
    parser.add_argument("--json", metavar="FILE", help="write all runs here")
    args = parser.parse_args()
    executables = [os.path.abspath(args.old), os.path.abspath(args.new)]
    print(f"{'scene':20} {'old s':>8} {'new s':>8} {'ratio':>6} {'least':>6} {'most':>6} {'fastest':>8} {'render':>7} "
          f"{'cpu':>6}")
    results, above = {}, {"slower": [], "unclear": []}
    for name, scene, flags in SCENES:
        if not re.search(args.r, name):
            continue
        if not scene.exists():
            print(f"old_new.py: {name}: left out, there is no {scene}", file=sys.stderr)
            continue
        results[name] = measure(executables, scene, flags, args.n)
        row = ratios(results[name])
        print(f"{name:20} {row['old']:8.3f} {row['new']:8.3f} {row['ratio']:6.3f} {row['least']:6.3f} "
              f"{row['most']:6.3f} {row['fastest']:8.3f} {row['render']:7.3f} {row['cpu']:6.3f}", flush=True)
        if row["ratio"] > args.limit:
            above["slower" if row["least"] > 1 else "unclear"].append(name)
    if args.json:
        pathlib.Path(args.json).write_text(json.dumps(results, indent=1))
    for verdict, names in above.items():
        if names:
            print(f"{verdict}: {', '.join(names)}")
    return 1 if any(above.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
