#include "ktx/etc2.h"

#include <algorithm>
#include <array>

#include "ktx/block_bits.h"
#include "ktx/bytes.h"
#include "ktx/etc1.h"

namespace wavepath::ktx {
namespace {

using Rgb = std::array<int, 3>;

constexpr std::array<int, 8> kDistances = {3, 6, 11, 16, 23, 32, 41, 64};

constexpr std::array<std::array<std::int8_t, 8>, 16> kEacModifiers = {{{-3, -6, -9, -15, 2, 5, 8, 14},
                                                                       {-3, -7, -10, -13, 2, 6, 9, 12},
                                                                       {-2, -5, -8, -13, 1, 4, 7, 12},
                                                                       {-2, -4, -6, -13, 1, 3, 5, 12},
                                                                       {-3, -6, -8, -12, 2, 5, 7, 11},
                                                                       {-3, -7, -9, -11, 2, 6, 8, 10},
                                                                       {-4, -7, -8, -11, 3, 6, 7, 10},
                                                                       {-3, -5, -8, -11, 2, 4, 7, 10},
                                                                       {-2, -6, -8, -10, 1, 5, 7, 9},
                                                                       {-2, -5, -8, -10, 1, 4, 7, 9},
                                                                       {-2, -4, -8, -10, 1, 3, 7, 9},
                                                                       {-2, -5, -7, -10, 1, 4, 6, 9},
                                                                       {-3, -4, -7, -10, 2, 3, 6, 9},
                                                                       {-1, -2, -3, -10, 0, 1, 2, 9},
                                                                       {-4, -6, -8, -9, 3, 5, 7, 8},
                                                                       {-3, -5, -7, -9, 2, 4, 6, 8}}};

// `count` bits of the word, of which bit `first` is the lowest.
int field(std::uint64_t word, unsigned first, unsigned count) {
  return static_cast<int>(word >> first & ((std::uint64_t{1} << count) - 1));
}

int signed3(int value) { return (value ^ 4) - 4; }

// The two bits of the pixel index of texel (x, y). Texels are numbered by columns.
unsigned pixel_index(std::uint64_t word, unsigned x, unsigned y) {
  const unsigned i = 4 * x + y;
  return static_cast<unsigned>(field(word, i + 16, 1) << 1 | field(word, i, 1));
}

void put(std::uint8_t* rgba, unsigned x, unsigned y, const Rgb& color, int add) {
  std::uint8_t* texel = rgba + 4 * (4 * y + x);
  for (std::size_t c = 0; c < 3; ++c) texel[c] = clamp_to_byte(color[c] + add);
  texel[3] = 255;
}

void put_transparent(std::uint8_t* rgba, unsigned x, unsigned y) {
  std::fill_n(rgba + 4 * (4 * y + x), 4, std::uint8_t{0});
}

// Individual and differential blocks: a colour and a table of modifiers for each half. With `punches`, index 2 is a
// transparent texel, and the small modifiers are 0.
void decode_halves(std::uint64_t word, const Rgb& first, const Rgb& second, bool punches, std::uint8_t* rgba) {
  constexpr std::array<std::uint8_t, 4> kOrder = {2, 3, 1, 0}; // pixel index to +a, +b, -a, -b
  const bool flipped = field(word, 32, 1) != 0;
  const std::size_t tables[2] = {static_cast<std::size_t>(field(word, 37, 3)),
                                 static_cast<std::size_t>(field(word, 34, 3))};
  for (unsigned y = 0; y < 4; ++y) {
    for (unsigned x = 0; x < 4; ++x) {
      const bool is_second = (flipped ? y : x) >= 2;
      const unsigned index = pixel_index(word, x, y);
      if (punches && index == 2)
        put_transparent(rgba, x, y);
      else
        put(rgba, x, y, is_second ? second : first,
            punches && index == 0 ? 0 : kEtc1Modifiers[tables[is_second ? 1 : 0]][kOrder[index]]);
    }
  }
}

struct PaintColor {
  Rgb color;
  int add;
};

// T and H blocks: one of four colours.
void paint(std::uint64_t word, const std::array<PaintColor, 4>& colors, bool punches, std::uint8_t* rgba) {
  for (unsigned y = 0; y < 4; ++y) {
    for (unsigned x = 0; x < 4; ++x) {
      const unsigned index = pixel_index(word, x, y);
      if (punches && index == 2)
        put_transparent(rgba, x, y);
      else
        put(rgba, x, y, colors[index].color, colors[index].add);
    }
  }
}

Rgb color_444(int r, int g, int b) { return {widen4(r), widen4(g), widen4(b)}; }

Rgb second_color_444(std::uint64_t word) {
  return color_444(field(word, 44, 4), field(word, 40, 4), field(word, 36, 4));
}

void decode_t(std::uint64_t word, bool punches, std::uint8_t* rgba) {
  const Rgb first = color_444(field(word, 59, 2) << 2 | field(word, 56, 2), field(word, 52, 4), field(word, 48, 4));
  const Rgb second = second_color_444(word);
  const int d = kDistances[static_cast<std::size_t>(field(word, 34, 2) << 1 | field(word, 32, 1))];
  paint(word, {{{first, 0}, {second, d}, {second, 0}, {second, -d}}}, punches, rgba);
}

void decode_h(std::uint64_t word, bool punches, std::uint8_t* rgba) {
  const Rgb first = color_444(field(word, 59, 4), field(word, 56, 3) << 1 | field(word, 52, 1),
                              field(word, 51, 1) << 3 | field(word, 47, 3));
  const Rgb second = color_444(field(word, 43, 4), field(word, 39, 4), field(word, 35, 4));
  const int index = field(word, 34, 1) << 2 | field(word, 32, 1) << 1 | (first >= second ? 1 : 0);
  const int d = kDistances[static_cast<std::size_t>(index)];
  paint(word, {{{first, d}, {first, -d}, {second, d}, {second, -d}}}, punches, rgba);
}

void decode_planar(std::uint64_t word, std::uint8_t* rgba) {
  const Rgb origin = {widen6(field(word, 57, 6)), widen7(field(word, 56, 1) << 6 | field(word, 49, 6)),
                      widen6(field(word, 48, 1) << 5 | field(word, 43, 2) << 3 | field(word, 39, 3))};
  const Rgb across = {widen6(field(word, 34, 5) << 1 | field(word, 32, 1)), widen7(field(word, 25, 7)),
                      widen6(field(word, 19, 6))};
  const Rgb down = {widen6(field(word, 13, 6)), widen7(field(word, 6, 7)), widen6(field(word, 0, 6))};
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      Rgb color{};
      for (std::size_t c = 0; c < 3; ++c)
        color[c] = (x * (across[c] - origin[c]) + y * (down[c] - origin[c]) + 4 * origin[c] + 2) >> 2;
      put(rgba, static_cast<unsigned>(x), static_cast<unsigned>(y), color, 0);
    }
  }
}

