// A decoded KTX2 picture: what read() returns.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace wavepath::ktx {

// The transfer function that the data format descriptor names.
enum class Transfer : std::uint8_t { linear, srgb, other };

// Level 0 of a 2D picture. Rows are in the order of the file, channels are interleaved RGBA. One of the arrays holds
// width * height * 4 values; the others are empty. Channels that the payload lacks are 0, and alpha is 1.
struct Picture {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> bytes;  // payloads of up to 8 bits, 0 to 255, in the encoding of the file
  std::vector<std::uint16_t> words; // unsigned normalized payloads of more bits, 0 to 65535
  std::vector<float> floats;        // floating-point and signed payloads: the values themselves
  Transfer transfer = Transfer::linear;
  bool premultiplied = false; // the descriptor says that colours are multiplied by alpha
  std::string payload;        // for people: "ETC1S", "BC7"
};

} // namespace wavepath::ktx
