#!/usr/bin/env python3
"""Scores every shadow technique on seven scenes: shadow_reports.py --assets FOLDER [--only NAME ...] [--budget S]
[--pages PAGES] [--table]

Runs `wavepath study --shadows` on each of SCENES and writes results/llvmpipe/shadows/NAME.csv, and README.md's tables
from all that are there; --table: these alone. Each page goes to PAGES/NAME/report.html. FOLDER holds the public scenes
Sponza and HotelRoom."""

import argparse
import csv
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
HERE = ROOT / "benchmarks" / "results" / "llvmpipe" / "shadows"
SCENES = {  # name: what it shows, file, what makes it, flags
    "cornell_box": ("a square lamp near two blocks", "cornell_box.gltf", None, ""),
    "sphere_lamp": ("a ball that shines in the Cornell box", "sphere_lamp.glb", "shadow_scenes.py sphere_lamp", ""),
    "sponza_sun": ("Sponza under a high sun", "Sponza/Sponza.gltf", None,
                   "--eye 4,1.8,0.2 --look-at -10,2.2,-0.3 --yfov 65 --sun 60,80 --env black"),
    "tree": ("a tree, leaves cut out by alpha, under a sun", "tree.glb", "shadow_scenes.py tree", ""),
    "room_spot": ("HotelRoom under one spot", "room_spot.glb", "shadow_scenes.py room_spot "
                                                               "HotelRoom/HotelRoom-plain.glb",
                  ""),
    "terrain": ("200,000 triangles of hills under a low sun", "terrain.glb", "terrain.py 200000",
                "--eye 0,12,45 --look-at 0,0,-10 --yfov 50 --sun 40,12 --env black"),
    "rails": ("bars of 12 mm and wires of 3 mm under a low sun", "rails.glb", "shadow_scenes.py rails", ""),
}
HEAD = ("| technique, texels | error by shadows | falsely lit | falsely dark | edges off by pixels | penumbra over the "
        "true one | ms to build | ms to look up | MiB |\n|" + " --- |" * 9)


def study(program, assets, name, budget, size, pages):
    _, file, maker, flags = SCENES[name]
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for asset in ("Sponza", "HotelRoom"):
            (folder / asset).symlink_to((assets / asset).resolve())
        if maker:
            script, *args = maker.split()
            subprocess.run([sys.executable, ROOT / "scenes" / script, *args, file], cwd=folder, check=True,
                           stdout=subprocess.DEVNULL)
        elif not (folder / file).exists():
            shutil.copy(ROOT / "scenes" / file, folder)
        environment = {k: v for k, v in os.environ.items() if k != "WAVEPATH_VALIDATION"}
        # Pages name the program.
        environment["PATH"] = f"{pathlib.Path(program).resolve().parent}:{environment['PATH']}"
        subprocess.run(["wavepath", "study", file, "--shadows", "-o", name, "--size", size, "--budget", str(budget),
                        "--reference-spp", "256",
                        *flags.split()], cwd=folder, check=True, env=environment)
        HERE.mkdir(parents=True, exist_ok=True)
        shutil.copy(folder / name / "study.csv", HERE / f"{name}.csv")
        (pages / name).mkdir(parents=True, exist_ok=True)
        shutil.copy(folder / name / "report.html", pages / name)


def table(name):
    with open(HERE / f"{name}.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    samples = max(int(row["spp"]) for row in rows)
    error = lambda row: float(row["shadow_relative_rms"])
    best = {}
    for row in rows:
        if int(row["spp"]) == samples and (row["shadows"] not in best or error(row) < error(best[row["shadows"]])):
            best[row["shadows"]] = row

    def cells(row):
        size = f", {row['shadow-size']}" if row["shadow-size"] else ""
        numbers = [f"{100 * float(row[key]):.2f} %" for key in ("shadow_relative_rms", "falsely_lit", "falsely_dark")]
        numbers += [f"{float(row[key]):.2f}" if row[key] else "-"
                    for key in ("edge_displacement_pixels", "penumbra_ratio")]
        numbers += [f"{float(row['build_ms']):.1f}", f"{float(row['look_up_ms']):.1f}",
                    f"{int(row['bytes']) / 2**20:.1f}"]
        return f"| {row['shadows']}{size} | " + " | ".join(numbers) + " |"

    return samples, [HEAD, *(cells(row) for row in sorted(best.values(), key=error))]


def write_tables():
    page = HERE / "README.md"
    text = page.read_text(encoding="utf-8")
    for name, (about, file, maker, flags) in SCENES.items():
        if not (HERE / f"{name}.csv").exists():
            continue
        samples, rows = table(name)
        command = f"wavepath study {file} --shadows {flags}".strip()
        body = "\n".join([f"<!-- {name} -->", f"## {about[0].upper()}{about[1:]}", "",
                          f"`{command}`, {samples} samples a pixel. [All sizes]({name}.csv).",
                          "", *rows, f"<!-- /{name} -->"])
        found = re.compile(rf"<!-- {name} -->.*?<!-- /{name} -->", re.S)
        text = found.sub(lambda _: body, text) if found.search(text) else f"{text.rstrip()}\n\n{body}\n"
    page.write_text(text, encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--assets", type=pathlib.Path)
    parser.add_argument("--only", nargs="*", choices=SCENES, default=list(SCENES))
    parser.add_argument("--budget", type=float, default=240)
    parser.add_argument("--size", default="192x144")
    parser.add_argument("--program", default=str(ROOT / "build" / "host" / "wavepath"))
    parser.add_argument("--pages", type=pathlib.Path, default=ROOT / "build" / "shadow_reports")
    parser.add_argument("--table", action="store_true")
    args = parser.parse_args()
    if not args.table:
        if not args.assets:
            parser.error("--assets is wanted")
        for name in args.only:
            study(args.program, args.assets, name, args.budget, args.size, args.pages)
    write_tables()


if __name__ == "__main__":
    main()