// `punchthrough`: the bit of individual blocks says whether all texels are opaque, and there are no individual blocks.
void decode_rgb(std::uint64_t word, bool punchthrough, std::uint8_t* rgba) {
  const bool bit = field(word, 33, 1) != 0;
  if (!punchthrough && !bit) {
    const Rgb first = color_444(field(word, 60, 4), field(word, 52, 4), field(word, 44, 4));
    const Rgb second = color_444(field(word, 56, 4), field(word, 48, 4), field(word, 40, 4));
    return decode_halves(word, first, second, false, rgba);
  }
  const bool punches = punchthrough && !bit;
  Rgb base{}, sum{};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto first = 59 - 8 * static_cast<unsigned>(c);
    base[c] = field(word, first, 5);
    sum[c] = base[c] + signed3(field(word, first - 3, 3));
  }
  const auto overflows = [&](std::size_t c) { return sum[c] < 0 || sum[c] > 31; };
  if (overflows(0)) return decode_t(word, punches, rgba);
  if (overflows(1)) return decode_h(word, punches, rgba);
  if (overflows(2)) return decode_planar(word, rgba);
  decode_halves(word, {widen5(base[0]), widen5(base[1]), widen5(base[2])},
                {widen5(sum[0]), widen5(sum[1]), widen5(sum[2])}, punches, rgba);
}

// A block of one channel: base codeword, multiplier, and the modifier of texel (x, y).
struct EacBlock {
  std::uint64_t word;

  int base() const { return field(word, 56, 8); }
  int multiplier() const { return field(word, 52, 4); }
  int modifier(unsigned x, unsigned y) const {
    const std::size_t index = static_cast<std::size_t>(field(word, 45 - 3 * (4 * x + y), 3));
    return kEacModifiers[static_cast<std::size_t>(field(word, 48, 4))][index];
  }
  // Of 11 bits. A multiplier of 0 counts as an eighth.
  int step(unsigned x, unsigned y) const {
    return multiplier() > 0 ? modifier(x, y) * multiplier() * 8 : modifier(x, y);
  }
};

} // namespace

void decode_etc2_block(const std::uint8_t* block, std::uint8_t* rgba) { decode_rgb(big_u64_at(block), false, rgba); }

void decode_etc2_punchthrough_block(const std::uint8_t* block, std::uint8_t* rgba) {
  decode_rgb(big_u64_at(block), true, rgba);
}

void decode_etc2_rgba_block(const std::uint8_t* block, std::uint8_t* rgba) {
  decode_rgb(big_u64_at(block + 8), false, rgba);
  const EacBlock alpha{big_u64_at(block)};
  for (unsigned y = 0; y < 4; ++y)
    for (unsigned x = 0; x < 4; ++x)
      rgba[4 * (4 * y + x) + 3] = clamp_to_byte(alpha.base() + alpha.modifier(x, y) * alpha.multiplier());
}

void decode_eac_block(const std::uint8_t* block, unsigned channels, std::uint16_t* rgba) {
  for (unsigned i = 0; i < 16; ++i) {
    rgba[4 * i] = rgba[4 * i + 1] = rgba[4 * i + 2] = 0;
    rgba[4 * i + 3] = 65535;
  }
  for (unsigned c = 0; c < channels; ++c) {
    const EacBlock channel{big_u64_at(block + 8 * c)};
    for (unsigned y = 0; y < 4; ++y) {
      for (unsigned x = 0; x < 4; ++x) {
        const int value = std::clamp(channel.base() * 8 + 4 + channel.step(x, y), 0, 2047);
        rgba[4 * (4 * y + x) + c] = static_cast<std::uint16_t>((value << 5) + (value >> 6));
      }
    }
  }
}

void decode_signed_eac_block(const std::uint8_t* block, unsigned channels, float* rgba) {
  for (unsigned i = 0; i < 16; ++i) {
    rgba[4 * i] = rgba[4 * i + 1] = rgba[4 * i + 2] = 0.0f;
    rgba[4 * i + 3] = 1.0f;
  }
  for (unsigned c = 0; c < channels; ++c) {
    const EacBlock channel{big_u64_at(block + 8 * c)};
    const int base = std::max<int>(static_cast<std::int8_t>(channel.base()), -127);
    for (unsigned y = 0; y < 4; ++y)
      for (unsigned x = 0; x < 4; ++x)
        rgba[4 * (4 * y + x) + c] =
            static_cast<float>(std::clamp(base * 8 + channel.step(x, y), -1023, 1023)) / 1023.0f;
  }
}

} // namespace wavepath::ktx
