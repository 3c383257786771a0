#!/usr/bin/env python3
"""Eight pictures of 1280x720: gallery.py --assets FOLDER [--only NAME ...] [--seconds S] [--program wavepath]

Renders each of PICTURES for S seconds, filtered (--denoise), to results/gallery/NAME.jpg, and writes their table,
results/gallery/README.md: command, seconds, samples, and the error that was left before the filter. FOLDER holds the
public scenes that are named ASSETS/...; the others are of this repository."""

import argparse
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
HERE = ROOT / "benchmarks" / "results" / "gallery"
PICTURES = {  # name: what it shows, file, flags
    "gems": ("cut stones that disperse light", "scenes/gems.glb", ""),
    "materials": ("car paint, velvet, a soap film, brushed steel, tempered titanium, paper, rough gold, crystal",
                  "scenes/materials.glb", ""),
    "showcase": ("glass, metals and ceramics under a soft box", "scenes/showcase.glb", ""),
    "toy_car": ("coated paint and cloth", "ASSETS/ToyCar/glTF/ToyCar.gltf", "--env studio --ground"),
    "hotel_room": ("a room lit through its windows", "ASSETS/HotelRoom/HotelRoom-plain.glb", ""),
    "water_bottle": ("a product on the ground", "ASSETS/WaterBottle/glTF/WaterBottle.gltf", "--ground"),
    "sponza": ("depth of field", "ASSETS/Sponza/Sponza.gltf",
               "--env sky --eye 4,1.8,0.2 --look-at -10,2.2,-0.3 --yfov 55 --aperture 0.12 --focus 4"),
    "suzanne": ("a film of oil", "ASSETS/IridescenceSuzanne/glTF-Binary/IridescenceSuzanne.glb", "--env studio"),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--assets", required=True, type=pathlib.Path)
    parser.add_argument("--only", nargs="*", choices=PICTURES, default=list(PICTURES))
    parser.add_argument("--seconds", type=float, default=90)
    parser.add_argument("--program", default=str(ROOT / "build" / "host" / "wavepath"))
    args = parser.parse_args()
    HERE.mkdir(parents=True, exist_ok=True)
    table = HERE / "README.md"
    earlier = table.read_text(encoding="utf-8") if table.exists() else ""
    rows = {match[1]: match[0] for match in re.finditer(r"(?m)^\| !\[(\w+)\].*$", earlier)}
    device = ""
    for name in args.only:
        about, scene, flags = PICTURES[name]
        flags += f" --size 1280x720 --time {args.seconds:g} --denoise"
        file = ROOT / scene if not scene.startswith("ASSETS/") else args.assets / scene[len("ASSETS/"):]
        done = subprocess.run([args.program, "render", str(file), *flags.split(), "-o", str(HERE / f"{name}.jpg"),
                               "-v"],
                              capture_output=True, text=True, check=False)
        if done.returncode:
            sys.exit(done.stderr)
        found = re.search(r"(\d+) spp in ([\d.]+) s, .*?estimated error ([\d.]+) %", done.stderr)
        device = re.search(r"(?m)^  device\s+(.*)$", done.stderr)[1]
        rows[name] = (f"| ![{name}]({name}.jpg) | {about} | `./run render {scene} {' '.join(flags.split())} -o "
                      f"{name}.jpg` | {found[2]} | {found[1]} | {found[3]} % |")
        print(name, found[2], "s", found[1], "spp", found[3], "%", flush=True)
    lines = ["# Gallery", "",
             f"Made by `benchmarks/gallery.py` on {device}. The error is that of the unfiltered picture, as estimated.",
             "ASSETS are public scenes, each with its licence beside it: Khronos' glTF sample assets, and what they "
             "name.", "",
             "| picture | what | command | seconds | samples a pixel | error |",
             "| --- | --- | --- | --- | --- | --- |"]
    lines += [rows[name] for name in PICTURES if name in rows]
    table.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
