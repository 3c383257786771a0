#!/usr/bin/env python3
"""Makes report.html, one self-contained page, of a folder that `wavepath study` wrote: study_report.py DIR [FIGURE]
FIGURE.png or .svg: also the plot of error against time, on its own.

The build puts this file into the program, which runs it without a source tree. Exit code 3: matplotlib is missing."""

import base64
import html
import io
import json
import math
import os
import pathlib
import re
import sys

try:
    import matplotlib.ticker
    matplotlib.use("svg")
    from matplotlib import pyplot
    from PIL import Image  # which matplotlib needs as well
except ImportError:
    sys.exit(3)

HUES = ["#b3372f", "#2b6ca3", "#3a8a4d", "#8a5aa8", "#c07a1c", "#4a4f57"]
STYLES = [("o", ":"), ("s", "--"), ("D", "-"), ("^", "-."), ("v", ":")]
MAP_STOPS = [(0.0, 0.0, 0.015), (0.32, 0.07, 0.48), (0.72, 0.21, 0.47), (0.99, 0.53, 0.38), (0.99, 0.99, 0.75)]
LABEL_GAP = 0.034  # of the height of a plot, between labels
PICTURE_SIDE = 256  # pixels; larger pictures are shown smaller

CSS = """
:root { --ink: #1d2228; --soft: #626b76; --line: #e2e5e9; --tint: #f6f7f8; --accent: #2b6ca3; }
* { box-sizing: border-box; }
body { margin: 0; background: #fff; color: var(--ink);
  font: 15px/1.55 "Helvetica Neue", Helvetica, Arial, "Liberation Sans", "DejaVu Sans", sans-serif; }
main { max-width: 1080px; margin: 0 auto; padding: 44px 28px 80px; }
h1 { font-size: 29px; font-weight: 600; letter-spacing: -0.01em; margin: 0 0 6px; }
h2 { font-size: 19px; font-weight: 600; margin: 48px 0 8px; padding-top: 18px; border-top: 1px solid var(--line); }
p { margin: 8px 0; max-width: 62em; }
.soft, figcaption, .note { color: var(--soft); font-size: 13.5px; }
dl.facts { display: grid; grid-template-columns: repeat(4, auto); gap: 2px 28px; margin: 18px 0 0;
  justify-content: start; }
dl.facts dt { color: var(--soft); font-size: 12.5px; grid-row: 1; } dl.facts dd { margin: 0; grid-row: 2; }
dl.facts.second { margin-top: 10px; }
.summary { background: var(--tint); border-left: 3px solid var(--accent); padding: 14px 22px; margin: 24px 0; }
.summary ul { margin: 0; padding-left: 18px; } .summary li { margin: 6px 0; max-width: 62em; }
figure { margin: 16px 0; } figure svg { width: 100%; height: auto; display: block; }
table { border-collapse: collapse; margin: 12px 0; font-size: 13.5px; font-variant-numeric: tabular-nums; }
th { text-align: right; font-weight: 600; color: var(--soft); border-bottom: 1px solid var(--ink); padding: 5px 9px;
  vertical-align: bottom; }
td { text-align: right; border-bottom: 1px solid var(--line); padding: 5px 9px; white-space: nowrap; }
th:first-child, td:first-child, .left { text-align: left; padding-left: 2px; }
tr.best td { background: #eef4f9; font-weight: 600; }
.bar { display: inline-block; height: 9px; background: var(--accent); opacity: 0.55; border-radius: 1px; }
td.barcell { text-align: left; width: 136px; padding-right: 0; }
.dot { display: inline-block; width: 9px; height: 9px; border-radius: 50%; margin-right: 8px; }
.gallery { display: grid; grid-template-columns: repeat(auto-fill, minmax(326px, 1fr)); gap: 22px 20px;
  margin-top: 14px; }
.card b { font-weight: 600; } .card .pair { display: flex; gap: 4px; margin-top: 4px; }
.card img { width: calc(50% - 2px); display: block; }
.scale { height: 11px; width: 240px; display: inline-block; vertical-align: middle; margin: 0 8px; }
details { border-bottom: 1px solid var(--line); padding: 6px 0; } summary { cursor: pointer; }
code { font: 12px/1.5 "DejaVu Sans Mono", Menlo, Consolas, monospace; word-break: break-word; }
td code { white-space: normal; } td.command { white-space: normal; text-align: left; }
dl.glossary dt { font-weight: 600; margin-top: 10px; } dl.glossary dd { margin: 0; color: #3c434b; max-width: 60em; }
"""

GLOSSARY = [
    ("Relative RMS error", "The square root of relMSE: how far a pixel is off, as a share of its own brightness, over "
                           "the picture. 1 % is hardly visible, 10 % is clearly noisy."),
    ("MSE, relMSE, MRSE", "Means over pixels and RGB of linear radiance x against the reference r: (x - r)&sup2;; "
     "(x - r)&sup2; / (r&sup2; + 0.01); (x - r)&sup2; / (r + 0.01)&sup2;."),
    ("FLIP", "Mean HDR-FLIP (Andersson et al. 2021), 0 to 1: the difference that a viewer sees when two pictures are "
             "flipped at 67 pixels a degree."),
    ("Efficiency", "1 / (MSE &times; seconds). It stays the same over time for plain Monte Carlo, and grows where a "
                   "sampler gains from order among its samples."),
    ("Slope", "The exponent of the power law that fits the last four octaves: &minus;0.5 means that four times the "
              "time halves the error. Its interval holds the true exponent 95 times in 100 (Student's t)."),
    ("Scatter", "How far single measurements stray from the fitted line, 95 % of them: times as well as errors. "
                "Differences smaller than the scatter of both are called &ldquo;within noise&rdquo;."),
    ("Levels off", "A biased configuration comes near to something else than the reference. Where its error lost less "
                   "than a fifth over the last two octaves, no slope is fitted; the error it stands at is told "
                   "instead."),
    ("Floor of the reference", "The reference has an error of its own. Below three times that error, more than a tenth "
                               "of the MSE measured is the reference's; such points are flagged and no slope is fitted "
                               "to them."),
    ("Seconds", "Of rendering alone: no loading, compiling, reading or writing of pictures."),
]


