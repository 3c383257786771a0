#!/usr/bin/env python3
"""Writes a house full of lamps, most of them hidden from the camera, as one .glb; the same bytes for the same numbers.

10,000 lights make a file of about 2 MB. Too large to commit, so it is made when needed.
"""

import argparse
import pathlib

from rooms import many_lights


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=pathlib.Path, metavar="FILE.glb")
    parser.add_argument("--count", type=int, default=10000, help="lights [default: 10000]")
    parser.add_argument("--seed", type=int, default=0, help="another house [default: 0]")
    parser.add_argument("--punctual", type=float, default=0.1, metavar="SHARE",
                        help="of lights that are points and spots instead of small emissive bodies [default: 0.1]")
    parser.add_argument("--rooms", type=int, default=4, help="along each side of the house [default: 4]")
    args = parser.parse_args()
    if args.count < 1 or args.rooms < 1 or not 0 <= args.punctual <= 1:
        parser.error("--count and --rooms must be positive, --punctual from 0 to 1")
    scene = many_lights(args.count, args.seed, args.punctual, args.rooms)
    args.file.parent.mkdir(parents=True, exist_ok=True)
    args.file.write_bytes(scene.binary())
    print(f"{args.file}: {args.count} lights, {args.rooms * args.rooms} rooms")


if __name__ == "__main__":
    main()
