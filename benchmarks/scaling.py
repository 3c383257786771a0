#!/usr/bin/env python3
"""Measures how cost grows: render time with samples and pixels (linear), rays with triangles (logarithmic), bytes a
triangle and a path. Standard library only; see --help. Results in benchmarks/results."""

import argparse
import json
import math
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
BOX = ROOT / "scenes/cornell_box.gltf"  # all-diffuse
SAMPLES = [8, 16, 32, 64, 128]
SIDES = [128, 256, 512, 768]
TRIANGLES = [10_000, 100_000, 1_000_000, 10_000_000]
HILLSIDE = ["--eye", "0,15,45", "--look-at", "0,0,-10", "--yfov", 60]  # low over the terrain: rays graze it
LIMITS = {"linear": 0.03, "bytes_per_triangle": 100, "bytes_per_path": 160}


def wavepath(binary, *arguments):
    result = subprocess.run([str(a) for a in (binary, *arguments)], capture_output=True, text=True)
    if result.returncode != 0:
        sys.exit(f"scaling: {result.stderr.strip()}")
    return result.stdout


def render(binary, scene, spp, size, *more):
    with tempfile.TemporaryDirectory() as folder:
        return json.loads(wavepath(binary, "render", scene, "--spp", spp, "--size", size, "--bvh", "best",
                                   "--adaptive", "off", "--json", "-q", "-o", pathlib.Path(folder) / "picture.exr",
                                   *more))


def bench(binary, scene, *more):
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "bench.json"
        wavepath(binary, "bench", scene, "--bvh", "best", "--json", path, "-q", *more)
        return json.loads(path.read_text())


