#!/usr/bin/env python3
"""Writes the scenes of this folder; `--check` compares instead, and fails if a file differs."""

import json
import pathlib
import sys

import analytic
import analytic_surfaces
import caustic_pictures
import caustics
import materials
import pictures
import rooms
import showcase

HERE = pathlib.Path(__file__).resolve().parent


def files():
    """Path relative to this folder -> bytes."""
    for build in (pictures.cornell_box, pictures.furnace_lambert, pictures.furnace_glass, pictures.furnace_metal):
        yield f"{build.__name__}.gltf", build().text()
    yield "showcase.glb", showcase.showcase().binary()
    for build in (materials.materials, materials.gems):
        yield f"{build.__name__}.glb", build().binary()
    for name, scene in [*analytic.scenes(), *analytic_surfaces.scenes()]:
        yield f"analytic/{name}.gltf", scene.text()
    for build in (rooms.slit_room, rooms.door_ajar, rooms.glazed_room, rooms.hundred_lights):
        yield f"rooms/{build.__name__}.glb", build().binary()
    answers = {}
    for name, scene in caustics.scenes():
        answers[name] = scene.answer
        yield f"caustics/{name}.glb", scene.binary()
    for name, scene in caustic_pictures.scenes():
        yield f"caustics/{name}.glb", scene.binary()
    yield "caustics/expected.json", (json.dumps(answers, indent=1) + "\n").encode()


def main():
    check = sys.argv[1:] == ["--check"]
    if sys.argv[1:] and not check:
        sys.exit("usage: generate.py [--check]")
    wanted = dict(files())
    stale = []
    for name, data in wanted.items():
        path = HERE / name
        if path.exists() and path.read_bytes() == data:
            continue
        stale.append(name)
        if not check:
            path.parent.mkdir(exist_ok=True)
            path.write_bytes(data)
    strays = [str(p.relative_to(HERE)) for p in sorted(HERE.rglob("*.gl*")) if p.suffix in (".gltf", ".glb")
              and str(p.relative_to(HERE)) not in wanted]
    for name in stale:
        print(f"{'differs from generate.py' if check else 'written'}: {name}")
    for name in strays:
        print(f"not made by generate.py: {name}")
    sys.exit(1 if strays or (check and stale) else 0)


if __name__ == "__main__":
    main()