def number(value, digits=3):
    """Significant digits without an exponent where that is readable."""
    if value is None:
        return "&ndash;"
    if value == 0.0:
        return "0"
    places = digits - 1 - math.floor(math.log10(abs(value)))
    if -4 <= places <= 6:
        return f"{value:.{max(places, 0)}f}".replace("-", "&minus;")
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    return f"{mantissa}&times;10<sup>{int(exponent)}</sup>".replace("-", "&minus;")


def percent(value, digits=3):
    return "&ndash;" if value is None else number(100.0 * value, digits) + " %"


def level_name(level):
    return f"{100.0 * level:g} %" if len(f"{100.0 * level:g}") < 5 else percent(level)


def hundredths(value):
    return f"{value:.2f}".replace("-", "&minus;")


def interval(fit, level=None):
    if level is not None:
        return f"levels off at {percent(level)}"
    return "&ndash;" if fit is None else (f"{hundredths(fit['slope'])} <span "
                                          f"class='soft'>({hundredths(fit['ci95'][0])} to "
                                          f"{hundredths(fit['ci95'][1])})</span>")


def table(head, rows, left=()):
    cells = "".join(f"<th{' class=left' if i in left else ''}>{cell}</th>" for i, cell in enumerate(head))
    return f"<table><thead><tr>{cells}</tr></thead><tbody>{''.join(rows)}</tbody></table>"


def row(cells, attributes=""):
    return f"<tr{attributes}>" + "".join(c if c.startswith("<td") else f"<td>{c}</td>" for c in cells) + "</tr>"


def listed(names):
    names = [f"<b>{html.escape(name)}</b>" for name in names]
    if len(names) > 5:
        names = [*names[:3], f"{len(names) - 3} others"]
    return names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1]


class Look:
    """Colour, marker and dash of a configuration: one for each dimension, so that a curve can be read without a key."""

    def __init__(self, study):
        self.values = {}
        for configuration in study["configurations"]:
            for dimension in study["vary"]:
                value = configuration["flags"].get(dimension)  # None: of no consequence there
                self.values.setdefault(dimension, [])
                if value not in self.values[dimension]:
                    self.values[dimension].append(value)
        names = list(self.values)
        self.hue = names[1] if len(names) > 1 else names[0]
        self.style = names[0]
        self.fill = names[2] if len(names) > 2 else None

    def place(self, configuration, dimension):
        return self.values[dimension].index(configuration["flags"].get(dimension))

    def color(self, configuration):
        return HUES[self.place(configuration, self.hue) % len(HUES)]

    def line(self, configuration):
        marker, dash = STYLES[self.place(configuration, self.style) % len(STYLES)]
        full = self.fill is None or self.place(configuration, self.fill) == len(self.values[self.fill]) - 1
        return {"color": self.color(configuration), "marker": marker, "linestyle": dash, "markersize": 4.2,
                "linewidth": 1.3,
                "markerfacecolor": self.color(configuration) if full else "white", "markeredgewidth": 1.0}


def spread(wanted, gap):
    """Heights of labels: near what is wanted, in its order, at least `gap` apart."""
    order = sorted(range(len(wanted)), key=lambda i: wanted[i])
    placed = []  # groups of labels that touch: [first height, members]
    for i in order:
        placed.append([wanted[i], [i]])
        while len(placed) > 1 and placed[-1][0] < placed[-2][0] + gap * len(placed[-2][1]):
            _, members = placed.pop()
            members = placed[-1][1] + members
            centre = sum(wanted[m] for m in members) / len(members)
            placed[-1] = [centre - gap * (len(members) - 1) / 2, members]
    result = [0.0] * len(wanted)
    for first, members in placed:
        for k, member in enumerate(members):
            result[member] = first + k * gap
    return result


def svg(figure):
    if figure is None:
        return "<p class=note>No error above zero was measured.</p>"
    text = io.StringIO()
    figure.savefig(text, format="svg")
    pyplot.close(figure)
    text = text.getvalue()
    text = text[text.index("<svg"):]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.S)
    return re.sub(r'\s(?:xmlns(?::\w+)?)="[^"]*"', "", text)  # HTML needs no name spaces


def subdivide(axis, limits, base, digits):
    """Ticks at digits times powers of the base; at powers alone where that would be too many."""
    many = math.log(limits[1] / limits[0], 10) > 3.2
    axis.set_major_locator(matplotlib.ticker.LogLocator(base, (1.0,) if many else digits, numticks=24))
    axis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda v, _: f"{v:g}"))
    axis.set_minor_locator(matplotlib.ticker.NullLocator())


def guide(axes):
    """How plain Monte Carlo falls, through the upper right corner."""
    (x0, x1), (y0, y1) = axes.get_xlim(), axes.get_ylim()
    right, top = x1 * (x0 / x1) ** 0.02, y1 * (y0 / y1) ** 0.03
    left, height = right * (x0 / x1) ** 0.25, top * (x1 / x0) ** -0.125
    if height > y0:
        axes.plot([left, right], [top, height], color="#9aa2ab", linewidth=1.0)
        axes.text(math.sqrt(left * right), math.sqrt(top * height), "  slope −0.5", color="#7a828b", fontsize=8.5,
                  va="bottom")


