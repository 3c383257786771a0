// Reads parts of regular files.
#include "host/base/read_file.h"

#include <fstream>

namespace wavepath {

std::optional<std::uint64_t> regular_file_size(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error) || error) return std::nullopt;
  const auto size = std::filesystem::file_size(path, error);
  return error ? std::nullopt : std::optional<std::uint64_t>(size);
}

bool read_file(const std::filesystem::path& path, std::uint64_t offset, std::span<std::uint8_t> out) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream || !stream.seekg(static_cast<std::streamoff>(offset))) return false;
  stream.read(reinterpret_cast<char*>(out.data()), static_cast<std::streamsize>(out.size()));
  return static_cast<std::size_t>(stream.gcount()) == out.size();
}

} // namespace wavepath
