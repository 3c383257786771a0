#!/usr/bin/env python3
"""What the hybrid integrator costs and saves on real scenes: hybrid_gallery.py --assets FOLDER [-o FOLDER] [--budget
SECONDS]

Runs `wavepath study --vary integrator,denoise` on each scene, puts path-traced, hybrid and denoised pictures side by
side and writes one table of errors and milliseconds. FOLDER has Sponza, DamagedHelmet, HotelRoom, webxr-camp and env; a
scene that is not there is left out and said so. Needs python3-pil. --redraw: from the studies of the last run, in
--work."""

import argparse
import json
import pathlib
import shlex
import subprocess
import sys

from PIL import Image, ImageDraw, ImageFont

ROOT = pathlib.Path(__file__).resolve().parent.parent
SIZE = (480, 270)
# `scene`: below the assets, or in scenes/; `flags`: of `wavepath study`.
SCENES = {
    "sponza": {"scene": "Sponza/Sponza.gltf", "environment": "env/venice_sunset_1k.hdr",
               "flags": "--env-intensity 2 --eye 4,1.8,0.2 --look-at -10,2.2,-0.3 --yfov 65"},
    "damaged_helmet": {"scene": "DamagedHelmet/glTF-Binary/DamagedHelmet.glb",
                       "environment": "env/studio_small_03_1k.hdr",
                       "flags": ""},
    "hotel_room": {"scene": "HotelRoom/HotelRoom-plain.glb", "environment": "env/venice_sunset_1k.hdr",
                   "flags": "--eye 10000,1200,-6000 --look-at 10200,1100,-7000 --yfov 75"},
    "camp": {"scene": "webxr-camp/camp.gltf", "environment": "env/venice_sunset_1k.hdr", "flags": ""},
    "cornell_box": {"scene": "scenes/cornell_box.gltf", "environment": None, "flags": ""},
}
GAP, CAPTION = 6, 22  # pixels


def run_study(program, name, assets, folder, budget):
    entry = SCENES[name]
    ours = entry["scene"].startswith("scenes/")
    base = ROOT if ours else assets
    command = ["study", entry["scene"], "-o", str(folder), "--vary", "integrator,denoise", "--size",
               f"{SIZE[0]}x{SIZE[1]}",
               "--budget", str(budget), "-q", *shlex.split(entry["flags"])]
    if entry["environment"]:
        command += ["--env", entry["environment"]]
    if not (base / entry["scene"]).exists():
        return None
    subprocess.run([program, *command], cwd=base, check=True)
    command[3] = name  # where it is written is of no interest to who repeats it
    return shlex.join(["wavepath", *command])


def percent(metrics):
    return f"{100.0 * metrics['relative_rms']:.3g} %" if metrics else "-"


def captioned(study, folder):
    """The study's pictures as one, with a line above each."""
    shown = [("path, reference", study["reference"]["picture"])]
    for configuration in study["configurations"]:
        if configuration["flags"]["integrator"] == "hybrid" and configuration["picture"]:
            last = configuration["points"][-1]
            shown.append((f"{configuration['name']}: {percent(last['full'])}, {last['ms_per_frame']:.0f} ms a frame",
                          configuration["picture"]["file"]))
    shown.append(("ambient occlusion", study["ao_reference"]["picture"]))
    width, height = study["size"]
    columns = 2
    rows = (len(shown) + columns - 1) // columns
    sheet = Image.new("RGB", (columns * width + (columns - 1) * GAP, rows * (height + CAPTION)), "white")
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default()
    for i, (text, file) in enumerate(shown):
        x, y = (i % columns) * (width + GAP), (i // columns) * (height + CAPTION)
        draw.text((x + 2, y + 5), text, fill="black", font=font)
        sheet.paste(Image.open(folder / file).convert("RGB"), (x, y + CAPTION))
    return sheet


def table(studies):
    lines = ["| scene | configuration | ms a frame | frames | direct light | occlusion | full picture | levels off at "
             "|",
             "| --- | --- | --- | --- | --- | --- | --- | --- |"]
    for name, (study, _) in studies.items():
        for c in study["configurations"]:
            last = c["points"][-1]
            level = f"{100.0 * c['levels_off']:.3g} %" if c["levels_off"] is not None else "-"
            lines.append(f"| {name} | {c['name']} | {last['ms_per_frame']:.1f} | {last['spp']} | "
                         f"{percent(last['direct'])} | {percent(last['ao'])} | {percent(last['full'])} | {level} |")
    return "\n".join(lines)


def first_frames(studies):
    lines = ["| scene | configuration | direct light | occlusion | full picture |", "| --- | --- | --- | --- | --- |"]
    for name, (study, _) in studies.items():
        for c in study["configurations"]:
            first = c["points"][0]
            lines.append(f"| {name} | {c['name']} | {percent(first['direct'])} | {percent(first['ao'])} | "
                         f"{percent(first['full'])} |")
    return "\n".join(lines)


def first_hits(studies):
    lines = ["| scene | rasterized and resolved, ms | traced, ms |", "| --- | --- | --- |"]
    for name, (study, _) in studies.items():
        hits = study["first_hits"]
        lines.append(f"| {name} | {hits['rasterized_ms']:.2f} | {hits['traced_ms']:.2f} |")
    return "\n".join(lines)


def readme(studies):
    device = next(iter(studies.values()))[0]["device"]
    pictures = "\n\n".join(f"## {name}\n\n![{name}]({name}.png)\n\n`{command}`"
                           for name, (_, command) in studies.items())
    return f"""# Hybrid rendering against path tracing

{SIZE[0]}x{SIZE[1]} on {device['name']} ({device['driver']}). Made by `benchmarks/hybrid_gallery.py`, which runs the
commands below. Errors are relative RMS (the root of relMSE): direct light and the full picture against a path-traced
reference, occlusion against a reference of its own. A frame is one sample of every pixel; milliseconds are of rendering
alone. "levels off": the error that no number of frames takes away. {len(studies)} scenes.

{table(studies)}

After a single frame, as a window shows it while the camera moves:

{first_frames(studies)}

What the first surface of every pixel costs, a frame:

{first_hits(studies)}

{pictures}
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--assets", type=pathlib.Path, required=True)
    parser.add_argument("-o", "--output", type=pathlib.Path, default=ROOT / "benchmarks/results/llvmpipe/hybrid")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/hybrid_gallery")
    parser.add_argument("--program", default=str(ROOT / "build/host/wavepath"))
    parser.add_argument("--budget", type=float, default=90.0)
    parser.add_argument("--redraw", action="store_true")
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    arguments.work.mkdir(parents=True, exist_ok=True)
    studies = {}
    for name in SCENES:
        folder, record = arguments.work.resolve() / name, arguments.work / f"{name}.txt"
        if not arguments.redraw:
            command = run_study(str(pathlib.Path(arguments.program).resolve()), name, arguments.assets, folder,
                                arguments.budget)
            if command is None:
                print(f"{name}: {SCENES[name]['scene']} is not in {arguments.assets}", file=sys.stderr)
                continue
            record.write_text(command)
        if not record.exists():
            continue
        studies[name] = (json.loads((folder / "study.json").read_text(encoding="utf-8")), record.read_text())
        sheet = captioned(studies[name][0], folder).quantize(256, dither=Image.Dither.FLOYDSTEINBERG)
        sheet.save(arguments.output / f"{name}.png", optimize=True)
    (arguments.output / "README.md").write_text(readme(studies), encoding="utf-8")


if __name__ == "__main__":
    main()
