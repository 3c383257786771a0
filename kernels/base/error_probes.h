// Error probes: one pixel of every block has a second replicate of its samples. Compiled by kernels and host alike.
//
// A replicate is a stream of samples that is scrambled independently of others. The difference of two replicates of a
// pixel measures its error. But one replicate of all samples has less error than two of half the samples, whose mean
// has up to twice its squared error. So every pixel has one replicate of all samples, and one pixel in a block, the
// probed pixel, has a second one as long: the error probe of the block. A hash picks the probed pixel, so that no
// pattern of the picture can hide from it.
//
//     by pixels: blocks of 4x4, probed pixels #         by quads: tile blocks of 8x8, probed quads ##
//     . . . . | . . # . | . . . .                       . . . . . . . . | . . . . . . . .
//     . # . . | . . . . | . . . .                       . . . . . . . . | . . . . . . . .
//     . . . . | . . . . | # . . .                       . . # # . . . . | . . . . . . . .
//     . . . . | . . . . | . . . .                       . . # # . . . . | . . . . . . . .    (4 of 8 rows)
//
// Four neighbouring pixels that share samples err alike, and their probes must share among themselves as well. So such
// pictures are probed by quads. A quad is four consecutive pixels in tile order, counted from the first of the picture:
// a square of 2x2 in a complete tile. It always lies within one tile, since tiles begin at multiples of eight. A tile
// block is one tile, or four side by side; the hash picks one of its quads, and all four pixels of that are probed.
// Pixels of equal rank in their quads, 0 to 3, are a block: the four blocks of a tile block lie in one another, and
// each has one probed pixel.
//
// Entries of the film are all pixels in tile order, then the probes, block by block from the top left. By quads, probes
// of a tile block follow each other, so that they form quads as well. The last quad of the picture may be incomplete
// (1 to 3 pixels). It is probed only if its tile block contains no other quad; the last quad of probes then has the
// same number of entries.
#ifndef WAVEPATH_ERROR_PROBES_H
#define WAVEPATH_ERROR_PROBES_H

#include "kernels/base/division.h"
#include "kernels/base/tile_order.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

// Pixels that have probes (Frame::probes, DisplayJob). None: samples of every pixel are split between its two
// replicates. Pixels: one pixel of each block. Quads: one quad of each tile block.
GPU_CONSTANT uint kProbesNone = 0u, kProbesPixels = 1u, kProbesQuads = 2u;
GPU_CONSTANT uint kQuadPixels = 4u;

// Side of a block in pixels. From 262,144 pixels on, larger blocks still give 4,096 probes, for 1.6 % more samples
// instead of 6.3 %; 2,048 suffice for the error of a picture (docs/error-and-stopping.md).
GPU_FUNCTION uint probe_block_side(uint width, uint height) { return width * height < 1u << 18u ? 4u : 8u; }

// Number of blocks in a row, if `pixels` is the width, or in a column. The border may cut the last block.
GPU_FUNCTION uint probe_blocks(uint pixels, uint side) { return (pixels + side - 1u) / side; }

// Log2 of the width of a tile block, and their number in a row. A tile block is 8 or 32 pixels wide, so that it has as
// many pixels for each probe as a block has.
GPU_FUNCTION uint tile_block_shift(uint width, uint height) { return probe_block_side(width, height) == 4u ? 3u : 5u; }
GPU_FUNCTION uint tile_blocks_across(uint width, uint height) {
  uint shift = tile_block_shift(width, height);
  return (width + (1u << shift) - 1u) >> shift;
}

// The pixels of a tile block, consecutive in tile order.
struct TileBlock {
  uint first;
  uint pixels;
};
GPU_FUNCTION TileBlock tile_block(uint index, uint width, uint height) {
  uint whole = 1u << tile_block_shift(width, height), across = tile_blocks_across(width, height);
  uint row = divide(index, across), left = (index - row * across) * whole;
  uint columns = width - left < whole ? width - left : whole;
  uint rows = height - 8u * row < 8u ? height - 8u * row : 8u;
  TileBlock block;
  block.first = row * 8u * width + left * rows;
  block.pixels = columns * rows;
  return block;
}

// The rectangle of a picture that a film holds: all of it, or a part (--crop). A film that kernels fill is cut at the
// borders of tiles and of tile blocks, so that tiles, quads and blocks are those of the whole picture.
struct FilmArea {
  uint left;
  uint top;
  uint width;
  uint height;
  uint whole_width;
  uint whole_height;
};
GPU_FUNCTION FilmArea whole_area(uint width, uint height) {
  FilmArea area;
  area.left = area.top = 0u;
  area.width = area.whole_width = width;
  area.height = area.whole_height = height;
  return area;
}