def plot(study, look, x, slope, label, height):
    """Error against `x`; the label of each curve stands at its right with the slope fitted."""
    figure, axes = pyplot.subplots(figsize=(10.6, height))
    curves = []
    for configuration in study["configurations"]:
        points = [p for p in configuration["points"] if p["relative_rms"] > 0.0]
        if not points or configuration["shows"] != study["configurations"][0]["shows"]:
            continue
        axes.loglog([p[x] for p in points], [100.0 * p["relative_rms"] for p in points], **look.line(configuration))
        curves.append((configuration, points[-1]))
    if not curves:
        pyplot.close(figure)
        return None
    axes.set_xlabel(label)
    axes.set_ylabel("relative RMS error, %")
    axes.grid(True, which="major", color="#e7e9ec", linewidth=0.8)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    subdivide(axes.yaxis, axes.get_ylim(), 10, (1.0, 2.0, 5.0))
    subdivide(axes.xaxis, axes.get_xlim(), 2 if x == "spp" else 10, (1.0,) if x == "spp" else (1.0, 2.0, 5.0))
    floor = study["reference"]["floor"]
    if floor:
        low, high = axes.get_ylim()
        low = min(low, 80.0 * floor)
        axes.axhspan(low / 100.0, 100.0 * floor, color="#f3f1ea", zorder=0, linewidth=0)
        axes.text(0.008, 100.0 * floor, " floor of the reference (3 × its own error)", va="bottom", fontsize=8.5,
                  color="#7a7360",
                  transform=axes.get_yaxis_transform())
        axes.set_ylim(low, high)
    if x == "seconds" and study["equal_time"]["seconds"]:
        axes.axvline(study["equal_time"]["seconds"], color="#9aa2ab", linewidth=0.9, linestyle=(0, (4, 3)))
        axes.text(study["equal_time"]["seconds"], 1.01, "equal time", transform=axes.get_xaxis_transform(), ha="center",
                  fontsize=8.5, color="#626b76")
    guide(axes)
    low, high = (math.log(v) for v in axes.get_ylim())
    heights = [(math.log(100.0 * last["relative_rms"]) - low) / (high - low) for _, last in curves]
    to_axes = axes.transAxes.inverted()
    for (configuration, last), y in zip(curves, spread(heights, LABEL_GAP * 5.6 / height)):
        end = to_axes.transform(axes.transData.transform((last[x], 100.0 * last["relative_rms"])))
        fit = configuration["slope"][slope]
        level = configuration["levels_off"]
        text = configuration["name"] + (f"   levels off at {100.0 * level:.3g} %" if level is not None else
                                        f"   {fit['slope']:.2f}".replace("-", "−") if fit else "")
        color = look.color(configuration)
        axes.plot([end[0] + 0.008, 1.02, 1.03], [end[1], y, y], transform=axes.transAxes, color=color, linewidth=0.5,
                  alpha=0.45, clip_on=False)
        axes.text(1.035, y, text, transform=axes.transAxes, color=color, fontsize=8.8, va="center")
    longest = max(len(configuration["name"]) + (15 if configuration["levels_off"] is not None else 0)
                  for configuration, _ in curves)
    figure.subplots_adjust(left=0.065, right=0.9 - 0.0066 * longest, top=0.95, bottom=0.55 / height)
    return figure


def plot_time(study, look):
    return plot(study, look, "seconds", "seconds", "seconds of rendering", 5.8)


def embedded(path):
    picture = Image.open(path).convert("RGB")
    picture.thumbnail((PICTURE_SIDE, PICTURE_SIDE), Image.NEAREST)  # noise is to stay noise
    data = io.BytesIO()
    picture.save(data, "JPEG", quality=86)
    return "data:image/jpeg;base64," + base64.b64encode(data.getvalue()).decode()


def effects(study):
    """For each value of each dimension: error over that of the dimension's first value, all else being equal, at equal
    time; geometric mean, least and most."""
    errors = {}
    for configuration, line in zip(study["configurations"], study["equal_time"]["rows"]):
        if "relative_rms" in line and line["relative_rms"] > 0.0:
            errors[tuple(sorted(configuration["flags"].items()))] = line["relative_rms"]
    found = []
    for dimension, values in Look(study).values.items():
        values = [value for value in values if value is not None]
        for value in values[1:]:
            ratios = []
            for flags, error in errors.items():
                other = dict(flags) | {dimension: values[0]}
                base = errors.get(tuple(sorted(other.items())))
                if dict(flags).get(dimension) == value and base:
                    ratios.append(error / base)
            if ratios:
                mean = math.exp(sum(map(math.log, ratios)) / len(ratios))
                found.append({"dimension": dimension, "value": value, "base": values[0], "mean": mean,
                              "least": min(ratios), "most": max(ratios)})
    return found


def ranked(study):
    rows = [(c, r) for c, r in zip(study["configurations"], study["equal_time"]["rows"]) if "relative_rms" in r]
    return sorted(rows, key=lambda pair: pair[1]["relative_rms"])


def conclude_equal_time(study, ranking):
    best, naive = ranking[0], study["configurations"][0]["name"]
    text = (f"After {number(study['equal_time']['seconds'])} s of rendering, {listed([best[0]['name']])} has the "
            f"lowest error: {percent(best[1]['relative_rms'])}")
    if best[1]["ratio"] and best[0]["name"] != naive:
        text += (f", {number(1.0 / best[1]['ratio'])} times lower than the plainest, {listed([naive])} "
                 f"({percent(best[1]['relative_rms'] / best[1]['ratio'])})")
    alike = [c["name"] for c, r in ranking[1:] if r["as_good_as_best"]]
    if len(alike) == len(ranking) - 1 and alike:
        text += "; the differences are within noise"
    elif alike:
        text += f". {listed(alike)} cannot be told from it: the difference is within the noise of this measurement"
    return text + "."


