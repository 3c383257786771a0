// A picture on its way to viewers: what it shows, in 32 bytes, and then an image file.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace wavepath {

enum class FrameFormat : std::uint16_t { jpeg = 1, png = 2 };

// As it goes over the wire, each value with its low byte first: eight words, the fourth and the sixth of two halves.
struct FrameHeader {
  std::uint32_t number = 0; // to be acknowledged
  std::uint32_t count = 0;  // Message::count of the last move that the picture shows
  std::uint32_t spp = 0;
  std::uint16_t coarse = 1; // a rendered pixel is this many pixels wide and high
  FrameFormat format = FrameFormat::jpeg;
  std::uint32_t done = 0;              // 1 = the picture has all its samples
  std::uint16_t width = 0, height = 0; // to be shown at; the image may be smaller
  float error = -1.0f;                 // estimated relative RMS error; below 0: not yet known
  float seconds = 0.0f;                // rendered
};
inline constexpr std::size_t kFrameHeaderBytes = 32;

std::string bytes_of(const FrameHeader& header);

// How well the image is stored: for a picture in motion; for one that converges; without loss.
enum class FrameQuality { motion, rendering, exact };

// The image file of `width` times `height` words, R first. Throws ImageError.
std::string encode_screen(std::span<const std::uint32_t> screen, std::uint32_t width, std::uint32_t height,
                          FrameQuality quality);

} // namespace wavepath
