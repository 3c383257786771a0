"""The Blender add-on, run by the Blender of this machine without a window: see docs/blender.md.

    python3 tests/blender_test.py SOURCE WAVEPATH [SUITE [CASE ...]]

Ends with 77, which is a skipped test, where there is no Blender.
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

SUITES = ("lamps", "beside_cycles", "passes", "behaviour", "installed")


def run(blender, source, wavepath, suite, cases, folder):
    environment = {
        **os.environ,
        "WAVEPATH": wavepath,
        "WAVEPATH_SCRATCH": folder,
        "WAVEPATH_ADDON": str(source / "blender"),
        # Debian's Blender takes the modules of the first Python in PATH.
        "PATH": os.path.dirname(os.path.realpath(blender)) + os.pathsep + os.environ["PATH"],
        "BLENDER_USER_RESOURCES": folder + "/user",  # not the user's own settings and add-ons
        "BLENDER_USER_SCRIPTS": folder + "/user/scripts",
        "BLENDER_USER_CONFIG": folder + "/user/config",
        "BLENDER_USER_EXTENSIONS": folder + "/user/extensions",
    }
    for name in ("scripts/addons", "config", "extensions"):
        os.makedirs(folder + "/user/" + name, exist_ok=True)
    if suite == "installed":
        del environment["WAVEPATH_ADDON"]
        subprocess.run([sys.executable, source / "blender" / "make_zip.py", folder], check=True)
        later = version(blender) >= (4, 2)
        cases = [folder + "/wavepath_blender-%s.zip" % ("extension" if later else "addon")]
    script = source / "tests" / "blender" / (suite + ".py")
    begin = "import sys; sys.dont_write_bytecode = True; sys.path.insert(0, %r)" % str(script.parent)
    command = [blender, "--background", "--factory-startup", "--python-exit-code", "3", "--python-expr", begin,
               "--python", script, "--", *cases]
    ended = subprocess.run(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    lines = [line for line in ended.stdout.splitlines() if line.strip() and not line.startswith(("Fra:", "Saved"))]
    print("\n".join(lines), flush=True)
    # 3: the script failed. 1: its last render was stopped or failed, as some are meant to.
    return ended.returncode in (0, 1) and any(line.endswith(" DONE") for line in lines)


def version(blender):
    """(4, 3) of "Blender 4.3.2"."""
    told = subprocess.run([blender, "--version"], stdout=subprocess.PIPE, text=True, check=True).stdout
    line = next(line for line in told.splitlines() if line.startswith("Blender "))
    return tuple(map(int, line.split()[1].split(".")[:2]))


def main():
    source, wavepath = pathlib.Path(sys.argv[1]).resolve(), str(pathlib.Path(sys.argv[2]).resolve())
    blender = os.environ.get("BLENDER") or shutil.which("blender")
    if not blender:
        print("skipped: no Blender is installed (apt install blender)")
        return 77
    wanted = sys.argv[3:4] or SUITES
    failed = []
    for suite in wanted:
        with tempfile.TemporaryDirectory(prefix="wavepath-blender-") as folder:
            print("---- " + suite, flush=True)
            if not run(blender, source, wavepath, suite, sys.argv[4:], folder):
                failed.append(suite)
    print("failed: " + ", ".join(failed) if failed else "all passed")
    return 1 if failed else 0


sys.exit(main())
