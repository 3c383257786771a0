"""Runs in a second Blender: writes a copy of the scene as glTF. ``main.py`` is where it begins."""
