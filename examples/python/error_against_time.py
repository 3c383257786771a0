#!/usr/bin/env python3
"""The error of three integrators against seconds, with its 95 % interval, as lines and bands.

    ./run python examples/python/error_against_time.py SCENE FIGURE.png [SECONDS]

Its cells (# %%) are those of a notebook."""

# %% Render: each integrator gets the same seconds; the scene stays on the device.
import sys

import matplotlib
import numpy as np
import wavepath

file, figure = sys.argv[1], sys.argv[2]
seconds = float(sys.argv[3]) if len(sys.argv) > 3 else 4.0
scene = wavepath.Scene(file, size=(160, 120))
results = {name: scene.render(integrator=name, time=seconds) for name in ("path", "bidirectional", "whitted")}

# %% Checkpoints are at powers of two of the samples; each has an estimate of the error and its interval.
curves = {}
for name, result in results.items():
    points = [c for c in result.stats["checkpoints"] if c["estimated_relative_rms"]]
    curves[name] = np.array([(c["seconds"], c["estimated_relative_rms"]) for c in points])
    last, (low, high) = result.stats["error"]["relative_rms"], result.stats["error"]["ci95"]
    print(f"{name:14} {result.spp:6} spp, error {100 * last:.2f} % ({100 * low:.2f} to {100 * high:.2f})")

# %% Plot.
matplotlib.use("agg")
import matplotlib.pyplot as plt  # noqa: E402

axes = plt.figure(figsize=(6, 4), layout="constrained").gca()
for name, curve in curves.items():
    low, high = np.array(results[name].stats["error"]["ci95"]) / curve[-1, 1]
    (line,) = axes.loglog(*curve.T, "o-", label=name, markersize=3)
    axes.fill_between(curve[:, 0], low * curve[:, 1], high * curve[:, 1], color=line.get_color(), alpha=0.2)
axes.set(xlabel="seconds of rendering", ylabel="estimated relative RMS error")
axes.grid(True, which="both", alpha=0.3)
axes.legend()
axes.figure.savefig(figure, dpi=120)
