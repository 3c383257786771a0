// Tile order: an order of pixels that keeps neighbours together. Waves visit pixels in 8x8 tiles, in Z-order inside a
// tile (Morton 1966), so that neighbouring lanes trace neighbouring rays. Compiled by kernels and host alike.
//
//     within a complete tile                        tiles of a picture of 20x12 pixels: first index of each
//      0  1 |  4  5 | 16 17 | 20 21                 +--------+--------+----+
//      2  3 |  6  7 | 18 19 | 22 23                 | 0      | 64     |128 |
//     ------+-------+-------+------                 | 8x8    | 8x8    |4x8 |   a tile that the border cuts is visited
//      8  9 | 12 13 | 24 25 | 28 29                 +--------+--------+----+   row by row
//     10 11 | 14 15 | 26 27 | 30 31                 |160 8x4 |192 8x4 |224 |
//     ------+-------+-------+------                 +--------+--------+----+
//     32 33 | 36 37 | 48 49 | 52 53
//     34 35 | 38 39 | 50 51 | 54 55                 Four consecutive indices, counted from 0, are a quad: a square of
//     ------+-------+-------+------                 2x2 in a complete tile.
//     40 41 | 44 45 | 56 57 | 60 61
//     42 43 | 46 47 | 58 59 | 62 63
#ifndef WAVEPATH_TILE_ORDER_H
#define WAVEPATH_TILE_ORDER_H

#include "kernels/base/division.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

// Coordinates of the pixel with the given index in tile order, 0 <= index < width * height. Tiles cut off by the right
// or lower border are visited row by row.
GPU_FUNCTION uvec2 pixel_in_tile_order(uint index, uint width, uint height) {
  uint tile_row = divide(index, 8u * width);
  uint in_row = index - tile_row * 8u * width;
  uint rows = height - 8u * tile_row < 8u ? height - 8u * tile_row : 8u;
  uint tile_column = divide_small(in_row, 8u * rows);
  uint in_tile = in_row - tile_column * 8u * rows;
  uint columns = width - 8u * tile_column < 8u ? width - 8u * tile_column : 8u;
  uint y = divide_small(in_tile, columns);
  uint x = in_tile - y * columns;
  if (rows == 8u && columns == 8u) {
    x = (in_tile & 1u) | ((in_tile >> 1u) & 2u) | ((in_tile >> 2u) & 4u);
    y = ((in_tile >> 1u) & 1u) | ((in_tile >> 2u) & 2u) | ((in_tile >> 3u) & 4u);
  }
  return uvec2(8u * tile_column + x, 8u * tile_row + y);
}

// The inverse of pixel_in_tile_order().
GPU_FUNCTION uint tile_order_of(uvec2 pixel, uint width, uint height) {
  uint tile_row = pixel.y / 8u, tile_column = pixel.x / 8u;
  uint rows = height - 8u * tile_row < 8u ? height - 8u * tile_row : 8u;
  uint columns = width - 8u * tile_column < 8u ? width - 8u * tile_column : 8u;
  uint x = pixel.x % 8u, y = pixel.y % 8u;
  uint in_tile = y * columns + x;
  if (rows == 8u && columns == 8u)
    in_tile = (x & 1u) | ((y & 1u) << 1u) | ((x & 2u) << 1u) | ((y & 2u) << 2u) | ((x & 4u) << 2u) | ((y & 4u) << 3u);
  return tile_row * 8u * width + tile_column * 8u * rows + in_tile;
}

// Texels lie in tiles of sixteen, which a cache line holds. An image alone has tiles of 4x4: a filtered look-up
// touches 1.6 lines on average instead of 2.1. Images that are looked up together lie side by side, 2^beside of them:
// each has 4x2 or 2x2 of a tile, and all of them together take 1.9 or 2.3 lines. Index of texel (x, y) of the first of
// them, counted in all texels; the others follow 16 >> beside further on, each. And how many texels they take: their
// right and lower border are filled up to whole tiles.
GPU_FUNCTION uint tile_shift_x(uint beside) { return beside == 2u ? 1u : 2u; }
GPU_FUNCTION uint tile_shift_y(uint beside) { return beside == 0u ? 2u : 1u; }
GPU_FUNCTION uint tiles_of(uint side, uint shift) { return (side + (1u << shift) - 1u) >> shift; }
GPU_FUNCTION uint texel_index(uint x, uint y, uint width, uint beside) {
  uint shift_x = tile_shift_x(beside), shift_y = tile_shift_y(beside);
  uint tile = (y >> shift_y) * tiles_of(width, shift_x) + (x >> shift_x);
  return tile * 16u + ((y & ((1u << shift_y) - 1u)) << shift_x) + (x & ((1u << shift_x) - 1u));
}
GPU_FUNCTION uint texel_count(uint width, uint height, uint beside) {
  return tiles_of(width, tile_shift_x(beside)) * tiles_of(height, tile_shift_y(beside)) * 16u;
}

// Side of an image at a mip level; level 0 is the image itself.
GPU_FUNCTION uint mip_size(uint side, uint level) { return side >> level > 0u ? side >> level : 1u; }

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
