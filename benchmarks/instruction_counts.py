#!/usr/bin/env python3
"""Instructions of the path tracer's kernels as scenes have them, in two source trees: instruction_counts.py OLD NEW

SPIR-V is specialized for a scene's features and optimized by spirv-opt (Debian: spirv-tools), which folds away what the
scene does not use, as drivers do; counted is what is left inside functions. No device, no clock: the same on any
machine."""

import pathlib
import re
import subprocess
import sys
import tempfile

KERNELS = ["generate", "extend", "shade", "connect", "accumulate"]
# kFeature bits of kernels/base/features.h that packing a scene sets.
SCENES = {
    "Cornell box": ["Cull", "Emission", "TriangleLights"],
    "Sponza, lat-long environment": ["Alpha", "Cull", "Textures", "NormalMaps", "SmoothNormals", "Specular",
                                     "Environment",
                                     "EnvironmentMap", "BaseColorTextures", "MetallicRoughnessTextures"],
}
STACK = 62  # entries
OTHERS = {"StackSize": STACK, "Sampler": 2, "Stack": 1, "Filter": 2, "Nets": 1}


def numbers(tree, prefix):
    text = next((tree / "kernels").rglob("features.h")).read_text() # older trees have it one folder further up
    bits = {k: 1 << int(v) for k, v in re.findall(rf"{prefix}(\w+)\s*=\s*1u << (\d+)", text)}
    return bits or {k: int(v) for k, v in re.findall(rf"{prefix}(\w+) = (\d+)u", text)}


def count(tree, kernel, features):
    constants = {place: 0 for place in numbers(tree, "kSpec").values()}
    names = numbers(tree, "kSpec")
    constants.pop(names["Count"], None)
    bits = numbers(tree, "kFeature")
    constants[names["Features"]] = sum(bits[name] for name in features)
    for name, value in OTHERS.items():
        constants[names[name]] = value
    with tempfile.TemporaryDirectory() as folder:
        plain, small = f"{folder}/plain.spv", f"{folder}/small.spv"
        subprocess.run(["glslangValidator", "-V", "--quiet", "--target-env", "vulkan1.3", f"-I{tree}", "-o", plain,
                        tree / f"kernels/path/{kernel}.comp"], check=True, stdout=subprocess.DEVNULL)
        values = " ".join(f"{place}:{value}" for place, value in sorted(constants.items()))
        subprocess.run(["spirv-opt", f"--set-spec-const-default-value={values}", "--freeze-spec-const",
                        "--fold-spec-const-op-composite", "-O", "-O", plain, "-o", small], check=True)
        text = subprocess.run(["spirv-dis", "--no-color", small], check=True, capture_output=True, text=True).stdout
    inside, total = False, 0
    for line in text.splitlines():
        inside |= " OpFunction " in line
        inside &= "OpFunctionEnd" not in line
        total += inside and not re.search(r"OpLabel|OpFunction|OpSelectionMerge|OpLoopMerge|OpVariable", line)
    return total


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: instruction_counts.py OLD_TREE NEW_TREE")
    old, new = map(pathlib.Path, sys.argv[1:])
    print("| scene | kernel | old | new | ratio |\n| --- | --- | --- | --- | --- |")
    for scene, features in SCENES.items():
        for kernel in KERNELS:
            before, after = count(old, kernel, features), count(new, kernel, features)
            print(f"| {scene} | {kernel} | {before} | {after} | {after / before:.3f} |")


if __name__ == "__main__":
    main()