def conclude_effects(found):
    for e in found:
        if e["mean"] < 0.97:
            change = f"divides the error by {number(1.0 / e['mean'])}"
        elif e["mean"] > 1.03:
            change = f"multiplies the error by {number(e['mean'])}"
        else:
            change = "changes the error by less than 3 %"
        yield (f"{e['dimension'].capitalize()}: <b>{e['value']}</b> instead of {e['base']} {change} on average, all "
               f"else equal ({number(e['least'], 2)} to {number(e['most'], 2)} times the error).")


def conclude_slopes(study):
    fits = [(c["name"], c["slope"]["spp"]) for c in study["configurations"] if c["slope"]["spp"]]
    if not fits:
        return "Too few points were measured to fit slopes; a larger --budget gives more."
    slopes = [f["slope"] for _, f in fits]
    text = (f"Error falls with samples a pixel with slopes from {number(max(slopes), 2)} to {number(min(slopes), 2)}; "
            f"plain Monte "
            "Carlo gives &minus;0.5.")
    steeper = [n for n, f in fits if f["ci95"][1] < -0.5]
    flatter = [n for n, f in fits if f["ci95"][0] > -0.5]
    if steeper:
        text += f" Steeper, the 95 % interval says: {listed(steeper)}."
    if flatter:
        text += f" Flatter: {listed(flatter)}; rare bright paths that most renders have not met yet look like this."
    return text


def conclude_equal_error(study):
    for level in reversed(study["equal_error"][-1:]):
        known = [r for r in level["rows"] if r["how"] in ("interpolated", "extrapolated")]
        if not known:
            continue
        best, naive = min(known, key=lambda r: r["seconds"]), level["rows"][0]
        text = (f"To reach {level_name(level['relative_rms'])}, {listed([best['configuration']])} takes "
                f"{number(best['seconds'])} s")
        if best["speedup"] and best is not naive:
            text += f", {listed([naive['configuration']])} {number(best['speedup'])} times as long"
        elif naive["how"] == "not_reached":
            text += f"; {listed([naive['configuration']])} did not come near it"
        yield text + "."


def conclude_reference(study, ranking):
    reference = study["reference"]
    made = f"{reference['file']}, as given" if reference["given"] else (
        f"{reference['spp']} samples a pixel of sobol, mis, cosine with a seed of its own, "
        f"{number(reference['seconds'])} s")
    if reference["relative_rms"] is None:
        return f"The reference ({html.escape(made)}) does not tell its own error, so that its floor is unknown."
    low = [c["name"] for c, r in ranking if r["at_floor"]]
    text = f"The reference ({html.escape(made)}) has an estimated error of {percent(reference['relative_rms'])} itself."
    return text + (f" At equal time, {listed(low)} came so near to it that part of the error is the reference's."
                   if low else
                   " Every error in the tables is more than three times that.")


def conclude_shadows(study):
    """Shadow techniques have one sample count each: what counts is milliseconds a frame."""
    measured = shadow_points(study)
    told = [f"<b>{html.escape(c['name'])}</b> ({number(ms)} ms, "
            f"{percent(error / 100.0) if error > LEAST_SHADOW_ERROR else 'exact'})"
            for ms, error, c in pareto(measured)]
    lines = [f"No other is faster and nearer to the truth as well: {', '.join(told)}."] if told else []
    exact = list(dict.fromkeys(c["flags"]["shadows"] for c, score in shadowed(study)
                               if score["relative_rms"] <= ROUNDING))
    if exact:
        lines.append(f"Exact at some size: {', '.join(f'<b>{name}</b>' for name in exact)}.")
    for level in (5.0, 2.0, 1.0):
        within = [m for m in measured if m[1] <= level]
        if within:
            ms, error, c = min(within, key=lambda m: m[0])
            lines.append(f"Shadows within {level:g} % take {number(ms)} ms a frame at least: "
                         f"<b>{html.escape(c['name'])}</b>.")
    return lines


def summary(study, ranking, found):
    if not ranking and not shadowed(study):
        return ("<div class=summary>There is nothing to compare: every picture equals the reference to the last bit, "
                "or one configuration was slower at its first sample than another at its last.</div>")
    if shadowed(study):
        lines = conclude_shadows(study)
    else:
        lines = [conclude_equal_time(study, ranking), *conclude_effects(found), *conclude_equal_error(study),
                 conclude_slopes(study), conclude_reference(study, ranking)]
    if study["interrupted"]:
        lines.append("The study was interrupted: later configurations have fewer points.")
    return "<div class=summary><ul>" + "".join(f"<li>{line}</li>" for line in lines) + "</ul></div>"


def facts(study):
    device = study["device"]
    reference = study["reference"]
    first = [("scene", html.escape(os.path.basename(study["scene"]))),
             ("size", "&times;".join(map(str, study["size"]))),
             ("device", html.escape(device["name"])), ("driver", html.escape(device["driver"]))]
    second = [("date", study["date"]), ("wavepath", study["wavepath"]),
              ("rendering budget", f"{number(study['budget_seconds'])} s, of which the reference "
                                   f"{number(reference['seconds'])} s"),
              ("in common", f"{study['filter']} filter, depth {study['max_depth']}")]
    return "".join(f"<dl class='facts{extra}'>" + "".join(f"<dt>{k}</dt><dd>{v}</dd>" for k, v in items) + "</dl>"
                   for items, extra in ((first, ""), (second, " second")))


def name_cell(look, configuration):
    return f"<span class=dot style='background:{look.color(configuration)}'></span>{html.escape(configuration['name'])}"


