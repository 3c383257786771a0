"""Where the program wavepath is."""

import os
import shutil

import bpy

from . import settings


class Missing(Exception):
    pass


def find():
    """From the preferences, WAVEPATH, or PATH."""
    preferences = settings.preferences()
    chosen = preferences.program if preferences else ""
    chosen = bpy.path.abspath(chosen) if chosen else os.environ.get("WAVEPATH", "")
    if chosen:
        if os.path.isfile(chosen) and os.access(chosen, os.X_OK):
            return chosen
        raise Missing("%s: is no program; choose wavepath in Preferences > Add-ons > wavepath" % chosen)
    found = shutil.which("wavepath")
    if not found:
        raise Missing("wavepath is not installed; install it, or choose it in Preferences > Add-ons > wavepath")
    return found
