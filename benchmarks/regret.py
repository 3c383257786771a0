#!/usr/bin/env python3
"""What `render` loses by what it decides itself: squared error times CPU seconds of `auto`, over those of the best
fixed choice.

On scenes that nobody tuned (generated_scenes.py), each against a picture of many samples. First every fixed choice
renders once, one deviation from the plainest at a time and those that pay together. Then the best ones render in turns
with the default command line, with other random numbers. All runs are kept in FOLDER: what was measured is not measured
again, that of the default command line as long as the program is the same. See --help.

Seconds are CPU seconds of the process (cpu_clock.c is preloaded; needs a C compiler), because other work then disturbs
them little. Two costs are told. `rendering`: of the picture and of all pilots. `all`: everything between loading and
writing, less what the plainest choice takes before its first sample, so that kernels for pilots count as well.
"""

import argparse
import array
import hashlib
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

import generated_scenes
from exr import read_ours

HERE = pathlib.Path(__file__).resolve().parent
PROGRAM = HERE.parent / "build/host/wavepath"
REFERENCE_SEEDS = (7777, 7778)
WARM_SPP = 4  # of the render that has the driver compile kernels
RARE = 0.001  # of pixels: the worst ones, which one bright path in a thousand decides
PAYS = 0.98  # a deviation that costs more than this is not kept
PLAIN = {"integrator": "path", "lights": "power", "light-samples": 1, "sky-samples": 1, "reuse": "off",
         "adaptive": "off",
         "bvh": "auto"}
AUTO = "auto"  # the default command line


def flags_of(choice):
    if choice == AUTO:
        return []
    if choice["integrator"] == "bidirectional":  # as auto takes it, which leaves out what is biased
        return ["--integrator", "bidirectional", "--techniques", "hit,light,connect,splat", "--lights",
                choice["lights"]]
    flags = [text for name, value in choice.items() if name != "guide" for text in (f"--{name}", str(value))]
    return flags + (["--guide"] if choice.get("guide") else [])


def name_of(choice):
    """What differs from the plainest choice."""
    if choice == AUTO:
        return AUTO
    text = " ".join(f"{name} {value}" for name, value in choice.items() if PLAIN.get(name) != value)
    return text or "plain"


def deviations(scene):
    """Those that may pay, each alone."""
    kind, light = scene["words"], scene["words"].split(",")[0]
    environment = scene["flags"][scene["flags"].index("--env") + 1]
    is_map, is_black = environment.endswith(".hdr"), environment == "black"
    found = [{"reuse": "on"}, {"adaptive": "on"}]
    if light == "hidden" or "glass" in kind or "closed" in kind:
        found += [{"integrator": "bidirectional"}, {"guide": True}]
    if light == "lamps":
        found += [{"lights": "tree"}, {"lights": "learned"}]
    if is_map:
        found += [{"lights": "learned"}]
    if not is_black or light == "lamps":
        found += [{"light-samples": n} for n in (2, 4) if is_map or light != "sky"]
    elif light != "hidden":
        found += [{"light-samples": 2}]
    if not is_black and not is_map:
        found += [{"sky-samples": n} for n in (2, 4, 7)] + [{"sky-samples": 7, "lights": "learned"}]
    if "fine" in kind:
        found += [{"bvh": quality} for quality in ("fast", "best")]
    return found


