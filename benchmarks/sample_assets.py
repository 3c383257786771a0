#!/usr/bin/env python3
"""Renders every glTF file of the sample assets of Khronos, and writes what became of each.

    git clone https://github.com/KhronosGroup/glTF-Sample-Assets
    benchmarks/sample_assets.py build/host/wavepath glTF-Sample-Assets -o docs/sample_assets.md

Each file is rendered at 32x32 with one sample a pixel, and read by `wavepath info` as it is, half a second into each of
its animations, and with each of its variants. A copy of the assets may lack files (Git LFS, limits of size): what
refers to them counts as incomplete, not as refused.
"""

import argparse
import collections
import concurrent.futures
import json
import pathlib
import re
import subprocess
import tempfile
import urllib.parse

HEAD = """# The sample assets of Khronos

**What it does.** This page tells what wavepath does with each glTF file of the
[sample assets](https://github.com/KhronosGroup/glTF-Sample-Assets) of Khronos: rendered, or refused with which message.

**When to use it.** Look here before you use one of these files to compare renderers, and to see that an extension has
been tried on a file that others have written. [extensions.md](extensions.md) explains the extensions.

```
benchmarks/sample_assets.py build/host/wavepath glTF-Sample-Assets -o docs/sample_assets.md
```

The table is the output of that script, for {count} files of {assets} assets
({copy}).
A file is rendered at 32x32 with one sample a pixel, and read at a moment of each animation and with each variant. The
remark is the first warning, without that of skipped occlusion textures. An incomplete file lacks a file that the copy
does not have.

| result | files |
| --- | --- |
{summary}

| asset | file | result | remark |
| --- | --- | --- | --- |
"""

LFS = b"version https://git-lfs"


def missing_files(file):
    """Names of what a .gltf refers to and the copy lacks."""
    if file.suffix != ".gltf":
        return ["itself"] if file.read_bytes()[:23] == LFS else []
    text = file.read_bytes()
    if text[:23] == LFS:
        return ["itself"]
    document = json.loads(text)
    missing = []
    for entry in (*document.get("buffers", []), *document.get("images", [])):
        uri = entry.get("uri", "data:")
        if uri.startswith("data:"):
            continue
        path = file.parent / urllib.parse.unquote(uri)
        if not path.is_file() or path.read_bytes()[:23] == LFS:
            missing.append(uri)
    return missing


def last_line(text):
    lines = [line for line in text.strip().splitlines() if line]
    return lines[-1] if lines else "no message"


def run(command, seconds):
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=seconds, check=False)
    except subprocess.TimeoutExpired:
        return 124, "", f"took more than {seconds} s"
    return done.returncode, done.stdout, done.stderr


def without_path(message, file):
    return re.sub(r"^wavepath: (error|warning): ", "", message).replace(str(file) + ": ", "")


def animations_of(file):
    data = file.read_bytes()
    if data[:4] == b"glTF":
        length = int.from_bytes(data[12:16], "little")
        data = data[20:20 + length]
    return len(json.loads(data).get("animations", []))


def attempt(wavepath, file, seconds):
    """(result, remark) of a file."""
    lacking = missing_files(file)
    if lacking:
        return "incomplete", f"this copy lacks {lacking[0]}"
    code, out, err = run([wavepath, "info", str(file), "--json"], seconds)
    if code != 0:
        return ("refused" if code == 1 else f"exit {code}"), without_path(last_line(err), file)
    about = json.loads(out)
    warnings = [w["text"] for w in about["warnings"] if not w["text"].startswith("occlusion texture")]
    variants = [["--variant", name] for name in about.get("variants", [])]
    moments = [["--animation", str(i), "--at", "0.5"] for i in range(animations_of(file))]
    with tempfile.TemporaryDirectory() as folder:
        small = ["--size", "32x32", "--spp", "1", "--max-depth", "4"]
        render = ["render", str(file), *small, "-q", "-o", f"{folder}/a.exr"]
        for command in (render, *(["info", str(file), *flags] for flags in (*variants, *moments))):
            code, _, err = run([wavepath, *command], seconds)
            if code != 0:
                what = "refused" if code == 1 else f"exit {code}"
                return what, " ".join([*(flag for flag in command[2:] if command[0] == "info"),
                                       without_path(last_line(err), file)])
    more = [f"{len(flags)} {what}{'s' if len(flags) > 1 else ''}"
            for flags, what in ((variants, "variant"), (moments, "animation")) if flags]
    return "rendered", "; ".join([*more, *warnings[:1]])


def table(rows, copy):
    """The page. `rows`: asset, file, result, remark."""
    counts = collections.Counter(result for _, _, result, _ in rows)
    summary = "\n".join(f"| {result} | {count} |" for result, count in sorted(counts.items()))
    head = HEAD.format(count=len(rows), assets=len({row[0] for row in rows}), copy=copy, summary=summary)
    cell = lambda text: text.replace("|", "\\|").replace("\n", " ")  # noqa: E731
    return head + "".join("| " + " | ".join(map(cell, row)) + " |\n" for row in rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("wavepath")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("-o", "--output", type=pathlib.Path)
    parser.add_argument("--copy", default="a full copy", help="what the folder holds, for the page")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=300.0, help="limit of each execution")
    arguments = parser.parse_args()
    models = arguments.folder / "Models"
    files = sorted(p for p in models.rglob("*") if p.suffix in (".gltf", ".glb") and p.is_file())
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        results = pool.map(lambda f: attempt(arguments.wavepath, f, arguments.seconds), files)
        rows = []
        for file, (result, remark) in zip(files, results):
            asset, *rest = file.relative_to(models).parts
            rows.append((asset, "/".join(rest), result, remark))
            print(f"{result:10}  {file.relative_to(models)}  {remark}", flush=True)
    if arguments.output:
        arguments.output.write_text(table(rows, arguments.copy), encoding="utf-8")
    return any(result.startswith("exit") for _, _, result, _ in rows)


if __name__ == "__main__":
    raise SystemExit(main())
