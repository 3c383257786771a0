#include "ktx/plain.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include <tbb/parallel_for.h>

#include "ktx/bytes.h"
#include "ktx/half.h"

namespace wavepath::ktx {
namespace {

using Bytes = std::span<const std::uint8_t>;

// Spreads channels of `size` bytes over RGBA. `read` gets the first byte of one.
template <class Sample, class Read>
void spread_channels(const Format& format, Bytes data, const Picture& picture, std::vector<Sample>& samples, Sample one,
                     std::size_t size, const Read& read) {
  const std::size_t width = picture.width;
  samples.resize(width * picture.height * 4);
  tbb::parallel_for(std::size_t{0}, std::size_t{picture.height}, [&](std::size_t y) {
    const std::uint8_t* in = &data[y * width * format.block_bytes];
    Sample* out = &samples[y * width * 4];
    for (std::size_t x = 0; x < width; ++x, out += 4, in += format.block_bytes) {
      out[1] = out[2] = Sample{0};
      out[3] = one;
      for (std::size_t c = 0; c < format.channels; ++c) out[c] = read(in + c * size);
      if (format.bgr) std::swap(out[0], out[2]);
    }
  });
}

// Texels of 32 bits that hold three small floats.
template <class Unpack>
void unpack_words(Bytes data, Picture& picture, const Unpack& unpack) {
  const std::size_t count = std::size_t{picture.width} * picture.height;
  picture.floats.resize(count * 4);
  for (std::size_t i = 0; i < count; ++i) {
    const std::array<float, 3> color = unpack(u32_at(&data[4 * i]));
    std::ranges::copy(color, &picture.floats[4 * i]);
    picture.floats[4 * i + 3] = 1.0f;
  }
}

std::array<float, 3> from_shared_exponent(std::uint32_t word) {
  const float scale = std::bit_cast<float>(((word >> 27) + 103) << 23); // 2^(exponent - 15 - 9)
  return {static_cast<float>(word & 511) * scale, static_cast<float>(word >> 9 & 511) * scale,
          static_cast<float>(word >> 18 & 511) * scale};
}

std::array<float, 3> from_small_floats(std::uint32_t word) {
  return {small_float(word & 0x7ff, 6), small_float(word >> 11 & 0x7ff, 6), small_float(word >> 22, 5)};
}

} // namespace

bool decode_plain(const Format& format, Bytes data, Picture& picture) {
  switch (format.coding) {
    case Coding::bytes:
      spread_channels(format, data, picture, picture.bytes, std::uint8_t{255}, 1,
                      [](const std::uint8_t* p) { return *p; });
      return true;
    case Coding::words:
      spread_channels(format, data, picture, picture.words, std::uint16_t{65535}, 2, u16_at);
      return true;
    case Coding::signed_bytes:
      spread_channels(format, data, picture, picture.floats, 1.0f, 1, [](const std::uint8_t* p) {
        return std::max(static_cast<float>(static_cast<std::int8_t>(*p)) / 127.0f, -1.0f);
      });
      return true;
    case Coding::signed_words:
      spread_channels(format, data, picture, picture.floats, 1.0f, 2, [](const std::uint8_t* p) {
        return std::max(static_cast<float>(static_cast<std::int16_t>(u16_at(p))) / 32767.0f, -1.0f);
      });
      return true;
    case Coding::halves:
      spread_channels(format, data, picture, picture.floats, 1.0f, 2,
                      [](const std::uint8_t* p) { return float_of_half(u16_at(p)); });
      return true;
    case Coding::floats:
      spread_channels(format, data, picture, picture.floats, 1.0f, 4,
                      [](const std::uint8_t* p) { return std::bit_cast<float>(u32_at(p)); });
      return true;
    case Coding::shared_exponent:
      unpack_words(data, picture, from_shared_exponent);
      return true;
    case Coding::small_floats:
      unpack_words(data, picture, from_small_floats);
      return true;
    default:
      return false;
  }
}

} // namespace wavepath::ktx