def equal_time_table(look, ranking):
    worst = max((r["relative_rms"] for _, r in ranking), default=1.0)
    rows = []
    for place, (configuration, r) in enumerate(ranking):
        notes = [n for n, on in (("within noise of the best", r["as_good_as_best"] and place > 0),
                                 ("at the reference's floor", r["at_floor"])) if on]
        width = max(1, round(120 * r["relative_rms"] / worst))
        bar = f"<td class=barcell><span class=bar style='width:{width}px'></span></td>"
        rows.append(row([name_cell(look, configuration), percent(r["relative_rms"]), bar,
                         "&ndash;" if r["scatter95"] is None else f"&plusmn;{number(100 * r['scatter95'], 2)} %",
                         number(r["ratio"]), number(r["mse"]), number(r["mrse"]), number(r["flip"]),
                         number(r["efficiency"]),
                         f"<td class='left soft'>{', '.join(notes)}</td>"], " class=best" if place == 0 else ""))
    return table(["configuration", "error", "", "scatter", "ratio to<br>plainest", "MSE", "MRSE", "FLIP", "efficiency",
                  ""], rows)


def equal_error_table(study, look):
    rows = []
    for i, configuration in enumerate(study["configurations"]):
        cells = [name_cell(look, configuration)]
        for level in study["equal_error"]:
            r = level["rows"][i]
            mark = {"interpolated": "", "extrapolated": "~", "at_most": "&le;&thinsp;", "not_reached": ""}[r["how"]]
            cells.append("<span class=soft>not reached</span>" if r["seconds"] is None
                         else f"{mark}{number(r['seconds'])} s")
            cells.append(f"&times;{number(r['speedup'])}" if r["speedup"] else "&ndash;")
        rows.append(row(cells))
    head = ["configuration"]
    for level in study["equal_error"]:
        head += [f"time to {level_name(level['relative_rms'])}", "faster"]
    return table(head, rows)


def slope_table(study, look):
    rows = []
    for configuration in study["configurations"]:
        last = configuration["points"][-1] if configuration["points"] else None
        flag = "at the reference's floor" if last and last["at_floor"] else ""
        rows.append(row([name_cell(look, configuration), interval(configuration["slope"]["seconds"],
                                                                  configuration["levels_off"]),
                         interval(configuration["slope"]["spp"], configuration["levels_off"]), str(last["spp"]) if last
                         else "&ndash;",
                         number(last["seconds"]) + " s" if last else "&ndash;",
                         percent(last["relative_rms"]) if last else "&ndash;", f"<td class='left soft'>{flag}</td>"]))
    return table(["configuration", "slope against seconds", "slope against samples", "most samples<br>a pixel", "in",
                  "error then", ""], rows)


def effect_table(found):
    rows = [row([f"--{e['dimension']}", f"<td class=left>{e['value']} instead of {e['base']}</td>", number(e["mean"]),
                 f"{number(e['least'])} to {number(e['most'])}"]) for e in found]
    return table(["flag", "choice", "error, times", "least to most"], rows, left=(1,))


def gallery(study, folder):
    cards = []
    reference = folder / study["reference"]["picture"]
    if reference.exists():
        cards.append(f"<div class=card><b>reference</b><br><span class=soft>{study['reference']['spp'] or '?'} "
                     f"samples</span><div class=pair><img alt='reference' src='{embedded(reference)}'></div></div>")
    for configuration in study["configurations"]:
        shown = configuration["picture"]
        if not shown or not all((folder / shown[key]).exists() for key in ("file", "error_map")):
            continue
        error = next(p["relative_rms"] for p in configuration["points"] if p["spp"] == shown["spp"])
        images = "".join(f"<img alt='{html.escape(configuration['name'])}' src='{embedded(folder / shown[key])}'>"
                         for key in ("file", "error_map"))
        cards.append(f"<div class=card><b>{html.escape(configuration['name'])}</b><br><span class=soft>{shown['spp']} "
                     f"samples, {number(shown['seconds'])} s, {percent(error)}</span><div "
                     f"class=pair>{images}</div></div>")
    if not cards:
        return "<p>The folder holds no pictures.</p>"
    stops = ", ".join("#" + "".join(f"{round(255 * c):02x}" for c in stop) for stop in MAP_STOPS)
    scale = (f"<p class=soft>FLIP 0 <span class=scale style='background:linear-gradient(to right, {stops})'></span> "
             f"{number(study['error_map']['brightest'], 2)} and more</p>")
    return scale + f"<div class=gallery>{''.join(cards)}</div>"


def has_frames(study):
    return "integrator" in study["vary"]


def signal(point, name):
    return percent(point[name]["relative_rms"]) if point[name] else "&ndash;"


def approximation_table(study, look):
    rows = []
    for configuration in study["configurations"]:
        if not configuration["points"]:
            continue
        last, first = configuration["points"][-1], configuration["points"][0]
        level = configuration["levels_off"]
        rows.append(row([name_cell(look, configuration), number(last["ms_per_frame"]), str(last["spp"]),
                         signal(first, "direct"),
                         signal(first, "ao"), signal(first, "full"), signal(last, "direct"), signal(last, "ao"),
                         signal(last, "full"),
                         "&ndash;" if level is None else percent(level)]))
    return table(["configuration", "ms a frame", "most<br>frames", "one frame:<br>direct light", "<br>occlusion",
                  "<br>full picture",
                  "most frames:<br>direct light", "<br>occlusion", "<br>full picture", "levels off at"], rows)


