// Whole nets: which pixel of every block of 4x4 is measured, that is, has a second net of samples. Compiled by kernels and
// host alike.
//
// A pixel's error is the less the more samples its net has: two halves of a net cost up to twice the squared error of the
// whole. So pixels keep their nets whole, and one in a block has a second one, scrambled independently, whose difference
// from the first measures the error of the block. A hash picks it, so that no pattern of the picture can hide from it.
//
// Places in waves, and so entries of the film, are those of all pixels in tile order, then those of second nets, block by
// block from the top left.
#ifndef WAVEPATH_NET_LAYOUT_H
#define WAVEPATH_NET_LAYOUT_H

#ifdef __cplusplus
#include <glm/glm.hpp>
#define GPU_FUNCTION inline
namespace wavepath::gpu {
using uint = unsigned int;
using glm::uvec2;
#else
#define GPU_FUNCTION
#endif

// Blocks in a row, where `pixels` is the width, or in a column; the last one may be cut off by the border.
GPU_FUNCTION uint net_blocks(uint pixels) { return (pixels + 3u) / 4u; }

GPU_FUNCTION uint net_block_of(uvec2 pixel, uint width) { return pixel.y / 4u * net_blocks(width) + pixel.x / 4u; }

// Of one word, in which every bit of it tells on every bit of the result: multiply, shift, twice.
GPU_FUNCTION uint net_hash(uint word) {
  word = (word ^ (word >> 16u)) * 0x9e3779b1u;
  word = (word ^ (word >> 15u)) * 0x85ebca6bu;
  return word ^ (word >> 13u);
}

// The pixel of a block that has the second net: each with the same chance.
GPU_FUNCTION uvec2 measured_pixel(uint block, uint width, uint height, uint seed) {
  uint across = net_blocks(width), left = block % across * 4u, top = block / across * 4u;
  uint columns = width - left < 4u ? width - left : 4u, rows = height - top < 4u ? height - top : 4u;
  uint random = net_hash(block + net_hash(seed)) >> 16u;
  uint place = random * (columns * rows) >> 16u;
  return uvec2(left + place % columns, top + place / columns);
}

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
