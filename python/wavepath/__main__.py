"""The command line: ``python3 -m wavepath render scene.glb -o a.exr`` is ``wavepath render scene.glb -o a.exr``."""

import sys

from wavepath import _core


def main() -> int:
    import signal

    signal.signal(signal.SIGINT, signal.SIG_DFL)  # the command line handles it itself
    return _core.command_line(["wavepath", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
