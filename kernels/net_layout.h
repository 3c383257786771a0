// Whole nets: which pixel of every block is measured, that is, has a second net of samples. Compiled by kernels and
// host alike.
//
// A pixel's error is the less the more samples its net has: two halves of a net cost up to twice the squared error of
// the whole. So pixels keep their nets whole, and one in a block has a second one, scrambled independently, whose
// difference from the first measures the error of the block. A hash picks it, so that no pattern of the picture can
// hide from it.
//
// Places in waves, and so entries of the film, are those of all pixels in tile order, then those of second nets, block
// by block from the top left.
#ifndef WAVEPATH_NET_LAYOUT_H
#define WAVEPATH_NET_LAYOUT_H

#include "kernels/division.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

// Pixels of a block's side. From 262,144 pixels on larger blocks have 4,096 measured pixels as well, for 1.6 %
// more samples instead of 6.3 %; 2,048 are enough for the error of a picture (docs/error-and-stopping.md).
GPU_FUNCTION uint net_side(uint width, uint height) { return width * height < 1u << 18u ? 4u : 8u; }

// Blocks in a row, where `pixels` is the width, or in a column; the last one may be cut off by the border.
GPU_FUNCTION uint net_blocks(uint pixels, uint side) { return (pixels + side - 1u) / side; }

GPU_FUNCTION uint net_block_of(uvec2 pixel, uint width, uint height) {
  uint side = net_side(width, height);
  return pixel.y / side * net_blocks(width, side) + pixel.x / side;
}

// Of one word, in which every bit of it tells on every bit of the result: multiply, shift, twice.
GPU_FUNCTION uint net_hash(uint word) {
  word = (word ^ (word >> 16u)) * 0x9e3779b1u;
  word = (word ^ (word >> 15u)) * 0x85ebca6bu;
  return word ^ (word >> 13u);
}

// The pixel of a block that has the second net: each with the same chance.
GPU_FUNCTION uvec2 measured_pixel(uint block, uint width, uint height, uint seed) {
  uint side = net_side(width, height), across = net_blocks(width, side);
  uint row = divide(block, across), left = (block - row * across) * side, top = row * side;
  uint columns = width - left < side ? width - left : side, rows = height - top < side ? height - top : side;
  uint random = net_hash(block + net_hash(seed)) >> 16u;
  uint place = random * (columns * rows) >> 16u;
  uint down = divide_small(place, columns);
  return uvec2(left + (place - down * columns), top + down);
}

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