class Lab:
    def __init__(self, args):
        self.args, self.folder = args, args.folder.resolve()
        self.program = args.program.resolve()
        self.runs = self.folder / "runs"
        self.runs.mkdir(parents=True, exist_ok=True)
        self.clock = self.folder / "cpu_clock.so"
        subprocess.run(["cc", "-O2", "-shared", "-fPIC", "-o", self.clock, HERE / "cpu_clock.c"], check=True)
        self.program_hash = hashlib.sha256(self.program.read_bytes()).hexdigest()[:16]

    def call(self, *command, clock=False):
        environment = dict(os.environ, LD_PRELOAD=str(self.clock)) if clock else None
        result = subprocess.run([self.program, *map(str, command)], capture_output=True, text=True, env=environment)
        if result.returncode not in (0, 3):
            raise RuntimeError(f"{' '.join(map(str, command))}: {result.stderr.strip()}")
        return json.loads(result.stdout)

    def kept(self, key, make):
        path = self.runs / (hashlib.sha256(json.dumps(key).encode()).hexdigest()[:24] + ".json")
        if path.exists():
            return json.loads(path.read_text())
        made = make()
        path.write_text(json.dumps(dict(made, key=key)) + "\n")
        return made

    def render(self, scene, flags, spp, seed, output):
        return self.call("render", scene["scene"], *scene["flags"], *flags, "--size", self.args.size, "--spp", spp,
                         "--seed",
                         seed, "-q", "--json", "-o", output, clock=True)

    def reference(self, scene):
        """The mean of two pictures, and the squared errors that it has itself: half of what one differs from it, as if
        it were one of two independent ones."""
        key = ["reference", scene_hash(scene), self.args.size, self.args.reference_spp]
        path = self.runs / (hashlib.sha256(json.dumps(key).encode()).hexdigest()[:24] + ".floats")

        def make():
            with tempfile.TemporaryDirectory() as folder:
                halves = []
                for seed in REFERENCE_SEEDS:
                    picture = pathlib.Path(folder) / "reference.exr"
                    stats = self.render(scene, [], self.args.reference_spp // 2, seed, picture)
                    halves.append(colours(picture))
            mean = array.array("f", ((a + b) / 2 for a, b in zip(*halves)))
            path.write_bytes(mean.tobytes())
            return {"errors": squared_errors(halves[0], mean), "integrator": stats["integrator"]}

        told = self.kept(key, make)
        mean = array.array("f")
        mean.frombytes(path.read_bytes())
        return mean, told["errors"]

    def measure(self, scene, choice, spp, seed):
        """Squared error of one render, its seconds, and what was decided."""
        key = [scene_hash(scene), self.args.size, self.args.reference_spp, flags_of(choice), spp, seed]
        if choice == AUTO:
            key.append(self.program_hash)

        def make():
            with tempfile.TemporaryDirectory() as folder:
                picture = pathlib.Path(folder) / "picture.exr"
                if not self.warm(scene, choice, spp).exists():
                    self.render(scene, flags_of(choice), WARM_SPP if choice != AUTO else spp, seed, picture)
                    self.warm(scene, choice, spp).touch()
                stats = self.render(scene, flags_of(choice), spp, seed, picture)
                reference, its_errors = self.reference(scene)
                errors = squared_errors(colours(picture), reference)
            return digest(stats, {name: errors[name] - its_errors[name] for name in errors})

        return self.kept(key, make)

    def warm(self, scene, choice, spp):
        """Is there once the driver's cache has the kernels: of the default command line, which tries what the length
        of the render pays for, or of a fixed choice."""
        key = [spp, self.program_hash] if choice == AUTO else flags_of(choice)
        return self.runs / f"warm-{scene_hash(scene)}-{hashlib.sha256(json.dumps(key).encode()).hexdigest()[:16]}"

    def screen(self, scene):
        """All fixed choices with what each costs, the cheapest first."""
        costs = {}

        def cost(choice):
            name = name_of(choice)
            if name not in costs:
                run = self.measure(scene, choice, self.args.screen_spp, 1)
                costs[name] = (run["typical"] * (run["rendering"] + run["bvh"]), choice)
            return costs[name][0]

        plain = cost(PLAIN)
        alone = sorted(((cost({**PLAIN, **d}), d) for d in deviations(scene)), key=lambda pair: pair[0])
        best = dict(PLAIN)
        for price, deviation in alone:
            joined = {**best, **deviation}
            if price > PAYS * plain or joined["integrator"] != "path" or (joined.get("guide")
                                                                          and joined["reuse"] == "on"):
                continue
            if cost(joined) < PAYS * cost(best):
                best = joined
        return sorted(costs.values(), key=lambda pair: pair[0])

    def judge(self, scene, spp):
        """Costs of the default command line, of the plainest choice and of the best ones, in turns."""
        fixed = [choice for _, choice in self.screen(scene) if spp >= 4 or choice["adaptive"] == "off"]
        choices = [AUTO, PLAIN] + [c for c in fixed[:self.args.contenders] if c != PLAIN]
        runs = {name_of(c): [] for c in choices}
        for seed in range(100, 100 + self.args.repeats):
            for choice in choices:
                runs[name_of(choice)].append(self.measure(scene, choice, spp, seed))
        before = min(r["all"] - r["rendering"] for r in runs["plain"])
        rows = {name: summary(of, before) for name, of in runs.items()}
        result = {"seed": scene["seed"], "tuning": scene["tuning"], "words": scene["words"], "spp": spp, "rows": rows}
        for how in ("rendering", "all"):
            fixed_rows = {name: row for name, row in rows.items() if name != AUTO}
            best = min(fixed_rows, key=lambda name: fixed_rows[name]["cost"][how])
            result[how] = {"best": best, "regret": rows[AUTO]["cost"][how] / fixed_rows[best]["cost"][how]}
        return result


def colours(path):
    """R, G, B of all pixels, one after the other."""
    _, _, channels = read_ours(path)
    return array.array("f", (v for pixel in zip(*channels) for v in pixel))


def squared_errors(picture, reference):
    """relMSE, and the same without the worst of pixels."""
    relative = [(x - r) * (x - r) / (r * r + 0.01) for x, r in zip(picture, reference)]
    pixels = sorted(sum(c) for c in zip(*[iter(relative)] * 3))
    most = pixels[:len(pixels) - int(RARE * len(pixels))]
    return {"relmse": sum(pixels) / (3 * len(pixels)), "typical": sum(most) / (3 * len(pixels))}


def scene_hash(scene):
    parts = [pathlib.Path(scene["scene"]), *(pathlib.Path(f) for f in scene["flags"] if f.endswith(".hdr"))]
    names = [f for f in scene["flags"] if not f.endswith(".hdr")]
    return hashlib.sha256(b"".join(p.read_bytes() for p in parts) + " ".join(names).encode()).hexdigest()[:16]


def digest(stats, errors):
    """What is kept of a render."""
    seconds, plan = stats["seconds"], {decision["what"]: decision for decision in stats["plan"]}
    pilots = {name: {"rendering": d["render_seconds"], "all": d["seconds"]} for name, d in plan.items() if d["seconds"]}
    if "lights" in pilots:  # trained within the render
        pilots["lights"]["rendering"] = pilots["lights"]["all"]
    if noise := plan.get("adaptive", {}).get("pilot"):  # tells no seconds: by its paths
        paths = math.prod(noise["size"]) * noise["spp"]
        part = seconds["render"] * paths / (paths + stats["rays"]["camera"])
        pilots["adaptive"] = {"rendering": part, "all": part}
    before = sum(decision["render_seconds"] for decision in plan.values())
    return {**errors, "estimate": (stats["error"]["relative_rms"] or 0.0)**2, "rendering": seconds["render"] + before,
            "picture": seconds["render"], "all": seconds["total"] - seconds["load"] - seconds["bvh"] - seconds["write"],
            "total": seconds["total"], "bvh": seconds["bvh"], "pilots": pilots,
            "taken": {name: decision["taken"] for name, decision in plan.items()},
            "plan": [decision for decision in plan.values() if decision["fraction"]]}


def summary(runs, before):
    """`before`: what the plainest choice takes before its first sample. Of seconds the least: all do the same work, and
    what disturbs a process only adds."""
    relmse, typical = (statistics.fmean(r[name] for r in runs) for name in ("relmse", "typical"))
    rendering = min(r["rendering"] + r["bvh"] for r in runs)
    whole = max(min(r["all"] + r["bvh"] for r in runs) - before, rendering)
    pilots = min(sum(p["rendering"] for p in r["pilots"].values()) for r in runs)
    taken = runs[-1]["taken"]
    return {"relmse": relmse, "typical": typical, "rendering": rendering, "all": whole, "pilots": pilots / rendering,
            "total": statistics.median(r["total"] for r in runs),
            "cost": {"rendering": typical * rendering, "all": typical * whole, "with rare": relmse * rendering},
            "taken": taken, "parts": {name: round(part["rendering"] / rendering, 3)
                                      for name, part in runs[-1]["pilots"].items()}}


def geometric_mean(values):
    return math.exp(statistics.fmean(math.log(v) for v in values))


def taken_text(taken):
    text = [taken["integrator"] + (" --guide" if taken.get("guide") == "on" else "")]
    text += [f"sky {taken['sky-samples']}"] if taken.get("sky-samples", "1") != "1" else []
    text += [f"lights {taken['lights']}"] if taken.get("lights", "power") != "power" else []
    text += ["reuse"] if taken.get("reuse") == "on" else []
    text += ["adaptive"] if taken.get("adaptive") == "on" else []
    return " ".join(text)


def row(*cells):
    return "| " + " | ".join(str(c) for c in cells) + " |"


def table(results):
    lines = [row("seed", "scene", "spp", "auto took", "pilots", "best fixed", "regret", "best fixed (all)",
                 "regret (all)"),
             row(*["---"] * 9)]
    for r in results:
        auto = r["rows"][AUTO]
        lines.append(row(r["seed"], r["words"], r["spp"], taken_text(auto["taken"]), f"{100 * auto['pilots']:.0f} %",
                         r["rendering"]["best"], f"{r['rendering']['regret']:.2f}", r["all"]["best"],
                         f"{r['all']['regret']:.2f}"))
    lines += ["", row("half", "spp", "scenes", "mean", "worst", "mean (all)", "worst (all)", "pilots at most"),
              row(*["---"] * 8)]
    for tuning in (True, False):
        for spp in (*sorted({r["spp"] for r in results}), None):
            of = [r for r in results if r["tuning"] == tuning and spp in (None, r["spp"])]
            if not of:
                continue
            regrets = {how: [r[how]["regret"] for r in of] for how in ("rendering", "all")}
            cells = [f"{value:.2f}" for how in ("rendering", "all")
                     for value in (geometric_mean(regrets[how]), max(regrets[how]))]
            lines.append(row("tuning" if tuning else "judging", spp or "any", len(of), *cells,
                             f"{100 * max(r['rows'][AUTO]['pilots'] for r in of):.0f} %"))
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, help="for scenes, references and runs")
    parser.add_argument("--program", type=pathlib.Path, default=PROGRAM)
    parser.add_argument("--seeds", type=int, nargs="*", default=list(range(generated_scenes.COUNT)))
    parser.add_argument("--half", choices=("tuning", "judging", "both"), default="both")
    parser.add_argument("--spp", type=int, nargs="*", default=[1, 4, 16, 64])
    parser.add_argument("--size", default="256x192")
    parser.add_argument("--screen-spp", type=int, default=16, help="samples with which fixed choices are compared [16]")
    parser.add_argument("--contenders", type=int, default=2, help="fixed choices that render in turns with auto [2]")
    parser.add_argument("--repeats", type=int, default=3, help="renders of each, with other random numbers [3]")
    parser.add_argument("--reference-spp", type=int, default=128)
    parser.add_argument("--screen-only", action="store_true", help="compare fixed choices, and stop")
    parser.add_argument("--json", type=pathlib.Path, help="where to write all results")
    args = parser.parse_args()
    lab = Lab(args)
    scenes = [s for s in generated_scenes.make(lab.folder / "scenes", args.seeds)
              if args.half == "both" or s["tuning"] == (args.half == "tuning")]
    results = []
    for scene in scenes:
        screened = lab.screen(scene)
        print(f"{scene['seed']:2} {scene['words']}: " + "; ".join(f"{name_of(c)} {cost / screened[0][0]:.2f}"
                                                                 for cost, c in screened), file=sys.stderr, flush=True)
        if not args.screen_only:
            for spp in args.spp:
                results.append(lab.judge(scene, spp))
                auto = results[-1]["rows"][AUTO]
                print(f"   {spp:3} spp: {taken_text(auto['taken'])}, pilots {auto['parts']}: "
                      f"{results[-1]['rendering']['regret']:.2f} of {results[-1]['rendering']['best']}, all "
                      f"{results[-1]['all']['regret']:.2f} of {results[-1]['all']['best']}", file=sys.stderr,
                      flush=True)
    if results:
        print(table(results))
        if args.json:
            args.json.write_text(json.dumps(results, indent=1) + "\n")


if __name__ == "__main__":
    main()
