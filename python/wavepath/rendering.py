"""Runs a render: progress, interrupts, results."""

from __future__ import annotations

from typing import Any, Callable, Optional, Union

from . import _core
from .errors import Interrupted
from .result import Result

Progress = _core.Progress
ProgressArgument = Union[None, bool, Callable[[_core.Progress], Optional[bool]]]


class _Bar:
    """A bar of tqdm, which is one in notebooks too; without tqdm, nothing."""

    def __init__(self) -> None:
        try:
            from tqdm.auto import tqdm  # type: ignore[import]
        except ImportError:
            self._bar = None
            return
        self._bar = tqdm(total=1.0, bar_format="{l_bar}{bar}| {elapsed}<{remaining}{postfix}", leave=False)

    def __call__(self, progress: _core.Progress) -> None:
        if self._bar is None:
            return
        error = f", error {100 * progress.error:.2g} %" if progress.error > 0 else ""
        self._bar.set_postfix_str(f"{progress.spp} spp{error}", refresh=False)
        self._bar.update(progress.fraction - self._bar.n)

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()


def run(render: Callable[..., tuple[_core.Result, Any]], progress: ProgressArgument, **hooks: Any) -> Result:
    """Call ``render(progress=...)``, and raise what a callback or Ctrl-C raised."""
    bar = _Bar() if progress is True else None
    callback = bar if bar is not None else progress if callable(progress) else None
    try:
        core, thrown = render(progress=callback, **hooks)
    finally:
        if bar is not None:
            bar.close()
    result = Result(core)
    if isinstance(thrown, KeyboardInterrupt) and not isinstance(thrown, Interrupted):
        raise Interrupted(result) from None
    if thrown is not None:
        raise thrown
    return result
