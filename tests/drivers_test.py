#!/usr/bin/env python3
"""That another driver renders the same pictures and passes the selftest: SwiftShader, where a browser has brought it.
Its subgroups are of 4, and its texel buffers hold 65,536 elements, so that kernels read scenes from storage blocks
there. WAVEPATH_DRIVERS=all runs the whole selftest, which takes minutes.
Usage: drivers_test.py WAVEPATH SCENES [SHARED_SCENES]"""

import os
import pathlib
import subprocess
import sys
import tempfile

MANIFESTS = ["/usr/lib/chromium/vk_swiftshader_icd.json", "/opt/google/chrome/vk_swiftshader_icd.json"]
SIZE = ["--size", "96x64", "--spp", "4", "--seed", "3"]
SPONZA = ["--env", "1,1,1", "--eye", "4,1.8,0.2", "--look-at", "-10,2.2,-0.3", "--yfov", "65"]
# Both have the samples of the same paths, but for the few that rounding sends elsewhere. Half of the samples would
# differ by 100 times as much.
MOST = "relmse=2e-3"
# Of the selftest, one case of each kind of kernel, and those that have failed here.
CASES = ["rays from inside", "rays that are not numbers", "trees that grow deep", "precise arithmetic", "samples near",
         "texture coordinates", "furnace, Lambert", "glass slab", "light 1 um"]


def main():
    program, scenes = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    shared = pathlib.Path(sys.argv[3]) if len(sys.argv) > 3 else None
    manifest = next((path for path in MANIFESTS if os.path.exists(path)), None)
    if not manifest:
        print("no SwiftShader here: the test is skipped")
        return 0
    plain = {key: value for key, value in os.environ.items() if key not in ("WAVEPATH_EMULATE", "WAVEPATH_DEVICE")}
    other = plain | {"VK_DRIVER_FILES": manifest}
    failed = 0

    def run(environment, *flags):
        done = subprocess.run([program, *flags], env=environment, capture_output=True, text=True)
        if done.returncode or "validation:" in done.stderr:
            print(f"FAIL {' '.join(map(str, flags))}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
        return done.returncode == 0 and "validation:" not in done.stderr

    info = subprocess.run([program, "info"], env=other, capture_output=True, text=True).stdout
    if "SwiftShader" not in info:
        print(f"FAIL {manifest} is no SwiftShader:\n{info}")
        return 1
    integrators = ("path", "bidirectional", "hybrid", "whitted")
    cases = [(scenes / "cornell_box.gltf", [], integrators), (scenes / "showcase.glb", [], ("path",))]
    if shared and (shared / "Sponza/Sponza.gltf").exists():
        cases.append((shared / "Sponza/Sponza.gltf", SPONZA, integrators))
    with tempfile.TemporaryDirectory() as folder:
        for scene, view, chosen in cases:
            for integrator in chosen:
                pictures = [f"{folder}/{name}.exr" for name in ("other", "plain")]
                good = all(run(environment, "render", scene, *view, *SIZE, "--integrator", integrator, "-q", "-o",
                               picture)
                           for environment, picture in zip((other, plain), pictures))
                good = good and run(plain, "compare", *pictures, "--max", MOST)
                print(f"{'ok  ' if good else 'FAIL'} {scene.name} {integrator}")
                failed += not good
    chosen = [] if os.environ.get("WAVEPATH_DRIVERS") == "all" else [flag for case in CASES
                                                                     for flag in ("--only", case)]
    good = run(other, "selftest", *chosen)
    print(f"{'ok  ' if good else 'FAIL'} selftest")
    return 1 if failed or not good else 0


sys.exit(main())
