#include "host/base/cache_file.h"

#include <cstdlib>
#include <cstring>

#include "host/base/atomic_file.h"
#include "host/base/error.h"
#include "host/base/hash.h"
#include "host/base/read_file.h"

namespace wavepath {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMagic = 0x3265686361637077; // "wpcache2" in the byte order that wrote it
constexpr std::uint64_t kLargest = 256ull << 20;     // beyond it a file is no cache of ours; begin afresh

struct Header {
  std::uint64_t magic, key, bytes, checksum;
};

std::string_view text_of(std::span<const std::uint8_t> data) {
  return {reinterpret_cast<const char*>(data.data()), data.size()};
}

fs::path folder_from(const char* variable) {
  const char* value = std::getenv(variable);
  return value && fs::path(value).is_absolute() ? fs::path(value) : fs::path(); // XDG: ignore relative ones
}

// Only its owner may put something there that a driver then reads.
bool make_private_folder(const fs::path& folder) {
  std::error_code error;
  if (fs::is_directory(folder, error)) return true;
  if (!fs::create_directories(folder, error)) return false;
  fs::permissions(folder, fs::perms::owner_all, error);
  return true;
}

} // namespace

fs::path cache_folder() {
  const char* chosen = std::getenv("WAVEPATH_CACHE");
  if (chosen && std::strcmp(chosen, "off") == 0) return {};
  if (chosen && *chosen) return chosen;
  if (const fs::path folder = folder_from("XDG_CACHE_HOME"); !folder.empty()) return folder / "wavepath";
  const fs::path home = folder_from("HOME");
  return home.empty() ? home : home / ".cache" / "wavepath";
}

std::vector<std::uint8_t> read_cache_file(const fs::path& path, std::uint64_t key) {
  const std::uint64_t size = regular_file_size(path).value_or(0);
  if (size < sizeof(Header) || size > kLargest) return {};
  std::vector<std::uint8_t> data(size);
  if (!read_file(path, 0, data)) return {};
  Header header;
  std::memcpy(&header, data.data(), sizeof(header));
  data.erase(data.begin(), data.begin() + sizeof(header));
  const bool sound = header.magic == kMagic && header.key == key && header.bytes == data.size() &&
                     header.checksum == hash_bytes(text_of(data));
  return sound ? data : std::vector<std::uint8_t>();
}

bool write_cache_file(const fs::path& path, std::uint64_t key, std::span<const std::uint8_t> data) {
  std::error_code error;
  if (data.size() > kLargest - sizeof(Header) || !make_private_folder(path.parent_path())) return false;
  if (fs::exists(path, error) && !fs::is_regular_file(path, error)) return false; // a pipe would block
  try {
    const Header header{kMagic, key, data.size(), hash_bytes(text_of(data))};
    AtomicFile file(path.string());
    file.write(&header, sizeof(header));
    file.write(data.data(), data.size());
    file.commit();
    return true;
  } catch (const Error&) {
    return false;
  }
}

} // namespace wavepath
