"""What the program prints for --help and --help-all, in its parts."""

import dataclasses
import re
import subprocess

COLUMN = 30  # where the texts of --help begin


@dataclasses.dataclass
class Flag:
    head: str  # "-o, --output FILE"
    text: str
    default: str
    is_expert: bool = False

    def names(self):
        return [word.split(" ")[0] for word in self.head.split(", ")]

    def choices(self):
        values = self.head.split(", ")[-1].partition(" ")[2].split("|")
        return values if len(values) > 1 else []


@dataclasses.dataclass
class Help:
    about: str
    usage: str
    groups: list  # of (heading, flags)
    end: list  # paragraphs

    def flags(self):
        return [flag for _, flags in self.groups for flag in flags]


def parse(text):
    first, usage, *blocks = text.strip().split("\n\n")
    result = Help(first.split(": ", 1)[1], usage.removeprefix("Usage: "), [], [])
    for block in blocks:
        lines = block.split("\n")
        if len(lines) > 1 and lines[1].startswith("  "):
            result.groups.append((lines[0], parse_flags(lines[1:])))
        else:
            result.end.append(" ".join(lines))
    return result


def parse_flags(lines):
    flags = []
    for line in lines:
        if line.startswith(" " * COLUMN):
            flags[-1].text += " " + line.strip()
        elif len(line) > COLUMN and line[COLUMN - 2:COLUMN] == "  ":
            flags.append(Flag(line[:COLUMN].strip(), line[COLUMN:], ""))
        else:
            flags.append(Flag(line.strip(), "", ""))
    for flag in flags:
        if match := re.fullmatch(r"(.*) \[default: (.*)\]", flag.text.strip()):
            flag.text, flag.default = match.groups()
        flag.text = flag.text.strip()
    return flags


def ask(program, *words):
    return subprocess.run([program, *words], capture_output=True, text=True, check=True).stdout


def commands_of(program):
    """Names and descriptions, in the order of the program."""
    groups = dict(parse(ask(program, "--help")).groups)
    return [(flag.head, flag.text) for flag in groups["Commands"]]


def read(program, command):
    result, usual = parse(ask(program, command, "--help-all")), parse(ask(program, command, "--help"))
    shown = {flag.head for flag in usual.flags()}
    for flag in result.flags():
        flag.is_expert = flag.head not in shown
    return result
