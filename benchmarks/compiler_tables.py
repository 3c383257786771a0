#!/usr/bin/env python3
"""What compilers of GPUs make of the kernels, without a GPU:
compiler_tables.py --program WAVEPATH [--check] [--only NAME ...] [--shims FOLDER]

Runs `wavepath bench --kernels` on drivers that compile for a GPU which is not there, and writes
results/compilers/NAME.csv. --check compares with these tables instead: exit code 1 if a kernel takes more registers,
more bytes of spills or scratch memory, or has fewer waves at a time than its table says. A driver that is not
installed, or of another version than its table was made with, is left out with a message. NVIDIA's and Intel's (NVK,
ANV) want a kernel driver to talk to: FOLDER holds Mesa's stand-ins for these; README.md there tells how to make
them."""

import argparse
import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
TABLES = ROOT / "benchmarks" / "results" / "compilers"
ICDS = pathlib.Path("/usr/share/vulkan/icd.d")
NVK_SHIM, ANV_SHIM = "libnouveau_noop_drm_shim.so", "libintel_noop_drm_shim.so"
NVK_WANTED = {"NVK_I_WANT_A_BROKEN_VULKAN_DRIVER": "1"}  # it refuses GPUs that it was not tested on
DRIVERS = {  # driver, stand-in for its kernel driver, and Mesa's own names of what it poses as
    "radv-navi21": ("radeon", None, {"RADV_FORCE_FAMILY": "navi21"}),
    "radv-navi31": ("radeon", None, {"RADV_FORCE_FAMILY": "gfx1100"}),
    "nvk-sm86": ("nouveau", NVK_SHIM, {"NOUVEAU_CHIPSET": "172", **NVK_WANTED}),  # GA102
    "anv-dg2": ("intel", ANV_SHIM, {"INTEL_STUB_GPU_PLATFORM": "dg2"}),  # Arc A
    "anv-bmg": ("intel", ANV_SHIM, {"INTEL_STUB_GPU_PLATFORM": "bmg"}),  # Battlemage
}
SCENES = ["showcase.glb"]  # which has most of what materials and lights can be
# Names of drivers, and whether more is worse (1), better (-1) or neither (0).
COLUMNS = {
    "Subgroup size": -1,
    "SGPRs": 1, "VGPRs": 1, "Spilled SGPRs": 1, "Spilled VGPRs": 1, "Scratch size": 1, "Subgroups per SIMD": -1,
    "Code size": 0, "Instructions": 0, "Latency": 0, "Inverse Throughput": 0,  # RADV
    "Number of GPRs": 1, "SLM Size": 1, "Code Size": 0, "Instruction count": 0,  # NVK
    "Spill Count": 1, "Fill Count": 1, "Scratch Memory Size": 1, "Max live registers": 0, "Instruction Count": 0,
    "Cycle Count": 0,  # ANV
}
KEY = ["scene", "configuration", "kernel"]


def environment_of(driver, shims):
    """(environment, None), or (None, why not)."""
    name, shim, posing = DRIVERS[driver]
    icd = next(ICDS.glob(f"{name}_icd*.json"), None)
    if icd is None:
        return None, f"{name}_icd.json is not installed"
    if shim and not (shims and (shims / shim).exists()):
        return None, f"{shim} is not in {shims}" if shims else f"{shim} is wanted: --shims"
    environment = {**os.environ, "VK_DRIVER_FILES": str(icd), "VK_ICD_FILENAMES": str(icd), **posing}
    environment.pop("WAVEPATH_EMULATE", None)
    if shim:
        environment["LD_PRELOAD"] = str((shims / shim).resolve())
    return environment, None


def compiled(program, driver, shims, scene):
    """(device, rows), or (None, why not)."""
    environment, missing = environment_of(driver, shims)
    if missing:
        return None, missing
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "kernels.json"
        run = subprocess.run([program, "bench", ROOT / "scenes" / scene, "--kernels", "--json", file, "--quiet"],
                             env=environment, capture_output=True, text=True)
        if run.returncode != 0:
            return None, run.stderr.strip()
        rows = [{"scene": scene, "configuration": entry["configuration"], "kernel": entry["kernel"],
                 **{name: entry["statistics"][name] for name in COLUMNS if name in entry["statistics"]}}
                for entry in json.loads(file.read_text())]
        return run.stdout.splitlines()[0], rows


def read_table(driver):
    with open(TABLES / f"{driver}.csv", encoding="utf-8", newline="") as file:
        device = file.readline().removeprefix("# ").strip()
        return device, list(csv.DictReader(file))


def write_table(driver, device, rows):
    TABLES.mkdir(parents=True, exist_ok=True)
    with open(TABLES / f"{driver}.csv", "w", encoding="utf-8", newline="") as file:
        file.write(f"# {device}\n")
        writer = csv.DictWriter(file, KEY + [name for name in COLUMNS if name in rows[0]], lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def worse(rows, table):
    """Lines on what is worse than in the table, and on kernels that one of the two lacks."""
    key = lambda row: tuple(row[name] for name in KEY)
    known = {key(row): row for row in table}
    lines = [f"{', '.join(key(row))}: is not in the table" for row in rows if key(row) not in known]
    lines += [f"{', '.join(missing)}: is in the table alone" for missing in known.keys() - {key(row) for row in rows}]
    for row in rows:
        for name, direction in COLUMNS.items():
            if key(row) not in known or name not in row:
                continue
            if direction * (float(row[name]) - float(known[key(row)][name])) <= 0:
                continue
            lines.append(f"{', '.join(key(row))}: {name} {known[key(row)][name]} -> {row[name]}")
    return sorted(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "build" / "host" / "wavepath"))
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--only", nargs="*", choices=DRIVERS, default=list(DRIVERS))
    parser.add_argument("--shims", metavar="FOLDER", type=pathlib.Path)
    args = parser.parse_args()
    failed, compared = False, 0
    for driver in args.only:
        device, rows = None, []
        for scene in SCENES:
            device, found = compiled(args.program, driver, args.shims, scene)
            if device is None:
                print(f"{driver}: left out: {found}")
                break
            rows += found
        if device is None:
            continue
        if not args.check:
            write_table(driver, device, rows)
            print(f"{driver}: {len(rows)} kernels")
            continue
        known, table = read_table(driver)
        if device != known:
            print(f"{driver}: left out: the table is of {known}, and here is {device}")
            continue
        compared += 1
        for line in worse(rows, table):
            failed = True
            print(f"{driver}: {line}")
    if failed:
        sys.exit("worse than benchmarks/results/compilers: mend it, or write the tables anew and say why in the commit")
    if args.check and compared == 0:
        print("no driver to compare with: skipped")


if __name__ == "__main__":
    main()
