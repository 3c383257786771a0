"""Scenes that are too large to commit, made by scenes/*.py when a benchmark needs them."""

import pathlib
import subprocess
import sys

SCENES = pathlib.Path(__file__).resolve().parent.parent / "scenes"


def make_scenes(folder, assets=None):
    """Those of which the sources are there; what is there already stays."""
    folder.mkdir(parents=True, exist_ok=True)
    makers = {"many_lights.glb": ["many_lights.py"]}
    sponza = assets / "Sponza/Sponza.gltf" if assets else None
    if sponza and sponza.exists():
        makers["sponza_lamp.glb"] = ["sponza_lamp.py", sponza]
    for name, (script, *sources) in makers.items():
        if not (folder / name).exists():
            subprocess.run([sys.executable, "-B", SCENES / script, *sources, folder / name], check=True,
                           stdout=subprocess.DEVNULL)
    return folder