def conclude_approximation(study):
    """One sentence for each way to tell what is lost and what it saves."""
    measured = [c for c in study["configurations"] if c["points"] and c["points"][-1]["full"]]
    frames = [c for c in measured if c["flags"]["integrator"] == "hybrid"]
    paths = [c for c in measured if c["flags"]["integrator"] == "path"]
    if frames and paths:
        path = min(paths, key=lambda c: c["points"][-1]["ms_per_frame"])
        quickest = min(frames, key=lambda c: c["points"][-1]["ms_per_frame"])
        ratio = path["points"][-1]["ms_per_frame"] / quickest["points"][-1]["ms_per_frame"]
        change = f"{number(ratio)} times as fast as" if ratio >= 1.0 else f"{number(1.0 / ratio)} times as long as"
        nearest = min(frames, key=lambda c: c["points"][-1]["full"]["relative_rms"])
        yield (f"A frame of {listed([quickest['name']])} takes {number(quickest['points'][-1]['ms_per_frame'])} ms, "
               f"{change} a sample of every pixel of {listed([path['name']])} "
               f"({number(path['points'][-1]['ms_per_frame'])} ms).")
        level = nearest["levels_off"]
        yield (f"{listed([nearest['name']])} comes nearest to the path-traced picture: " +
               (f"its error levels off at {percent(level)}, whatever the number of frames." if level is not None else
                f"{percent(nearest['points'][-1]['full']['relative_rms'])} after {nearest['points'][-1]['spp']} "
                f"frames, still falling."))
    hits = study["first_hits"]
    if hits and hits["rasterized_ms"] > 0.0 and hits["traced_ms"] > 0.0:
        yield (f"The first surface of every pixel costs {number(hits['rasterized_ms'])} ms a frame when rasterized and "
               f"resolved, {number(hits['traced_ms'])} ms when camera rays are traced on the same device (mean of "
               f"{hits['frames']} frames).")


def approximation(study, look, folder):
    lines = "".join(f"<li>{line}</li>" for line in conclude_approximation(study))
    best = {}  # by integrator, the configuration with the least error
    for configuration in study["configurations"]:
        name = configuration["flags"]["integrator"] + (" denoised" if configuration["flags"].get("denoise") == "on"
                                                       else "")
        if configuration["points"] and configuration["picture"] and (
                name not in best or
                configuration["points"][-1]["relative_rms"] < best[name]["points"][-1]["relative_rms"]):
            best[name] = configuration
    shown = [("reference", study["reference"]["picture"]), *((c["name"], c["picture"]["file"]) for c in best.values())]
    if study["ao_reference"]:
        shown.append(("occlusion, reference", study["ao_reference"]["picture"]))
    cards = "".join(f"<div class=card><b>{html.escape(name)}</b><br><img style='width:100%' alt='{html.escape(name)}' "
                    f"src='{embedded(folder / file)}'></div>" for name, file in shown if (folder / file).exists())
    return (f"<div class=summary><ul>{lines}</ul></div>" if lines else "") + approximation_table(study, look) + (
        "<p class=note>Direct light and the full picture against the path-traced reference; occlusion against a "
        "reference of its own, many rays with the same radius. A frame is one sample of every pixel; the seconds are "
        "of rendering alone.</p>"
        f"<div class=gallery>{cards}</div>")


def shadowed(study):
    """The configurations whose shadows were scored, each with its last point's score."""
    return [(c, c["points"][-1]["shadows"]) for c in study["configurations"] if c["points"]
            and c["points"][-1].get("shadows")]


def shadow_ms(score):
    return sum(score[key]["median"] for key in ("build_ms", "look_up_ms") if key in score)


def pareto(measured):
    """Of (milliseconds, error, ...) those that no other beats in both, by milliseconds."""
    front = []
    for one in sorted(measured, key=lambda m: (m[0], m[1])):
        if not front or one[1] < front[-1][1]:
            front.append(one)
    return front


ROUNDING = 1e-6  # of shadows' error: what adding up light in another order leaves
LEAST_SHADOW_ERROR = 0.01  # %: techniques that are exact, but for rounding, are plotted there


def shadow_points(study):
    return [(shadow_ms(score), max(100.0 * score["relative_rms"], LEAST_SHADOW_ERROR), c)
            for c, score in shadowed(study)
            if shadow_ms(score) > 0.0]


def plot_shadows(study, look):
    measured = shadow_points(study)
    if not measured:
        return None
    figure, axes = pyplot.subplots(figsize=(10.6, 5.8))
    techniques = list(dict.fromkeys(c["flags"]["shadows"] for _, _, c in measured))
    colours = pyplot.get_cmap("tab20")
    for i, technique in enumerate(techniques):
        curve = [(x, y) for x, y, c in measured if c["flags"]["shadows"] == technique]
        axes.loglog(*zip(*curve), color=colours(i % 20), marker=STYLES[i % len(STYLES)][0], markersize=4.5,
                    linewidth=0.8,
                    alpha=0.9, label=technique)
    front = pareto(measured)
    axes.step([m[0] for m in front], [m[1] for m in front], where="post", color="#1d2228", linewidth=1.4, alpha=0.55,
              zorder=0)
    axes.set_xlabel("milliseconds a frame, to build and to look up (rays that are left to trace included)")
    axes.set_ylabel("relative RMS error of direct light, by its shadows, %")
    axes.grid(True, which="major", color="#e7e9ec", linewidth=0.8)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    subdivide(axes.yaxis, axes.get_ylim(), 10, (1.0, 2.0, 5.0))
    subdivide(axes.xaxis, axes.get_xlim(), 10, (1.0, 2.0, 5.0))
    axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False, fontsize=8.8)
    figure.subplots_adjust(left=0.065, right=0.86, top=0.97, bottom=0.1)
    return figure


def level_sizes(study):
    """By technique: the map size from which on its error stays within a tenth, and that at which it is half of the
    coarsest's."""
    found = {}
    for configuration, score in shadowed(study):
        if size := configuration["flags"].get("shadow-size"):
            found.setdefault(configuration["flags"]["shadows"], {})[int(size)] = score["relative_rms"]
    rows = {}
    for technique, errors in found.items():
        sizes = sorted(errors)
        least = min(errors.values())
        levels = next((s for s in sizes if all(errors[t] <= 1.1 * least for t in sizes if t >= s)), None)
        halves = next((s for s in sizes if errors[s] <= 0.5 * errors[sizes[0]]), None)
        rows[technique] = (levels, halves)
    return rows


