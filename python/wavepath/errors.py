"""What wavepath raises."""

from __future__ import annotations

from typing import TYPE_CHECKING, Optional

if TYPE_CHECKING:
    from .result import Result


class Error(Exception):
    """A render, a file or a device failed.

    ``str(error)`` is ``FILE: PROBLEM; REMEDY``, as the command line prints it.

    >>> import wavepath
    >>> try:
    ...     wavepath.render("missing.glb")
    ... except wavepath.Error as error:
    ...     error.file, error.problem, error.remedy
    ('missing.glb', 'does not exist', 'check the name')
    """

    def __init__(self, file: str, problem: str, remedy: str) -> None:
        super().__init__(f"{file}: {problem}; {remedy}")
        self.file = file
        """The file, setting or device it is about."""
        self.problem = problem
        """What is wrong with it."""
        self.remedy = remedy
        """What the caller can do."""

    def __reduce__(self) -> tuple[type, tuple[str, str, str]]:
        return type(self), (self.file, self.problem, self.remedy)


class UsageError(Error, ValueError):
    """Arguments that make no sense, such as a setting that does not exist."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a render. ``result`` is the picture so far."""

    def __init__(self, result: Optional[Result] = None) -> None:
        super().__init__("interrupted; .result holds the picture so far")
        self.result = result