def processor_seconds(run):
    """What `run` gives, and the processor seconds of the programs that it started."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    result = run()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return result, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def exponent(points, key="seconds"):
    """p of seconds ~ n^p, by least squares on logarithms."""
    x, y = ([math.log(p[k]) for p in points] for k in ("n", key))
    mx, my = statistics.fmean(x), statistics.fmean(y)
    return sum((a - mx) * (b - my) for a, b in zip(x, y)) / sum((a - mx) ** 2 for a in x)


def linear(title, unit, counts, reps, run, idle):
    """All counts in turn, `reps` times over, so that other load on the machine disturbs all alike. Processor seconds
    notice that less, where the device is a CPU; `idle`, an execution that renders next to nothing, is taken off
    them."""
    seconds, processor, started = {n: [] for n in counts}, {n: [] for n in counts}, []
    for _ in range(reps):
        started.append(processor_seconds(idle)[1])
        for n in counts:
            wall, used = processor_seconds(lambda: run(n))
            seconds[n].append(wall)
            processor[n].append(used)
    points = [{"n": n, "seconds": statistics.median(seconds[n]), "runs": seconds[n],
               "processor_seconds": statistics.median(processor[n]) - statistics.median(started)} for n in counts]
    result = {"points": points}
    print(f"{title}\n| {unit} | seconds | each, of the last | processor seconds | each, of the last |")
    print("| --- | --- | --- | --- | --- |")
    for p in points:
        cells = [f"{p[key]:.3f} | {p[key] / p['n'] / (points[-1][key] / points[-1]['n']):.3f}"
                 for key in ("seconds", "processor_seconds")]
        print(f"| {p['n']} | {' | '.join(cells)} |")
    for key in ("seconds", "processor_seconds"):
        result[f"deviation_{key}"] = deviation = exponent(points, key) - 1
        print(f"{key.replace('_', ' ')} ~ n^{1 + deviation:.3f}, {deviation:+.1%} from linear")
    print(f"aim: within {LIMITS['linear']:.0%}\n")
    return result


def triangles(binary, counts, reps):
    """The same hills, ever finer."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for n in counts:
            scene = pathlib.Path(folder) / "terrain.glb"
            subprocess.run([sys.executable, ROOT / "scenes/terrain.py", str(n), scene], check=True,
                           stdout=subprocess.DEVNULL)
            measured = bench(binary, scene, "--repetitions", reps, *HILLSIDE)
            memory = render(binary, scene, 1, "64x64", *HILLSIDE)["memory"]
            rows.append({"triangles": measured["triangles"], "rays": measured["rays"],
                         "bytes_per_triangle": (memory["scene"] + memory["bvh"]) / measured["triangles"]})
    kinds = list(rows[0]["rays"])
    first, last = rows[0], rows[-1]
    growth = {"log": math.log(last["triangles"]) / math.log(first["triangles"])}
    print("Rays into a terrain\n| triangles | " + " | ".join(f"{k}: visits + tests, ns a ray" for k in kinds) +
          " | bytes a triangle |\n| --- |" + " --- |" * (len(kinds) + 1))
    for row in rows:
        cells = [f"{r['visits']:.1f} + {r['tests']:.1f}, {1e3 / r['mrays_per_second']:.0f}"
                 for r in row["rays"].values()]
        print(f"| {row['triangles']} | " + " | ".join(cells) + f" | {row['bytes_per_triangle']:.1f} |")
    for kind in kinds:
        a, b = first["rays"][kind], last["rays"][kind]
        growth[kind] = {"steps": (b["visits"] + b["tests"]) / (a["visits"] + a["tests"]),
                        "seconds": a["mrays_per_second"] / b["mrays_per_second"]}
    print(f"From first to last the triangles' logarithm grows {growth['log']:.2f} times, visits + tests (time) a ray " +
          ", ".join(f"{k} {growth[k]['steps']:.2f} ({growth[k]['seconds']:.2f})" for k in kinds) +
          f"; bytes a triangle at most {LIMITS['bytes_per_triangle']}\n")
    return {"rows": rows, "growth": growth}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("parts", nargs="*", choices=[[], "samples", "pixels", "triangles", "paths"], metavar="PART",
                        help="samples, pixels, triangles, paths [default: all]")
    parser.add_argument("--wavepath", type=pathlib.Path, default=ROOT / "build/host/wavepath",
                        help="the program [default: build/host/wavepath]")
    parser.add_argument("--reps", type=int, default=5, help="runs of each, by turns; the median counts [default: 5]")
    parser.add_argument("--quick", action="store_true", help="up to a million triangles, shorter series, 3 runs")
    parser.add_argument("--json", type=pathlib.Path, metavar="FILE", help="write everything measured")
    args = parser.parse_args()
    reps, cut = (3, -1) if args.quick else (args.reps, None)
    result = {"version": wavepath(args.wavepath, "--version").strip(),
              "device": render(args.wavepath, BOX, 1, "64x64")["device"], "limits": LIMITS}

    def box_seconds(spp, side):
        return render(args.wavepath, BOX, spp, f"{side}x{side}")["seconds"]["render"]

    def idle():
        return box_seconds(1, 16)

    def samples():
        return linear("Cornell box, 256x256", "samples a pixel", SAMPLES[:cut], reps,
                      lambda n: box_seconds(n, 256), idle)

    def pixels():
        return linear("Cornell box, 16 samples a pixel", "pixels", [s * s for s in SIDES[:cut]], reps,
                      lambda n: box_seconds(16, math.isqrt(n)), idle)

    def paths():
        count = bench(args.wavepath, BOX, "--repetitions", 1, "--size", "64x64")["path_tracing"]["bytes_per_path"]
        print(f"Cornell box: {count} bytes a path (at most {LIMITS['bytes_per_path']})\n")
        return {"bytes_per_path": count}

    parts = {"samples": samples, "pixels": pixels, "triangles": lambda: triangles(args.wavepath, TRIANGLES[:cut], reps),
             "paths": paths}
    for name in args.parts or parts:
        result[name] = parts[name]()
    if args.json:
        args.json.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()
