// Reads the container as the KTX 2.0 specification lays it out. Offsets and lengths are those of sections "Index" and
// "Data Format Descriptor"; none is used before it was compared with the length of the file.
#include "ktx/container.h"

#include <algorithm>
#include <bit>
#include <string>
#include <string_view>

#include "ktx/bytes.h"
#include "ktx/error.h"

namespace wavepath::ktx {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::array<std::uint8_t, 12> kIdentifier = {0xab, 'K', 'T', 'X', ' ', '2', '0', 0xbb, '\r', '\n', 0x1a, '\n'};
constexpr std::size_t kHeaderLength = 80, kLevelLength = 24;

// A part of the file. Sums cannot overflow: the length is compared with what the file has behind the offset.
Bytes part(Bytes file, std::uint64_t offset, std::uint64_t length, const char* name) {
  if (offset > file.size() || length > file.size() - offset)
    fail_damaged(std::string(name) + " lies beyond the end of the file");
  return file.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
}

void refuse_other_shapes(std::uint32_t width, std::uint32_t height, std::uint32_t depth, std::uint32_t layers,
                         std::uint32_t faces) {
  if (width == 0) fail_damaged("its width is 0");
  if (faces == 6) throw FileError("is a cube map, not a 2D picture");
  if (faces != 1) fail_damaged("it has " + std::to_string(faces) + " faces");
  if (height == 0) throw FileError("is a 1D texture, not a 2D picture");
  if (depth > 1) throw FileError("is a 3D texture, not a 2D picture");
  if (layers > 1) throw FileError("is an array of " + std::to_string(layers) + " pictures, not one");
}

// The basic descriptor block; others may follow it.
void read_descriptor(Bytes data, Container& container) {
  constexpr std::size_t kFixed = 24, kSample = 16;
  if (data.size() < 4 + kFixed) fail_damaged("the data format descriptor is too short");
  if (u32_at(data.data()) != data.size())
    fail_damaged("the data format descriptor has another length than the index says");
  const std::uint8_t* block = data.data() + 4;
  if (u32_at(block) != 0) fail_damaged("the data format descriptor does not begin with the basic one");
  const std::size_t length = u16_at(block + 6);
  if (length < kFixed || length > data.size() - 4 || (length - kFixed) % kSample != 0)
    fail_damaged("the data format descriptor has a block of " + std::to_string(length) + " bytes");
  constexpr std::uint8_t kLinear = 1, kSrgb = 2, kUnspecified = 0, kPremultiplied = 1, kChannel = 15;
  container.color_model = block[8];
  const std::uint8_t transfer = block[10];
  container.transfer = transfer == kSrgb                                 ? Transfer::srgb
                       : transfer == kLinear || transfer == kUnspecified ? Transfer::linear
                                                                         : Transfer::other;
  container.premultiplied = (block[11] & kPremultiplied) != 0;
  for (std::size_t at = kFixed; at < length; at += kSample) container.channels.push_back(block[at + 3] & kChannel);
}

void read_swizzle(std::string_view value, Container& container) {
  value = value.substr(0, value.find('\0'));
  if (value.size() != 4 || value.find_first_not_of("rgba01") != std::string_view::npos)
    fail_damaged("KTXswizzle is not four of r, g, b, a, 0 and 1");
  std::ranges::copy(value, container.swizzle.begin());
}

void read_metadata(Bytes data, Container& container) {
  while (!data.empty()) {
    if (data.size() < 4) fail_damaged("the metadata end within a length");
    const std::uint64_t length = u32_at(data.data());
    data = data.subspan(4);
    if (length < 2 || length > data.size()) fail_damaged("the metadata have an entry that is longer than they are");
    const std::string_view entry(reinterpret_cast<const char*>(data.data()), static_cast<std::size_t>(length));
    const std::size_t end = entry.find('\0');
    if (end == std::string_view::npos) fail_damaged("the metadata have a key without an end");
    if (entry.substr(0, end) == "KTXswizzle") read_swizzle(entry.substr(end + 1), container);
    data = data.subspan(std::min<std::size_t>((static_cast<std::size_t>(length) + 3) / 4 * 4, data.size()));
  }
}

} // namespace

bool is_ktx2(Bytes file) {
  return file.size() >= kIdentifier.size() && std::equal(kIdentifier.begin(), kIdentifier.end(), file.begin());
}

Container read_container(Bytes file) {
  if (!is_ktx2(file)) throw FileError("is not KTX2");
  if (file.size() < kHeaderLength) fail_damaged("the header is incomplete");
  const auto word = [&](std::size_t offset) { return u32_at(file.data() + offset); };
  const auto long_word = [&](std::size_t offset) { return u64_at(file.data() + offset); };
  Container container;
  container.vk_format = word(12);
  container.width = word(20);
  container.height = word(24);
  refuse_other_shapes(container.width, container.height, word(28), word(32), word(36));

  container.level_count = word(40);
  const std::uint32_t levels = std::max(container.level_count, 1u);
  const auto most = static_cast<std::uint32_t>(std::bit_width(std::max(container.width, container.height)));
  if (levels > most)
    fail_damaged(std::to_string(levels) + " levels, but " + std::to_string(container.width) + " x " +
                 std::to_string(container.height) + " texels have at most " + std::to_string(most));

  const std::uint32_t scheme = word(44);
  if (scheme > 3)
    throw FileError("has supercompression " + std::to_string(scheme) + ", which wavepath does not support");
  container.supercompression = Supercompression{scheme};

  const Bytes index = part(file, kHeaderLength, std::uint64_t{levels} * kLevelLength, "the index of levels");
  for (std::size_t level = 0; level < levels; ++level)
    part(file, u64_at(&index[level * kLevelLength]), u64_at(&index[level * kLevelLength + 8]), "a level");
  container.level = part(file, u64_at(&index[0]), u64_at(&index[8]), "level 0");
  container.uncompressed_length = u64_at(&index[16]);
  if (container.level.empty()) fail_damaged("level 0 is empty");

  read_descriptor(part(file, word(48), word(52), "the data format descriptor"), container);
  read_metadata(part(file, word(56), word(60), "the metadata"), container);
  container.global = part(file, long_word(64), long_word(72), "the global data");
  return container;
}

} // namespace wavepath::ktx