def with_spread(cost):
    spread = f" {number(cost['least'])}&ndash;{number(cost['most'])}" if cost["least"] < cost["most"] else ""
    return f"{number(cost['median'])}<span class=soft>{spread}</span>"


def shadow_table(study, look):
    best = {id(m[2]) for m in pareto(shadow_points(study))}
    levels, rows = level_sizes(study), []
    for configuration, score in shadowed(study):
        point = configuration["points"][-1]
        ms = [with_spread(score[key]) if key in score and score[key]["median"] > 0.0 else "&ndash;"
              for key in ("build_ms", "look_up_ms")]
        optional = [number(score[key]) if score[key] is not None else "&ndash;"
                    for key in ("edge_displacement_pixels", "penumbra_ratio")]
        size = configuration["flags"].get("shadow-size")
        level = levels.get(configuration["flags"]["shadows"], (None, None))
        marks = [text for text, at in (("levels off", level[0]), ("half the error", level[1])) if size
                 and at == int(size)]
        error = score["relative_rms"] if score["relative_rms"] > ROUNDING else 0.0
        rows.append(row([name_cell(look, configuration), percent(error), number(point["flip"]),
                         percent(score["falsely_lit"]),
                         percent(score["falsely_dark"]), *optional, *ms,
                         number(score["bytes"] / 2**20) if score.get("bytes") else "&ndash;", "<br>".join(marks)],
                        " class=best" if id(configuration) in best else ""))
    return table(["configuration", "error of<br>direct light", "FLIP", "falsely<br>lit", "falsely<br>dark",
                  "edges off<br>by pixels",
                  "penumbra over<br>the true one", "ms to<br>build", "ms to<br>look up", "MiB", ""], rows)


