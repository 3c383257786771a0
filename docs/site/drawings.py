"""Drawings in Mermaid's language as SVG inside of a page, laid out by Graphviz, so that they need no network.

Of Mermaid it knows what the documents use: flowcharts, labels of nodes and arrows, chains, groups."""

import html
import re
import subprocess

COLUMN = 736  # pixels of the text's width
WIDEST = 1.15 * COLUMN  # of a drawing that is made to fit
NODE = r"(\w+)(?:\[\"(.*?)\"\])?"
ARROW = r"\s*(-->|-\.->)(?:\|(.*?)\|)?\s*"


class Drawing:
    def __init__(self, source):
        first, *lines = [line.strip() for line in source.strip().split("\n")]
        kind = re.fullmatch(r"flowchart (LR|TD)", first)
        if not kind:
            raise ValueError(f"'{first}' is no drawing that docs/site/drawings.py knows")
        self.direction = {"LR": "LR", "TD": "TB"}[kind[1]]
        self.labels, self.edges = {}, []
        heads = {line: re.fullmatch(r'subgraph (\w+)\["(.*)"\]', line) for line in lines}
        self.groups = {head[1]: (head[2], []) for head in heads.values() if head}  # which arrows name before
        group = None
        for line in lines:
            if heads[line]:
                group = heads[line][1]
            elif line == "end":
                group = None
            elif line and not line.startswith("direction "):
                self.add_chain(line, group)

    def add_chain(self, line, group):
        words = re.split(ARROW, line)
        nodes = [self.add_node(word, group) for word in words[::3]]
        for i, (start, end) in enumerate(zip(nodes, nodes[1:])):
            self.edges.append((start, end, words[3 * i + 2] or "", words[3 * i + 1] == "-.->"))

    def add_node(self, text, group):
        match = re.fullmatch(NODE, text.strip())
        if not match:
            raise ValueError(f"'{text}' is no node that docs/site/drawings.py knows")
        name, label = match.groups()
        if name not in self.labels and name not in self.groups:
            self.labels[name] = name
            if group:
                self.groups[group][1].append(name)
        if label:
            self.labels[name] = label
        return name

    def name_of(self, node):
        text = self.groups[node][0] if node in self.groups else self.labels[node]
        return text.replace("<br/>", " ")

    def dot(self):
        def quoted(text):
            text = re.sub(r"^(.{9,}:) (?=.{9})", r"\1<br/>", text)
            return '"' + text.replace('"', r'\"').replace("<br/>", r"\n") + '"'

        lines = ["digraph {", f"rankdir={self.direction}; compound=true; bgcolor=transparent;",
                 "nodesep=0.15; ranksep=0.32;",
                 'node [shape=box, style="rounded,filled", fillcolor="#00ff00", color="#ff0000", fontcolor="#ff0000", '
                 'fontname="Helvetica", fontsize=10, margin="0.1,0.05", height=0.25];',
                 'edge [color="#ff0000", fontcolor="#ff0000", fontname="Helvetica", fontsize=9, arrowsize=0.6];']
        for group, (label, members) in self.groups.items():
            names = " ".join(members)
            lines.append(f'subgraph cluster_{group} {{ label={quoted(label)}; style="rounded,dashed"; color="#ff0000"; '
                         f'fontcolor="#ff0000"; fontname="Helvetica"; fontsize=10; {names}; }}')
        lines += [f"{name} [label={quoted(label)}];" for name, label in self.labels.items()]
        for start, end, label, dashed in self.edges:
            about = [f"label={quoted(f'  {label}  ')}"] if label else []
            if dashed:
                about.append("style=dashed")
            if start in self.groups:  # an edge of a group starts at one of its nodes, and is cut at its border
                about.append(f"ltail=cluster_{start}")
                start = self.groups[start][1][-1]
            if end in self.groups:
                about.append(f"lhead=cluster_{end}")
                end = self.groups[end][1][0]
            lines.append(f"{start} -> {end} [{', '.join(about)}];")
        return "\n".join([*lines, "}"])

    def words(self):
        """The same for those who cannot see it."""
        return [f"{self.name_of(start)} → {self.name_of(end)}{f' ({label})' if label else ''}"
                for start, end, label, _ in self.edges]


def laid_out(drawing):
    return subprocess.run(["dot", "-Tsvg"], input=drawing.dot(), capture_output=True, text=True, check=True).stdout


def width_of(svg):
    return float(re.search(r'width="([\d.]+)pt"', svg)[1]) * 4 / 3


def svg_of(drawing):
    """The drawing as SVG, and its width in pixels. One that is too wide from left to right goes from top to bottom."""
    text = laid_out(drawing)
    if drawing.direction == "LR" and width_of(text) > WIDEST:
        drawing.direction = "TB"
        text = laid_out(drawing)
    width = width_of(text)
    text = re.sub(r"<!--.*?-->\n?|<title>.*?</title>\n?", "", text[text.index("<svg"):], flags=re.S)
    # Colours are those of the page, which may be dark.
    text = text.replace("#ff0000", "currentColor").replace("#00ff00", "var(--color-background-secondary, #f4f5f7)")
    text = re.sub(r' (id|class|xmlns:xlink)="[^"]*"', "", text)
    return text, width


def fence(source, write):
    """The drawing as a block of MyST, its arrows also as a list. One that is wider than the text can be scrolled, and
    opened alone: `write` takes its file and returns a link to it."""
    drawing = Drawing(source)
    svg, width = svg_of(drawing)
    arrows = "".join(f"<li>{html.escape(line)}</li>" for line in drawing.words())
    smallest = width if width > WIDEST else 0.8 * width
    style = f"width: {width:.0f}px; min-width: {smallest:.0f}px; height: auto"
    picture = svg.replace("<svg ", f'<svg aria-hidden="true" style="{style}" ', 1)
    lines = ["```{raw} html", f'<div class="drawing" tabindex="0">{picture}</div>',
             '<details class="drawing-words"><summary>The arrows as a list</summary>',
             f"<ul>{arrows}</ul></details>", "```"]
    if width > WIDEST:
        lines += ["", f"[The drawing alone]({write(svg)}), in its full size."]
    return "\n".join(lines)
