// Adobe, "Photoshop File Formats Specification": a header of 26 bytes, then three sections, each behind its length.
#include "host/pictures/photoshop.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "host/images/image.h"

namespace wavepath {
namespace {

std::uint64_t big_endian(std::ifstream& file, int bytes) {
  std::uint64_t value = 0;
  for (int i = 0; i < bytes; ++i) value = value << 8 | static_cast<std::uint8_t>(file.get());
  if (!file) throw ImageError("is damaged or cut short (the file ends early)");
  return value;
}

// Of bitmap, grey, indexed, RGB and CMYK; multichannel is 7, duotone 8, Lab 9.
std::uint64_t least_channels(std::uint64_t mode) {
  constexpr std::array<std::uint64_t, 10> kChannels = {1, 1, 1, 3, 4, 0, 0, 3, 1, 3};
  if (mode >= kChannels.size() || kChannels[mode] == 0) throw ImageError("stores colours of an unknown mode");
  return kChannels[mode];
}

} // namespace

void check_photoshop(const std::string& path) {
  std::error_code error;
  const std::uint64_t size = std::filesystem::file_size(path, error);
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

} // namespace wavepath
