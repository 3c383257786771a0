"""Error against time: slopes, the time to a given error, and how peer_cycles.py shows them."""

import math
import statistics

TARGETS = [1e-2, 1e-3]  # relMSE
JUMP = 4  # from one number of samples to the next, no more than an octave apart


def net_error(errors, between):
    """Of a picture whose relMSE against two references is `errors`; theirs against each other is `between`. Squares of
    independent errors add up, so half of that is what each reference contributes."""
    return statistics.fmean(errors) - between / 2


def slope(points):
    """Of log relMSE against log seconds, by least squares over the last three octaves of samples; independent samples
    give -1. From the last jump on, if there is one: where renders are long enough for another pilot, it says nothing of
    longer ones."""
    last = [p for p in points if p["spp"] * 8 >= points[-1]["spp"]]
    jumps = [i for i in range(1, len(last) - 1) if last[i - 1]["relmse"] > JUMP * last[i]["relmse"]]
    last = last[jumps[-1]:] if jumps else last
    x = [math.log(p["seconds"]) for p in last]
    y = [math.log(p["relmse"]) for p in last]
    mx, my = statistics.fmean(x), statistics.fmean(y)
    return sum((a - mx) * (b - my) for a, b in zip(x, y)) / sum((a - mx) ** 2 for a in x)


def time_to(points, target):
    """Seconds to that error, between the two nearest points on logarithmic axes; past the last one by the slope.
    Returns (seconds, measured)."""
    if points[0]["relmse"] <= target:
        return points[0]["seconds"], True
    for a, b in zip(points, points[1:]):
        if b["relmse"] <= target:
            t = math.log(a["relmse"] / target) / math.log(a["relmse"] / b["relmse"])
            return a["seconds"] * (b["seconds"] / a["seconds"]) ** t, True
    last = points[-1]
    return last["seconds"] * (target / last["relmse"]) ** (1 / slope(points)), False


def summarize(view, series):
    result = {"view": view, "renderers": {}}
    for name, points in series.items():
        last = points[-1]
        to = {f"{t:g}": dict(zip(("seconds", "measured"), time_to(points, t))) for t in TARGETS}
        result["renderers"][name] = {
            "points": points, "slope": slope(points), "seconds_to": to,
            "mpaths_per_second": math.prod(view["size"]) * last["spp"] / last["seconds"] / 1e6,
            "mrays_per_second": last["runs"][0].get("mrays_per_second")}
    ours, cycles = result["renderers"]["wavepath"], result["renderers"]["cycles"]
    result["ratio"] = {t: r["seconds"] / cycles["seconds_to"][t]["seconds"] for t, r in ours["seconds_to"].items()}
    shared = min(len(ours["points"]), len(cycles["points"])) - 1
    a, b = ours["points"][shared], cycles["points"][shared]
    result["equal_spp"] = {"spp": a["spp"], "seconds_ratio": a["seconds"] / b["seconds"],
                           "relmse_ratio": a["relmse"] / b["relmse"]}
    return result


def table(results):
    def row(*cells):
        return "| " + " | ".join(cells) + " |"

    head = ["scene", "renderer", *(f"s to {t:g}" for t in TARGETS), "slope", "Mpaths/s", "Mrays/s"]
    lines = [row(*head), row(*["---"] * len(head))]
    for name, result in results.items():
        for renderer, r in result["renderers"].items():
            times = [("" if t["measured"] else "~") + f"{t['seconds']:.2f}" for t in r["seconds_to"].values()]
            rays = f"{r['mrays_per_second']:.2f}" if r["mrays_per_second"] else "not told"
            lines.append(row(name, renderer, *times, f"{r['slope']:.2f}", f"{r['mpaths_per_second']:.2f}", rays))
        equal = result["equal_spp"]
        ratios = [f"{r:.2f}" for r in result["ratio"].values()]
        lines.append(row(name, "**wavepath / Cycles**", *ratios, "",
                         f"{equal['spp']} spp: {equal['seconds_ratio']:.2f} of the seconds,",
                         f"{equal['relmse_ratio']:.2f} of the relMSE"))
    return "\n".join(lines)


def plot(results, path):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    figure, axes = pyplot.subplots(1, len(results), figsize=(4.5 * len(results), 4), squeeze=False)
    for axis, (name, result) in zip(axes[0], results.items()):
        for renderer, r in result["renderers"].items():
            axis.loglog([p["seconds"] for p in r["points"]], [p["relmse"] for p in r["points"]], "o-", label=renderer)
        for target in TARGETS:
            axis.axhline(target, color="grey", linewidth=0.5)
        axis.set(title=name, xlabel="seconds", ylabel="relMSE")
        axis.legend()
    figure.tight_layout()
    figure.savefig(path)
