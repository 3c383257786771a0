#include "ktx/bc.h"

#include <algorithm>
#include <array>

#include "ktx/bytes.h"

namespace wavepath::ktx {
namespace {

using BcColor = std::array<std::uint8_t, 4>;

// Thirds and halves of channels of 5 and 6 bits, as 8 bits: the fraction itself, rounded.
std::uint8_t mix(unsigned a, unsigned b, unsigned parts_a, unsigned parts_b, unsigned most) {
  const unsigned sum = (a * parts_a + b * parts_b) * 255, whole = (parts_a + parts_b) * most;
  return static_cast<std::uint8_t>((2 * sum + whole) / (2 * whole));
}

BcColor mix_565(unsigned a, unsigned b, unsigned parts_a, unsigned parts_b) {
  return {mix(a >> 11, b >> 11, parts_a, parts_b, 31), mix(a >> 5 & 63, b >> 5 & 63, parts_a, parts_b, 63),
          mix(a & 31, b & 31, parts_a, parts_b, 31), 255};
}

// `punches`: blocks whose first colour is not the greater one have a black or transparent texel.
void decode_colors(const std::uint8_t* block, bool punches, bool has_alpha, std::uint8_t* rgba) {
  const unsigned a = u16_at(block), b = u16_at(block + 2);
  std::array<BcColor, 4> colors = {mix_565(a, b, 1, 0), mix_565(a, b, 0, 1)};
  if (a > b || !punches) {
    colors[2] = mix_565(a, b, 2, 1);
    colors[3] = mix_565(a, b, 1, 2);
  } else {
    colors[2] = mix_565(a, b, 1, 1);
    colors[3] = {0, 0, 0, static_cast<std::uint8_t>(has_alpha ? 0 : 255)};
  }
  const std::uint32_t codes = u32_at(block + 4);
  for (unsigned i = 0; i < 16; ++i) std::ranges::copy(colors[codes >> (2 * i) & 3], rgba + 4 * i);
}

// The 48 bits of codes behind two values.
std::uint64_t codes_of(const std::uint8_t* block) { return u16_at(block + 2) | std::uint64_t{u32_at(block + 4)} << 16; }

// Eight values of a channel: two are stored, the others lie between them, or are the least and the greatest.
template <class Number, class Value, class Mix>
std::array<Value, 8> eight_values(Number first, Number second, Value least, Value greatest, const Mix& mixed) {
  std::array<Value, 8> values{mixed(1, 0, 1), mixed(0, 1, 1)};
  const int between = first > second ? 6 : 4;
  for (int i = 1; i <= between; ++i) values[static_cast<std::size_t>(i) + 1] = mixed(between + 1 - i, i, between + 1);
  if (between == 4) {
    values[6] = least;
    values[7] = greatest;
  }
  return values;
}

} // namespace

void decode_bc1_block(const std::uint8_t* block, bool has_alpha, std::uint8_t* rgba) {
  decode_colors(block, true, has_alpha, rgba);
}

void decode_bc2_block(const std::uint8_t* block, std::uint8_t* rgba) {
  decode_colors(block + 8, false, false, rgba);
  const std::uint64_t alpha = u64_at(block);
  for (unsigned i = 0; i < 16; ++i) rgba[4 * i + 3] = static_cast<std::uint8_t>((alpha >> (4 * i) & 15) * 17);
}

void decode_bc3_block(const std::uint8_t* block, std::uint8_t* rgba) {
  decode_colors(block + 8, false, false, rgba);
  const int a = block[0], b = block[1];
  const auto alphas = eight_values(a, b, std::uint8_t{0}, std::uint8_t{255}, [&](int parts_a, int parts_b, int whole) {
    return static_cast<std::uint8_t>((2 * (a * parts_a + b * parts_b) + whole) / (2 * whole));
  });
  const std::uint64_t codes = codes_of(block);
  for (unsigned i = 0; i < 16; ++i) rgba[4 * i + 3] = alphas[codes >> (3 * i) & 7];
}

void decode_rgtc_block(const std::uint8_t* block, unsigned channels, std::uint16_t* rgba) {
  for (unsigned i = 0; i < 16; ++i) {
    rgba[4 * i] = rgba[4 * i + 1] = rgba[4 * i + 2] = 0;
    rgba[4 * i + 3] = 65535;
  }
  for (unsigned c = 0; c < channels; ++c, block += 8) {
    const int a = block[0] * 257, b = block[1] * 257;
    const auto values =
        eight_values(a, b, std::uint16_t{0}, std::uint16_t{65535}, [&](int parts_a, int parts_b, int whole) {
          return static_cast<std::uint16_t>((2 * (a * parts_a + b * parts_b) + whole) / (2 * whole));
        });
    const std::uint64_t codes = codes_of(block);
    for (unsigned i = 0; i < 16; ++i) rgba[4 * i + c] = values[codes >> (3 * i) & 7];
  }
}

void decode_signed_rgtc_block(const std::uint8_t* block, unsigned channels, float* rgba) {
  for (unsigned i = 0; i < 16; ++i) {
    rgba[4 * i] = rgba[4 * i + 1] = rgba[4 * i + 2] = 0.0f;
    rgba[4 * i + 3] = 1.0f;
  }
  for (unsigned c = 0; c < channels; ++c, block += 8) {
    const int a = static_cast<std::int8_t>(block[0]), b = static_cast<std::int8_t>(block[1]);
    const auto values = eight_values(a, b, -1.0f, 1.0f, [&](int parts_a, int parts_b, int whole) {
      return static_cast<float>(std::max(a, -127) * parts_a + std::max(b, -127) * parts_b) /
             (127.0f * static_cast<float>(whole));
    });
    const std::uint64_t codes = codes_of(block);
    for (unsigned i = 0; i < 16; ++i) rgba[4 * i + c] = values[codes >> (3 * i) & 7];
  }
}

} // namespace wavepath::ktx
