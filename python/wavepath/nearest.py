"""Answers a name that does not exist with the nearest one."""

from __future__ import annotations

import difflib
from typing import Sequence


def suggestion(name: str, names: Sequence[str]) -> str:
    near = difflib.get_close_matches(name, [one for one in names if one], 1)
    if near:
        return f"did you mean '{near[0]}'?"
    return f"choose from {', '.join(names)}" if names else "there are none"
