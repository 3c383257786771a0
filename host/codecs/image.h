// A picture as its file stores it: shape and samples, whatever the format; and what is wrong with a file that has none.
#pragma once

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <vector>

namespace wavepath {

struct ImageShape {
  std::uint32_t width = 0, height = 0; // at least 1
  std::uint32_t channels = 0;          // 1 grey, 2 grey and alpha, 3 RGB, 4 RGBA

  std::uint64_t pixels() const { return std::uint64_t{width} * height; }
};

// Rows from the top, channels interleaved, alpha not multiplied in. What the format stores decides which of the two
// holds width * height * channels values; the other is empty.
struct DecodedImage {
  ImageShape shape;
  std::vector<std::uint8_t> bytes;  // PNG of up to 8 bits, JPEG, WebP: 0 to 255, in the file's own encoding
  std::vector<std::uint16_t> words; // PNG of 16 bits: 0 to 65535
};

// A file that cannot be decoded. what() continues a sentence about it: "is damaged or cut short (IDAT: CRC error)".
struct ImageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Decoders call it with what the header says, before they take memory for pixels; it throws to refuse.
using CheckShape = std::function<void(const ImageShape&)>;

// Room for the samples of a whole picture. Four channels are reserved, which costs nothing until it is written to, so
// that textures become RGBA where they lie.
template <class Sample>
Sample* reserve(std::vector<Sample>& samples, const ImageShape& shape) {
  samples.reserve(shape.pixels() * 4);
  samples.resize(shape.pixels() * shape.channels);
  return samples.data();
}

} // namespace wavepath
