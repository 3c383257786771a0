#!/usr/bin/env python3
"""What a sample is worth: error and processor time at equal samples, for several executables or flags.

Usage: light_table.py [flags] NAME=COMMAND...     COMMAND: an executable, and flags of `wavepath render` after it
The first one is the base: it renders the references, and ratios are to it. The error is against two references of
different seeds; half of what they differ by is their own share of it and is subtracted, so that they need not be
converged further than the pictures are. Seconds are those of the processor, in user mode, less those of a render of one
sample, so that loading and compiling do not count; other programs disturb them less than a clock, but they do.

    light_table.py base=OLD new=build/host/wavepath                                     # relMSE x time
    light_table.py --metric flip --spp 1,4,16 base=OLD "new=build/host/wavepath --flag"   # what noise looks like
"""

import argparse
import hashlib
import json
import os
import pathlib
import shlex
import statistics
import subprocess
import sys
import tempfile

from error_time import net_error
from scene_files import make_scenes

ROOT = pathlib.Path(__file__).resolve().parent.parent
SHARED = ROOT.parent / "shared/scenes"
SPONZA = "--eye 4,1.8,0.2 --look-at -10,2.2,-0.3 --yfov 65"
# Scene, flags, samples of each of the two references. {made}: files that scenes/*.py write on demand.
SCENES = {
    "cornell": ("{scenes}/cornell_box.gltf", "", 2048),
    "helmet": ("{assets}/DamagedHelmet/glTF-Binary/DamagedHelmet.glb",
               "--env {assets}/env/studio_small_03_1k.hdr --eye 2,0.7,3.2 --look-at 0,-0.05,0 --yfov 40", 2048),
    "sponza sky": ("{assets}/Sponza/Sponza.gltf",
                   f"--env {{assets}}/env/venice_sunset_1k.hdr --env-intensity 2 {SPONZA}", 768),
    "sponza lamp": ("{made}/sponza_lamp.glb", f"--env 1,1,1 {SPONZA}", 1024),
    "showcase": ("{scenes}/showcase.glb", "", 1536),
    "many lights": ("{made}/many_lights.glb", "", 2048),
    "hundred lights": ("{scenes}/rooms/hundred_lights.glb", "", 2048),
    "slit": ("{scenes}/rooms/slit_room.glb", "", 8192),
    "door": ("{scenes}/rooms/door_ajar.glb", "", 8192),
    "veach ajar": ("{assets}/VeachAjar/VeachAjar.glb", "", 4096),
    "bulb": ("{scenes}/caustics/bulb_lamp.glb", "", 16384),
    "mirror": ("{scenes}/caustics/mirror_caustic.glb", "", 8192),
}
DEFAULT = ["cornell", "helmet", "sponza sky", "sponza lamp", "showcase"]
REFERENCE_SEEDS = (1000, 1001)


class Failed(Exception):
    pass


def render(command, scene, flags, output):
    """User seconds of the processor."""
    line = [command[0], "render", scene, *flags, "--filter", "box", "-q", "-o", output, *command[1:]]
    with tempfile.TemporaryFile() as log:
        process = subprocess.Popen([str(word) for word in line], stdout=log, stderr=log)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            log.seek(0)
            raise Failed(f"{shlex.join(map(str, line))}: {log.read().decode(errors='replace').strip()}")
    return usage.ru_utime


def compare(wavepath, picture, reference, metric):
    done = subprocess.run([wavepath, "compare", picture, reference, "--json"], capture_output=True, text=True)
    if done.returncode != 0:
        raise Failed(done.stderr.strip())
    return json.loads(done.stdout)[metric]


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()[:16]


def references(base, name, scene, flags, spp, folder):
    """Two pictures, kept: what a converged picture shows does not change while the renderer gets faster."""
    key = hashlib.sha256(json.dumps([digest(pathlib.Path(scene)), [pathlib.Path(f).name for f in flags], spp]).encode())
    pictures = []
    for seed in REFERENCE_SEEDS:
        path = folder / f"{name.replace(' ', '_')}-{spp}-{seed}-{key.hexdigest()[:12]}.exr"
        if not path.exists():
            print(f"  reference of {name}, {spp} samples, seed {seed} ...", file=sys.stderr, flush=True)
            half = path.with_suffix(".part.exr")
            render(base[:1], scene, [*flags, "--spp", str(spp), "--seed", str(seed)], half)
            os.replace(half, path)
        pictures.append(path)
    return pictures


