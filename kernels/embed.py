#!/usr/bin/env python3
"""Embeds a SPIR-V module as a C array, its floating-point arithmetic marked NoContraction: embed.py IN.spv NAME OUT.h

Without the mark a driver may fuse, reassociate or cancel terms, and does so differently in each specialization of a
kernel: generic and specialized kernels then differ in the last bit. With it, what is written is what is computed,
everywhere.
"""

import struct
import sys

NO_CONTRACTION = 42
OP_DECORATE, OP_MEMBER_DECORATE = 71, 72
# OpFNegate, OpFAdd, OpFSub, OpFMul, OpFDiv, OpFRem, OpFMod, OpVectorTimesScalar, OpDot
ARITHMETIC = {127, 129, 131, 133, 136, 140, 141, 142, 148}
HEADER_WORDS = 5


def instructions(words):
    """(position, opcode, length) of every instruction."""
    at = HEADER_WORDS
    while at < len(words):
        length = words[at] >> 16
        yield at, words[at] & 0xFFFF, length
        at += length


def mark(words):
    marked, results, end_of_decorations = set(), [], None
    for at, opcode, length in instructions(words):
        if opcode == OP_DECORATE and words[at + 2] == NO_CONTRACTION:
            marked.add(words[at + 1])
        if opcode in (OP_DECORATE, OP_MEMBER_DECORATE):
            end_of_decorations = at + length
        if opcode in ARITHMETIC:
            results.append(words[at + 2])
    added = []
    for result in results:
        if result not in marked:
            added += [3 << 16 | OP_DECORATE, result, NO_CONTRACTION]
    return words[:end_of_decorations] + added + words[end_of_decorations:]


def main(source, name, header):
    data = open(source, "rb").read()
    words = mark(list(struct.unpack(f"<{len(data) // 4}I", data)))
    lines = [", ".join(f"0x{word:08x}" for word in words[i:i + 8]) for i in range(0, len(words), 8)]
    with open(header, "w", encoding="ascii") as file:
        file.write(f"#pragma once\nconst uint32_t {name}[] = {{\n" + ",\n".join(lines) + "};\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