// Log2 of the sides of a block, or of a tile block where probes are by quads.
GPU_FUNCTION uint probe_shift_x(FilmArea area, uint probes) {
  if (probes == kProbesQuads) return tile_block_shift(area.whole_width, area.whole_height);
  return probe_block_side(area.whole_width, area.whole_height) == 4u ? 2u : 3u;
}
GPU_FUNCTION uint probe_shift_y(FilmArea area, uint probes) {
  return probes == kProbesQuads || probe_block_side(area.whole_width, area.whole_height) == 8u ? 3u : 2u;
}

// Number of blocks that `pixels` pixels touch, from pixel `first` of the picture on.
GPU_FUNCTION uint blocks_touched(uint first, uint pixels, uint shift) {
  return ((first + pixels - 1u) >> shift) - (first >> shift) + 1u;
}

// Blocks of an area are numbered row by row, as those of a picture: the number of a block in the whole picture.
GPU_FUNCTION uint block_in_picture(uint block, FilmArea area, uint probes) {
  if (area.width == area.whole_width && area.height == area.whole_height) return block;
  uint each = probes == kProbesQuads ? kQuadPixels : 1u, rank = block & (each - 1u);
  uint x = probe_shift_x(area, probes), y = probe_shift_y(area, probes);
  uint index = divide(block, each), across = blocks_touched(area.left, area.width, x), row = divide(index, across);
  uint whole =
      (row + (area.top >> y)) * blocks_touched(0u, area.whole_width, x) + index - row * across + (area.left >> x);
  return whole * each + rank;
}

// Number of probes of the upper `rows` of an area, which must be all rows or end with a row of tiles.
GPU_FUNCTION uint probes_above(uint rows, FilmArea area, uint probes) {
  if (probes == kProbesNone) return 0u;
  uint blocks = blocks_touched(area.top, rows, probe_shift_y(area, probes)) *
                blocks_touched(area.left, area.width, probe_shift_x(area, probes));
  if (probes == kProbesPixels) return blocks;
  uint index = block_in_picture(kQuadPixels * (blocks - 1u), area, probes) / kQuadPixels;
  uint last = tile_block(index, area.whole_width, area.whole_height).pixels;
  return kQuadPixels * (blocks - 1u) + (last < kQuadPixels ? last : kQuadPixels);
}

// For probing by quads: the rank of an entry in its quad, in a picture of so many pixels; and the number of entries of
// that quad.
GPU_FUNCTION uint rank_in_quad(uint entry, uint pixels) {
  return (entry < pixels ? entry : entry - pixels) & (kQuadPixels - 1u);
}
GPU_FUNCTION uint quad_entries(uint entry, FilmArea area) {
  uint pixels = area.width * area.height;
  uint end = entry < pixels ? pixels : pixels + probes_above(area.height, area, kProbesQuads);
  uint left = end - entry + rank_in_quad(entry, pixels);
  return left < kQuadPixels ? left : kQuadPixels;
}
GPU_FUNCTION uint quad_entries(uint entry, uint width, uint height) {
  return quad_entries(entry, whole_area(width, height));
}

GPU_FUNCTION uint probe_block_of(uvec2 pixel, uint width, uint height, uint probes) {
  if (probes == kProbesQuads) {
    uint block = pixel.y / 8u * tile_blocks_across(width, height) + (pixel.x >> tile_block_shift(width, height));
    return block * kQuadPixels + rank_in_quad(tile_order_of(pixel, width, height), width * height);
  }
  uint side = probe_block_side(width, height);
  return pixel.y / side * probe_blocks(width, side) + pixel.x / side;
}

// Hash of one word: every input bit affects every output bit (multiply and shift, twice).
GPU_FUNCTION uint probe_hash(uint word) {
  word = (word ^ (word >> 16u)) * 0x9e3779b1u;
  word = (word ^ (word >> 15u)) * 0x85ebca6bu;
  return word ^ (word >> 13u);
}

// First pixel, in tile order, of the probed quad of a tile block. Each complete quad has the same probability.
GPU_FUNCTION uint probed_quad(uint index, uint width, uint height, uint seed) {
  TileBlock block = tile_block(index, width, height);
  uint random = probe_hash(index + probe_hash(seed)) >> 16u;
  return block.first + (random * (block.pixels / kQuadPixels) >> 16u) * kQuadPixels;
}

// The probed pixel of a block. Each pixel has the same probability, except up to three of an incomplete quad, which
// have none.
GPU_FUNCTION uvec2 probed_pixel(uint block, uint width, uint height, uint seed, uint probes) {
  if (probes == kProbesQuads) {
    uint first = probed_quad(block / kQuadPixels, width, height, seed);
    return pixel_in_tile_order(first + block % kQuadPixels, width, height);
  }
  uint side = probe_block_side(width, height), across = probe_blocks(width, side);
  uint row = divide(block, across), left = (block - row * across) * side, top = row * side;
  uint columns = width - left < side ? width - left : side, rows = height - top < side ? height - top : side;
  uint random = probe_hash(block + probe_hash(seed)) >> 16u;
  uint index = random * (columns * rows) >> 16u;
  uint down = divide_small(index, columns);
  return uvec2(left + (index - down * columns), top + down);
}

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
