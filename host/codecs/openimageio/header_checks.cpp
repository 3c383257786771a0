// Adobe, "Photoshop File Formats Specification": a header of 26 bytes, then three sections, each behind its length.
// Microsoft, "Programming Guide for DDS": a header of 32 words, of 37 with that of DirectX 10, then the levels; and
// "Bitmap Header Types": offset of the pixels, then one of several headers, behind its length.
#include "host/codecs/openimageio/header_checks.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "host/codecs/image.h"

namespace wavepath {
namespace {

std::uint64_t big_endian(std::ifstream& file, int bytes) {
  std::uint64_t value = 0;
  for (int i = 0; i < bytes; ++i) value = value << 8 | static_cast<std::uint8_t>(file.get());
  if (!file) throw ImageError("is damaged or cut short (the file ends early)");
  return value;
}

std::uint64_t little_endian(std::ifstream& file, int bytes = 4) {
  std::uint64_t value = 0;
  for (int i = 0; i < bytes; ++i) value |= static_cast<std::uint64_t>(static_cast<std::uint8_t>(file.get())) << 8 * i;
  if (!file) throw ImageError("is damaged or cut short (the file ends early)");
  return value;
}

std::uint64_t size_of(const std::string& path) {
  std::error_code error;
  return std::filesystem::file_size(path, error);
}

// Channels of bitmap, grey, indexed, RGB and CMYK; multichannel is 7, duotone 8, Lab 9.
std::uint64_t least_channels(std::uint64_t mode) {
  constexpr std::array<std::uint64_t, 10> kChannels = {1, 1, 1, 3, 4, 0, 0, 3, 1, 3};
  if (mode >= kChannels.size() || kChannels[mode] == 0) throw ImageError("stores colours of an unknown mode");
  return kChannels[mode];
}

} // namespace

void check_photoshop(const std::string& path) {
  const std::uint64_t size = size_of(path);
  std::ifstream file(path, std::ios::binary);
  big_endian(file, 4); // the signature
  const bool large = big_endian(file, 2) == 2;
  file.ignore(6);
  const std::uint64_t channels = big_endian(file, 2);
  const std::uint64_t height = big_endian(file, 4), width = big_endian(file, 4), depth = big_endian(file, 2);
  if (channels < least_channels(big_endian(file, 2)) || channels > 56)
    throw ImageError("is damaged (it has " + std::to_string(channels) + " channels)");
  if (width == 0 || height == 0 || width > 300000 || height > 300000 || (depth != 1 && depth % 8 != 0) || depth > 32)
    throw ImageError("is damaged (its header tells no sound size)");
  for (int section = 0; section < 3; ++section) { // colours of the mode, resources, layers
    const std::uint64_t length = big_endian(file, large && section == 2 ? 8 : 4);
    const std::uint64_t at = static_cast<std::uint64_t>(file.tellg());
    if (at > size || length > size - at) throw ImageError("is damaged or cut short (a section ends behind the file)");
    file.seekg(static_cast<std::streamoff>(length), std::ios::cur);
  }
}

void check_dds(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<std::uint64_t, 33> words{}; // that behind the header is DXGI's format, where there is one
  for (std::size_t i = 0; i < 32; ++i) words[i] = little_endian(file);
  const std::uint64_t height = words[3], width = words[4], code = words[21], bits = words[22];
  const bool packed = (words[20] & 4) != 0; // blocks of 4 x 4
  constexpr std::uint64_t kDx10 = 0x30315844, kDxt1 = 0x31545844, kAti1 = 0x31495441, kBc4 = 0x55344342,
                          kBc4s = 0x53344342;
  std::uint64_t header = 128, block = 16;
  if (packed && code == kDx10) {
    words[32] = little_endian(file);
    header = 148;
    if ((words[32] >= 70 && words[32] <= 72) || (words[32] >= 79 && words[32] <= 81)) block = 8; // BC1, BC4
  } else if (code == kDxt1 || code == kAti1 || code == kBc4 || code == kBc4s) {
    block = 8;
  }
  if (width == 0 || height == 0 || width > 65536 || height > 65536 || (!packed && (bits < 8 || bits > 128)))
    throw ImageError("is damaged (its header tells no sound size)");
  const std::uint64_t bytes = packed ? (width + 3) / 4 * ((height + 3) / 4) * block : width * height * (bits / 8);
  if (size_of(path) < header + bytes) throw ImageError("is damaged or cut short (the file ends early)");
}

void check_bitmap(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  file.ignore(10);
  const std::uint64_t offset = little_endian(file);
  const bool old = little_endian(file) == 12; // of OS/2, with short sizes
  const std::uint64_t width = little_endian(file, old ? 2 : 4), signed_height = little_endian(file, old ? 2 : 4);
  little_endian(file, 2); // planes
  const std::uint64_t bits = little_endian(file, 2), compression = old ? 0 : little_endian(file);
  const std::uint64_t height =
      old || signed_height < 1u << 31 ? signed_height : (std::uint64_t{1} << 32) - signed_height;
  if (width == 0 || height == 0 || width >= 1u << 24 || height >= 1u << 24 || bits == 0 || bits > 32)
    throw ImageError("is damaged (its header tells no sound size)");
  const bool runs = compression == 1 || compression == 2; // two bytes stand for 255 pixels at the most
  const std::uint64_t bytes = runs ? width * height / 128 : (width * bits + 31) / 32 * 4 * height;
  if (size_of(path) < offset + bytes) throw ImageError("is damaged or cut short (the file ends early)");
}

} // namespace wavepath