def measure(commands, scene, flags, pictures, sampler, args, folder):
    """(executable, samples) -> error and user seconds: means over the seeds."""
    base = commands[0][1][0]
    between = compare(base, *pictures, args.metric) if args.metric == "relmse" else 0.0
    runs = {}
    start = {}
    for seed in range(1, args.seeds + 1):
        for name, command in commands:
            own = [*flags, "--sampler", sampler, "--seed", str(seed)]
            output = folder / "picture.exr"
            start.setdefault(name, []).append(render(command, scene, [*own, "--spp", "1"], output))
            for spp in args.spp:
                seconds = render(command, scene, [*own, "--spp", str(spp)], output)
                errors = [compare(base, output, p, args.metric) for p in pictures]
                runs.setdefault((name, spp), []).append((net_error(errors, between), seconds))
    return {(name, spp): {"error": statistics.fmean(e for e, _ in done),
                          "seconds": max(statistics.median(s for _, s in done) - min(start[name]), 0.01)}
            for (name, spp), done in runs.items()}


def rows(scene, sampler, measured, names, samples):
    """Lines of the table: each executable, and its ratios to the first one."""
    for spp in samples:
        base = measured[names[0], spp]
        for name in names:
            m = measured[name, spp]
            error, seconds = m["error"] / base["error"], m["seconds"] / base["seconds"]
            cells = [scene, sampler, str(spp), name, f"{m['error']:.3e}", f"{m['seconds']:.2f}"]
            ratios = [f"{error:.3f}", f"{seconds:.2f}", f"**{error * seconds:.3f}**"]
            cells += ["", "", ""] if name == names[0] else ratios
            yield "| " + " | ".join(cells) + " |"


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("commands", nargs="+", metavar="NAME=COMMAND")
    parser.add_argument("--scenes", default=",".join(DEFAULT),
                        help=f"of {', '.join(SCENES)} [default: {', '.join(DEFAULT)}]")
    parser.add_argument("--samplers", default="sobol,stratified,independent", help="[default: all three]")
    parser.add_argument("--spp", default="16,64", help="samples a pixel [default: 16,64]")
    parser.add_argument("--seeds", type=int, default=2, help="renders whose mean counts [default: 2]")
    parser.add_argument("--size", default="128x96", help="[default: 128x96]")
    parser.add_argument("--max-depth", type=int, default=5, help="[default: 5]")
    parser.add_argument("--metric", choices=["relmse", "flip", "mse", "mrse"], default="relmse",
                        help="[default: relmse]")
    parser.add_argument("--assets", type=pathlib.Path, default=SHARED,
                        help="folder that has Sponza, DamagedHelmet and env [default: ../shared/scenes]")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/light_table",
                        help="references and scenes made on demand are kept there [default: build/light_table]")
    parser.add_argument("--json", type=pathlib.Path, metavar="FILE", help="write everything measured")
    args = parser.parse_args()
    args.scenes, args.samplers = args.scenes.split(","), args.samplers.split(",")
    args.spp = [int(n) for n in args.spp.split(",")]
    if unknown := [n for n in args.scenes if n not in SCENES]:
        parser.error(f"no scene {unknown[0]}; there are {', '.join(SCENES)}")
    args.commands = [(name, shlex.split(command)) for name, _, command in (c.partition("=") for c in args.commands)]
    if bad := [name for name, command in args.commands if not command]:
        parser.error(f"{bad[0]}: write NAME=COMMAND")
    return args


def main():
    args = arguments()
    args.work.mkdir(parents=True, exist_ok=True)
    make_scenes(args.work / "scenes", args.assets)
    names = [name for name, _ in args.commands]
    metric = args.metric
    print(f"| scene | sampler | samples | executable | {metric} | user s | {metric} ratio | s ratio | product |")
    print("|" + " --- |" * 9, flush=True)
    results, products = [], {}
    for scene_name in args.scenes:
        file, flags, spp = SCENES[scene_name]
        places = {"scenes": ROOT / "scenes", "assets": args.assets, "made": args.work / "scenes"}
        scene = file.format(**places)
        if not pathlib.Path(scene).exists():
            print(f"{scene_name}: left out, there is no {scene}", file=sys.stderr)
            continue
        flags = [*flags.format(**places).split(), "--size", args.size, "--max-depth", str(args.max_depth)]
        pictures = references(args.commands[0][1], scene_name, scene, flags, spp, args.work)
        for sampler in args.samplers:
            with tempfile.TemporaryDirectory() as folder:
                measured = measure(args.commands, scene, flags, pictures, sampler, args, pathlib.Path(folder))
            print("\n".join(rows(scene_name, sampler, measured, names, args.spp)), flush=True)
            for (name, samples), m in measured.items():
                results.append({"scene": scene_name, "sampler": sampler, "executable": name, "spp": samples, **m})
                base = measured[names[0], samples]
                products.setdefault(name, []).append(m["error"] * m["seconds"] / (base["error"] * base["seconds"]))
    for name in names[1:]:
        good = [p for p in products.get(name, []) if p > 0]
        if good:
            mean = statistics.geometric_mean(good)
            print(f"\n{name}: geometric mean of {metric} x time {mean:.3f} of {names[0]}'s")
    if args.json:
        args.json.write_text(json.dumps({"size": args.size, "max_depth": args.max_depth, "metric": args.metric,
                                         "rows": results}, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Failed as error:
        sys.exit(f"light_table: error: {error}")
