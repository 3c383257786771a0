#!/usr/bin/env python3
"""Man pages of the program and of each command, from what it prints for --help-all.

    packaging/man_pages.py PROGRAM FOLDER
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "docs" / "site"))
from help_text import ask, commands_of, parse, read  # noqa: E402


def escaped(text):
    """Of roff: minus signs that can be copied, and no line that starts like a request."""
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return "\\&" + text if text[:1] in ".'" else text


def bold(head):
    """The names of a flag are bold, the placeholder of its value is italic."""
    parts = []
    for word in head.split(", "):
        name, _, value = word.partition(" ")
        is_flag = name.startswith("-")
        parts.append((f"\\fB{escaped(name)}\\fR" if is_flag else f"\\fI{escaped(name)}\\fR")
                     + (f" \\fI{escaped(value)}\\fR" if value else ""))
    return ", ".join(parts)


def title_line(name, version):
    return f'.TH "{name.upper()}" "1" "" "wavepath {version}" "User Commands"'


def page(name, about, usage, groups, end, version, others):
    lines = [title_line(name, version), ".SH NAME", f"{escaped(name)} \\- {escaped(about)}", ".SH SYNOPSIS",
             f"\\fB{escaped(usage)}\\fR"]
    if end:
        lines.append(".SH DESCRIPTION")
        for paragraph in end:
            lines += [escaped(paragraph), ".PP"]
    lines.append(".SH OPTIONS" if name != "wavepath" else ".SH COMMANDS")
    for heading, flags in groups:
        lines.append(f".SS {escaped(heading)}")
        for flag in flags:
            default = f" Default: {flag.default}." if flag.default else ""
            text = flag.text[:1].upper() + flag.text[1:]
            text += "" if text.endswith(".") else "."
            lines += [".TP", bold(flag.head), escaped(text + default)]
    lines += [".SH SEE ALSO", ", ".join(f"\\fB{escaped(other)}\\fR(1)" for other in others)]
    return "\n".join(lines) + "\n"


def main(program, folder):
    folder.mkdir(parents=True, exist_ok=True)
    version = ask(program, "--version").split()[-1]
    commands = commands_of(program)
    names = ["wavepath", *(f"wavepath-{command}" for command, _ in commands)]
    whole = parse(ask(program, "--help"))
    files = {"wavepath": page("wavepath", whole.about, whole.usage, whole.groups, whole.end, version, names[1:])}
    for command, about in commands:
        help_text = read(program, command)
        files[f"wavepath-{command}"] = page(f"wavepath-{command}", about, help_text.usage, help_text.groups,
                                            help_text.end, version, [names[0]])
    for name, text in files.items():
        (folder / f"{name}.1").write_text(text)


if __name__ == "__main__":
    main(sys.argv[1], pathlib.Path(sys.argv[2]))
