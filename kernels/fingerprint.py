#!/usr/bin/env python3
"""Writes a number that changes with any of the kernels, to tell caches of one build from those of another:
fingerprint.py OUT.h EMBEDDED.h..."""

import hashlib
import sys


def main(header, *embedded):
    digest = hashlib.sha256()
    for path in embedded:
        digest.update(open(path, "rb").read())
    with open(header, "w", encoding="ascii") as file:
        file.write(f"#pragma once\ninline constexpr const char* kKernelsFingerprint = \"{digest.hexdigest()}\";\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
