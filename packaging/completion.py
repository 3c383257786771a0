#!/usr/bin/env python3
"""Completion of commands, flags and their values for a shell, from what the program prints for --help-all.

    packaging/completion.py PROGRAM bash|zsh
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "docs" / "site"))
from help_text import commands_of, read  # noqa: E402


def long_name(flag):
    return next((name for name in reversed(flag.names()) if name.startswith("--")), flag.names()[-1])


def is_flag(flag):
    return flag.head.startswith("-")


def words_of(flag):
    """Values that are words, and not placeholders."""
    return [value for value in flag.choices() if value == value.lower() and value.isascii()]


def bash(program):
    commands = commands_of(program)
    names = " ".join(name for name, _ in commands)
    lines = ["# Completion of wavepath; written by packaging/completion.py.", "_wavepath() {",
             "  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}",
             "  local command=${COMP_WORDS[1]} flags= values=", "  if ((COMP_CWORD == 1)); then",
             f"    COMPREPLY=($(compgen -W '{names} --help --version' -- \"$current\"))",
             "    return", "  fi", "  case $command in"]
    for name, _ in commands:
        flags = [flag for flag in read(program, name).flags() if is_flag(flag)]
        names = " ".join(name for flag in flags for name in flag.names())
        lines += [f"    {name})", f"      flags='{names}'", "      case $previous in"]
        for flag in flags:
            if flag.choices():
                values = " ".join(words_of(flag))
                lines += [f"        {'|'.join(flag.names())}) values='{values}' ;;"]
        lines += ["      esac", "      ;;"]
    lines += ["  esac", '  if [[ $values ]]; then', '    COMPREPLY=($(compgen -W "$values" -- "$current"))',
              '  elif [[ $current == -* ]]; then', '    COMPREPLY=($(compgen -W "$flags" -- "$current"))',
              "  fi", "}", "complete -o default -F _wavepath wavepath", ""]
    return "\n".join(lines)


def quoted(text):
    return text.replace("'", "’").replace("[", "(").replace("]", ")").replace(":", "\\:")


def zsh(program):
    commands = commands_of(program)
    lines = ["#compdef wavepath", "# Completion of wavepath; written by packaging/completion.py.", "_wavepath() {",
             "  local -a commands=("]
    lines += [f"    '{name}:{quoted(about)}'" for name, about in commands]
    lines += ["  )", "  if ((CURRENT == 2)); then", "    _describe command commands", "    return", "  fi",
              "  local command=$words[2]", "  shift words", "  ((CURRENT--))", "  case $command in"]
    for name, _ in commands:
        lines += [f"    {name})", "      _arguments \\"]
        for flag in read(program, name).flags():
            if not is_flag(flag):
                continue
            about = quoted(flag.text.split(". ")[0])
            value = flag.head.split(", ")[-1].partition(" ")[2]
            action = ""
            if flag.choices():
                action = f":value:({' '.join(words_of(flag))})"
            elif value:
                action = ":file:_files" if "FILE" in value else f":{quoted(value)}:"
            equals = "=" if value else ""
            lines += [f"        '*{long_name(flag)}{equals}[{about}]{action}' \\"]
        lines += ["        '*:file:_files'", "      ;;"]
    lines += ["  esac", "}", '_wavepath "$@"', ""]
    return "\n".join(lines)


if __name__ == "__main__":
    print({"bash": bash, "zsh": zsh}[sys.argv[2]](sys.argv[1]), end="")