def worst_place(study, folder):
    """The square, a fifth of the picture's smaller side, in which shadows of all techniques together are most false."""
    total = None
    for configuration, _ in shadowed(study):
        file = configuration["picture"] and configuration["picture"].get("false_shadows")
        if not file or configuration["flags"]["shadows"] == "traced" or not (folder / file).exists():
            continue
        red, _, blue = Image.open(folder / file).convert("RGB").split()
        width, height = red.size
        off = [abs(r - b) for r, b in zip(red.getdata(), blue.getdata())]
        total = off if total is None else [a + b for a, b in zip(total, off)]
    if total is None:
        return None
    side = max(min(width, height) // 5, 8)
    sums = [0] * ((width + 1) * (height + 1))  # of all above and to the left
    for y in range(height):
        line = 0
        for x in range(width):
            line += total[y * width + x]
            sums[(y + 1) * (width + 1) + x + 1] = sums[y * (width + 1) + x + 1] + line
    at = lambda x, y: sums[y * (width + 1) + x]
    places = [(x, y) for y in range(0, height - side, 2) for x in range(0, width - side, 2)]
    x, y = max(places, key=lambda p: at(p[0] + side, p[1] + side) - at(p[0], p[1] + side) - at(p[0] + side, p[1]) +
               at(*p))
    return x, y, x + side, y + side


def crop(path, place):
    data = io.BytesIO()
    Image.open(path).convert("RGB").crop(place).resize((160, 160), Image.NEAREST).save(data, "PNG")
    return "data:image/png;base64," + base64.b64encode(data.getvalue()).decode()


def shadow_pictures(study, folder):
    """Of each technique at its least error: the worst place, and where in the whole picture shadows are false."""
    place = worst_place(study, folder)
    if place is None:
        return ""
    best = {}
    for configuration, _ in shadowed(study):
        name, error = configuration["flags"]["shadows"], configuration["points"][-1]["shadows"]["relative_rms"]
        if configuration["picture"] and (name not in best or
                                         error < best[name]["points"][-1]["shadows"]["relative_rms"]):
            best[name] = configuration
    cards = [f"<div class=card><b>reference</b><div class=pair><img alt='reference' "
             f"src='{crop(folder / study['reference']['picture'], place)}'></div></div>"]
    for configuration in best.values():
        files = [configuration["picture"]["file"], configuration["picture"]["false_shadows"]]
        if not all(file and (folder / file).exists() for file in files):
            continue
        cards.append(f"<div class=card><b>{html.escape(configuration['name'])}</b><div class=pair><img alt='' "
                     f"src='{crop(folder / files[0], place)}'><img alt='' "
                     f"src='{embedded(folder / files[1])}'></div></div>")
    return ("<p class=note>The place where all techniques together are most wrong, under each of them at its least "
            "error, and the whole "
            f"picture: orange is falsely lit, blue falsely dark.</p><div class=gallery>{''.join(cards)}</div>")


def shadows(study, look, folder):
    unfit = "".join(f"<li>{html.escape(u['configuration'])} {html.escape(u['why'])}</li>" for u in study["unfit"])
    return ("<figure>" + svg(plot_shadows(study, look)) +
            "<figcaption>Down and to the left is better; the dark line is the front that none beats in both. Marks of "
            "one colour: "
            f"growing maps. At {LEAST_SHADOW_ERROR:g} %: what is exact.</figcaption></figure>" +
            shadow_table(study, look) +
            "<p class=note>After as many samples as all of them have. The error is that of shadows alone: the truth is "
            "that of the very points of surfaces that all pictures see, from each of which 64 rays or more go to "
            "lights. Falsely lit and falsely dark: share of the pixels whose light is off by more than "
            "a quarter of what it would be without shadows. Milliseconds are medians with spread, warm, build and "
            "look-up apart; a map that nothing moves in need not be built again. Highlighted: on the front.</p>" +
            shadow_pictures(study, folder) +
            (f"<p class=note>Left out:</p><ul class=note>{unfit}</ul>" if unfit else ""))


def commands(study):
    reference = study["reference"]
    parts = [f"<p>The whole study:<br><code>{html.escape(study['command'])}</code></p>"]
    if reference["command"]:
        parts.append(f"<p>The reference, which the rows need:<br><code>{html.escape(reference['command'])}</code></p>")
    for configuration in study["configurations"]:
        rows = [row([str(p["spp"]), number(p["seconds"]) + " s", percent(p["relative_rms"]), number(p["efficiency"]),
                     "at floor" if p["at_floor"] else "",
                     f"<td class=command><code>{html.escape(p['command'])}</code></td>"])
                     for p in configuration["points"]]
        head = ["samples", "rendering", "error", "efficiency", "", "command"]
        parts.append(f"<details><summary>{html.escape(configuration['name'])}, {len(rows)} "
                     f"rows</summary>{table(head, rows, (5,))}</details>")
    return "".join(parts)


def over_time_sections(study, look, ranking, found):
    return [
        ("Error against time", "<figure>" + svg(plot_time(study, look)) +
         "<figcaption>Both axes logarithmic; down and to the left is better. The number behind each name is the slope "
         "fitted to the "
         f"last four octaves. Colour: {look.hue}; marker and dash: {look.style}" +
         (f"; hollow markers: {next(filter(None, look.values[look.fill]))} {look.fill}" if look.fill else "") +
         ".</figcaption></figure>"),
        ("Error against samples", "<figure>" + svg(plot(study, look, "spp", "spp", "samples a pixel", 5.0)) +
         "<figcaption>The same without the cost of a sample: what differs here is the quality of samples "
         "alone.</figcaption></figure>"),
        ("At equal time", f"<p class=note>Every configuration after {number(study['equal_time']['seconds'])} s of "
                          f"rendering, between "
         "the nearest two measurements on logarithmic axes; best first.</p>" + equal_time_table(look, ranking)),
        ("What each choice does", "<p class=note>Error over the error with the plainest value, everything else being "
                                  "equal, at that time: geometric mean over the grid.</p>" + effect_table(found)),
        ("At equal error", "<p class=note>Seconds until the error has come down to a level, and how many times faster "
                           "than the plainest configuration that is. &le;: the first sample is better already; ~: past "
                           "the last measurement, by its slope, at most one octave.</p>" +
                           equal_error_table(study, look)),
        ("Slopes", "<p class=note>With 95 % intervals.</p>" + slope_table(study, look)),
    ]


def page(study, folder):
    look, ranking, found = Look(study), ranked(study), effects(study)
    subject = "Shadows" if shadowed(study) else "Error against time"
    title = f"{subject}: {html.escape(pathlib.PurePath(study['scene']).stem)}"
    count = len(study["configurations"])
    samples, over_time = "1, 2, 4, ...", []
    if shadowed(study):
        samples = max(c["points"][-1]["spp"] for c, _ in shadowed(study))
    else:
        over_time = over_time_sections(study, look, ranking, found)
    sections = [
        ("", f"<p class=soft>{count} ways to render one picture, each measured against one converged reference at "
             f"{samples} samples a pixel. Varied: {', '.join(study['vary'])}.</p>" + facts(study) +
             summary(study, ranking, found)),
        *([("What the approximation costs", approximation(study, look, folder))] if has_frames(study) else []),
        *([("Shadows", shadows(study, look, folder))] if shadowed(study) else []),
        *over_time,
        ("Pictures and error maps", "<p class=note>Of each configuration the render that is nearest to the equal time, "
                                    "tonemapped "
         f"at {study['exposure']:+.1f} EV, and where it differs from the reference.</p>" + gallery(study, folder)),
        ("To repeat", "<p class=note>Each row is a render of its own, with its own seed; the command gives the same "
                      "bits on the same device and driver.</p>" + commands(study)),
        ("What the words mean", "<dl class=glossary>" + "".join(f"<dt>{k}</dt><dd>{v}</dd>" for k, v in GLOSSARY) +
         "</dl>"),
    ]
    body = "".join((f"<h2>{heading}</h2>" if heading else "") + text for heading, text in sections)
    return (f"<!DOCTYPE html><html lang=en><head><meta charset=utf-8><meta name=viewport content='width=device-width'>"
            f"<title>{title}</title><style>{CSS}</style></head>"
            f"<body><main><h1>{title}</h1>{body}</main></body></html>\n")


def main(folder, figure=None):
    folder = pathlib.Path(folder)
    study = json.loads((folder / "study.json").read_text(encoding="utf-8"))
    for key in ("ao_reference", "first_hits"):  # not in documents of version 0.1.0
        study.setdefault(key, None)
    study.setdefault("unfit", [])
    for configuration in study["configurations"]:
        configuration.setdefault("levels_off", None)
        configuration.setdefault("shows", "full")
    pyplot.rcParams.update({"font.family": "DejaVu Sans", "font.size": 9.5, "axes.edgecolor": "#8d959e",
                            "xtick.color": "#4a515a",
                            "ytick.color": "#4a515a", "axes.labelcolor": "#4a515a", "svg.hashsalt": "wavepath"})
    text = page(study, folder)
    temporary = folder / f".report.html.{os.getpid()}"
    try:
        temporary.write_text(text, encoding="utf-8")
        os.replace(temporary, folder / "report.html")
    finally:
        temporary.unlink(missing_ok=True)
    if figure:
        plot_time(study, Look(study)).savefig(figure, dpi=110)


if __name__ == "__main__":
    main(*sys.argv[1:])
