#!/usr/bin/env python3
"""What assets look like at first sight: contact_sheet.py --assets FOLDER [-o FILE.png] [--program wavepath]

Renders each asset as `wavepath render ASSET --size 320x240 --spp 64 -o TILE.png`, without any other flag, and puts the
pictures on one sheet, each with its name, the seconds it took and the light and exposure that were chosen. What cannot
be rendered says why. FOLDER holds the scenes of ASSETS below. Needs openimageio-tools (oiiotool) and
fonts-dejavu-core."""

import argparse
import pathlib
import re
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
SIZE = (320, 240)
COLUMNS, CAPTION, GAP = 6, 38, 4  # tiles; pixels
FONT = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"
ASSETS = [
    "DamagedHelmet/glTF-Binary/DamagedHelmet.glb", "FlightHelmet/FlightHelmet.gltf", "ToyCar/glTF/ToyCar.gltf",
    "WaterBottle/glTF/WaterBottle.gltf", "StanfordDragon/dragon-plain.glb",
    "IridescenceSuzanne/glTF-Binary/IridescenceSuzanne.glb",
    "ClearCoatTest/glTF-Binary/ClearCoatTest.glb", "TransmissionTest/glTF-Binary/TransmissionTest.glb",
    "AttenuationTest/glTF-Binary/AttenuationTest.glb", "SpecularTest/glTF-Binary/SpecularTest.glb",
    "MetalRoughSpheresNoTextures/glTF-Binary/MetalRoughSpheresNoTextures.glb",
    "EmissiveStrengthTest/glTF-Binary/EmissiveStrengthTest.glb",
    "HotelRoom/HotelRoom-plain.glb", "Sponza/Sponza.gltf", "webxr-home-theater/home-theater.gltf",
    "webxr-camp/camp.gltf",
    "CornellBox-babylon/cornellBox.glb", "CornellBox-bevy/CornellBox.glb", "CornellBox-kajiya/scene.gltf",
    "LightsPunctualLamp/glTF/LightsPunctualLamp.gltf", "LightsPunctualBasic/gltf_KHR_lights_punctual_test.glb",
    "AlphaBlendModeTest/glTF-Binary/AlphaBlendModeTest.glb", "NormalTangentTest/glTF-Binary/NormalTangentTest.glb",
    "NegativeScaleTest/glTF-Binary/NegativeScaleTest.glb", "OrientationTest/glTF-Binary/OrientationTest.glb",
    "SimpleInstancing/glTF-Binary/SimpleInstancing.glb", "MorphPrimitivesTest/glTF-Binary/MorphPrimitivesTest.glb",
    "TextureSettingsTest/glTF-Binary/TextureSettingsTest.glb", "VertexColorTest/glTF-Binary/VertexColorTest.glb",
    "BoxVertexColors/glTF-Binary/BoxVertexColors.glb",
]


def choices(stderr):
    """The words of wavepath that say what it chose: light and exposure."""
    light = re.search(r"light: (?:--env (\w+)|(as authored|a lamp))", stderr)
    exposure = re.search(r"\(exposure ([+-][\d.]+)\)", stderr)
    return (light.group(1) or light.group(2) if light else "?", exposure.group(1) if exposure else "?")


def refusal(stderr):
    """What is wrong, in a line, without the file's name."""
    line = stderr.strip().splitlines()[-1] if stderr.strip() else "no message"
    return line.removeprefix("wavepath: error: ").split(": ", 1)[-1]


def render(program, scene, tile):
    start = time.monotonic()
    command = [program, "render", str(scene), "--size", f"{SIZE[0]}x{SIZE[1]}", "--spp", "64", "-o", str(tile)]
    result = subprocess.run(command, capture_output=True, text=True, errors="replace")
    if result.returncode != 0:
        return None, refusal(result.stderr)
    light, exposure = choices(result.stderr)
    return tile, f"{time.monotonic() - start:.1f} s, {light}, {exposure} EV"


def captioned(picture, name, words, out):
    """The picture above two lines of text."""
    width, height = SIZE
    blank = ["--pattern", "constant:color=0.01,0.01,0.01", f"{width}x{height + CAPTION}", "3"]
    layers = [str(picture), "--ch", "R,G,B", *blank, "--paste", "+0+0"] if picture else blank
    text = [f"--text:x=6:y={height + 15}:size=14:font={FONT}:color=0.8,0.8,0.8", name,
            f"--text:x=6:y={height + 31}:size=12:font={FONT}:color=0.4,0.4,0.4", words[:52]]
    subprocess.run(["oiiotool", *layers, *text, "-d", "uint8", "-o", str(out)], check=True, stdout=subprocess.DEVNULL)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--assets", type=pathlib.Path, required=True)
    parser.add_argument("-o", "--output", type=pathlib.Path, default=ROOT / "benchmarks/results/contact_sheet.jpg")
    parser.add_argument("--program", default=str(ROOT / "build/host/wavepath"))
    parser.add_argument("--only", default="", help="assets whose path holds this text")
    args = parser.parse_args()
    tiles = []
    with tempfile.TemporaryDirectory() as folder:
        for i, asset in enumerate(a for a in ASSETS if args.only in a):
            scene = args.assets / asset
            name = pathlib.Path(asset).parts[0]
            picture, words = (render(args.program, scene, pathlib.Path(folder) / f"{i}.png") if scene.exists()
                              else (None, "is not there"))
            print(f"{name}: {words}", file=sys.stderr, flush=True)
            tiles.append(pathlib.Path(folder) / f"tile{i}.png")
            captioned(picture, name, words, tiles[-1])
        rows = (len(tiles) + COLUMNS - 1) // COLUMNS
        subprocess.run(["oiiotool", *map(str, tiles), f"--mosaic:pad={GAP}", f"{min(COLUMNS, len(tiles))}x{rows}", "-d",
                        "uint8",
                        "--compression", "jpeg:92", "-o", str(args.output)], check=True)


if __name__ == "__main__":
    main()
