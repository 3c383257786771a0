#!/usr/bin/env python3
"""Adds the figures of a measurement to the history of a device: history.py DOCUMENT... [--device NAME]

DOCUMENT is what `peer_cycles.py --json`, `wavepath bench --json`, `scaling.py --json` or `wavepath render --stats`
wrote; of bench and render the file's name tells the scene. Each figure becomes a row of results/NAME/history.csv:
metric, commit, date, value. A figure that did not change adds none."""

import argparse
import csv
import datetime
import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
COLUMNS = ["metric", "commit", "date", "value"]


def figures(document, scene):
    """The figures of a document, as pairs of metric and value. The metric is a path: what was measured, where, which
    figure. `scene`: the name of what `bench` and `render` measured one of."""
    if "scenes" in document:
        yield from peers(document)
    elif "path_tracing" in document:
        yield from bench(document, scene)
    elif "paths" in document and "triangles" in document:
        yield from scaling(document)
    elif "mrays_per_second" in document:
        where = f"render/{scene}/{size(document)}"
        yield f"{where}/seconds", document["seconds"]["render"]
        yield f"{where}/mrays_per_second", document["mrays_per_second"]
    else:
        raise ValueError("neither of peer_cycles.py, bench, scaling.py nor of render")


def scene_of(path):
    """bench-sponza.json is of sponza."""
    return re.sub("^bench[-_]", "", path.stem).replace("-", "_")


def size(document):
    return "x".join(str(n) for n in document["size"])


def peers(document):
    """`by_slope`: the error lies past the last render."""
    for name, scene in document["scenes"].items():
        flags = scene.get("flags", "")
        where = f"peers/{name}/{size(document)}" + (f" {flags}" if flags else "")
        for renderer, measured in scene["renderers"].items():
            for target, to in measured["seconds_to"].items():
                yield f"{where}/{renderer}/seconds_to_{target}{'' if to['measured'] else '_by_slope'}", to["seconds"]
        for target, ratio in scene["ratio"].items():
            yield f"{where}/ratio/seconds_to_{target}", ratio
        equal = scene.get("equal_spp")
        if equal:
            yield f"{where}/ratio/seconds_at_{equal['spp']}_spp", equal["seconds_ratio"]
            yield f"{where}/ratio/relmse_at_{equal['spp']}_spp", equal["relmse_ratio"]


def bench(document, scene):
    where = f"bench/{scene}/{size(document)}"
    for kind, rays in document["rays"].items():
        yield f"{where}/{kind}/mrays_per_second", rays["mrays_per_second"]
        embree = (document.get("embree") or {}).get(kind)
        if embree:
            yield f"{where}/{kind}/over_embree", embree["ratio"]
    yield f"{where}/path_tracing/mrays_per_second", document["path_tracing"]["mrays_per_second"]


def scaling(document):
    samples = document["samples"]
    yield "scaling/samples/exponent_of_processor_seconds_deviates_by", samples["deviation_processor_seconds"]
    yield "scaling/pixels/exponent_of_processor_seconds_deviates_by", document["pixels"]["deviation_processor_seconds"]
    yield "scaling/paths/bytes_per_path", document["paths"]["bytes_per_path"]


def add(rows, measured, commit, date):
    """Rows with those of a measurement at their end, to four digits; a metric's last value is not repeated."""
    last = {row["metric"]: row["value"] for row in rows}
    new = [{"metric": metric, "commit": commit, "date": date, "value": f"{value:.4g}"} for metric, value in measured]
    return rows + [row for row in new if last.get(row["metric"]) != row["value"]]


def read(path):
    if not path.exists():
        return []
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def write(path, rows):
    with open(path, "w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("documents", nargs="+", type=pathlib.Path, metavar="DOCUMENT")
    parser.add_argument("--device", default="llvmpipe", help="folder below benchmarks/results [default: llvmpipe]")
    parser.add_argument("--commit", help="what was measured [default: what is checked out]")
    parser.add_argument("--date", default=datetime.date.today().isoformat(), help="[default: today]")
    args = parser.parse_args()
    commit = args.commit or subprocess.run(["git", "-C", ROOT, "rev-parse", "--short=8", "HEAD"], check=True, text=True,
                                           capture_output=True).stdout.strip()
    history = ROOT / "benchmarks" / "results" / args.device / "history.csv"
    rows = read(history)
    for path in args.documents:
        try:
            measured = list(figures(json.loads(path.read_text(encoding="utf-8")), scene_of(path)))
        except (ValueError, KeyError) as error:
            sys.exit(f"history: error: {path}: cannot be told apart by its keys ({error}); name a document with "
                     f"figures")
        rows = add(rows, measured, commit, args.date)
    write(history, rows)


if __name__ == "__main__":
    main()
