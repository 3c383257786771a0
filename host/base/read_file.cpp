#include "host/base/read_file.h"

#include <fstream>

#include "host/base/memory.h"

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

std::optional<std::vector<std::uint8_t>> read_whole_file(const std::filesystem::path& path) {
  const std::optional<std::uint64_t> size = regular_file_size(path);
  if (!size) return std::nullopt;
  require_memory(path.string(), "reading it", *size, "choose a smaller file");
  std::vector<std::uint8_t> bytes(*size);
  return read_file(path, 0, bytes) ? std::optional(std::move(bytes)) : std::nullopt;
}

} // namespace wavepath
