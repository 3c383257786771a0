"""Packs the add-on: wavepath_blender-addon.zip for Blender 3.4 to 4.1, wavepath_blender-extension.zip for 4.2 and
later.

    python3 blender/make_zip.py [FOLDER]
"""

import pathlib
import sys
import zipfile

SOURCE = pathlib.Path(__file__).resolve().parent / "wavepath_blender"
MANIFEST = "blender_manifest.toml"


def pack(path, prefix, leave_out=()):
    """The same bits from the same files."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in sorted(SOURCE.rglob("*")):
            name = file.relative_to(SOURCE).as_posix()
            if file.suffix not in (".py", ".toml") or name in leave_out:
                continue
            entry = zipfile.ZipInfo(prefix + name)
            entry.external_attr = 0o644 << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, file.read_bytes())
        entry = zipfile.ZipInfo(prefix + "LICENSE")
        entry.external_attr = 0o644 << 16
        archive.writestr(entry, (SOURCE.parent.parent / "LICENSE").read_bytes())
    print(path)


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    pack(folder / "wavepath_blender-addon.zip", SOURCE.name + "/", (MANIFEST,))  # an add-on is a folder
    pack(folder / "wavepath_blender-extension.zip", "")  # an extension has its files at the top


main()
