// Resolves URIs without ever leaving the folder of the glTF file (RFC 3986 percent-encoding, RFC 2397 data URIs).
#include "host/scene/gltf/uri.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "host/base/read_file.h"

namespace wavepath::gltf {
namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

// A percent sign that no two hexadecimal digits follow stands for itself, as exporters write it.
std::string percent_decoded(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool escape =
        text[i] == '%' && i + 2 < text.size() && hex_digit(text[i + 1]) >= 0 && hex_digit(text[i + 2]) >= 0;
    if (!escape) {
      result += text[i];
    } else {
      result += static_cast<char>(hex_digit(text[i + 1]) * 16 + hex_digit(text[i + 2]));
      i += 2;
    }
  }
  return result;
}

bool stays_inside(const std::string& name) {
  if (name.empty() || name.find('\0') != std::string::npos) return false;
  if (name[0] == '/' || name[0] == '\\') return false;
  if (name.substr(0, name.find('/')).find(':') != std::string::npos) return false; // a scheme or a drive
  std::size_t first = 0;
  while (first <= name.size()) {
    const std::size_t end = std::min(name.find_first_of("/\\", first), name.size());
    if (std::string_view(name).substr(first, end - first) == "..") return false;
    first = end + 1;
  }
  return true;
}

std::optional<std::vector<std::uint8_t>> base64_decoded(std::string_view text) {
  static constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::array<int, 256> value;
  value.fill(-1);
  for (std::size_t i = 0; i < kAlphabet.size(); ++i)
    value[static_cast<std::uint8_t>(kAlphabet[i])] = static_cast<int>(i);
  while (text.ends_with('=')) text.remove_suffix(1);
  if (text.size() % 4 == 1) return std::nullopt;
  std::vector<std::uint8_t> result;
  result.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int bit_count = 0;
  for (const char c : text) {
    const int digit = value[static_cast<std::uint8_t>(c)];
    if (digit < 0) return std::nullopt;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    bit_count += 6;
    if (bit_count >= 8) {
      bit_count -= 8;
      result.push_back(static_cast<std::uint8_t>(bits >> bit_count));
    }
  }
  return result;
}

} // namespace

bool is_data_uri(const std::string& uri) { return uri.starts_with("data:"); }

std::optional<std::vector<std::uint8_t>> decode_data_uri(const std::string& uri) {
  const std::size_t comma = uri.find(',');
  if (comma == std::string::npos) return std::nullopt;
  const std::string_view data = std::string_view(uri).substr(comma + 1);
  if (std::string_view(uri).substr(0, comma).ends_with(";base64")) return base64_decoded(data);
  const std::string decoded = percent_decoded(data);
  return std::vector<std::uint8_t>(decoded.begin(), decoded.end());
}

std::optional<std::filesystem::path> resolve_uri(const std::filesystem::path& folder, const std::string& uri) {
  const std::string name = percent_decoded(uri);
  if (!stays_inside(name) || !stays_inside(uri)) return std::nullopt;
  const std::filesystem::path decoded = folder / std::filesystem::path(name);
  // Some exporters leave names such as "50%20.png" unencoded.
  const std::filesystem::path literal = folder / std::filesystem::path(uri);
  return !regular_file_size(decoded) && regular_file_size(literal) ? literal : decoded;
}

std::string shown(const std::string& text) {
  std::string result = text.substr(0, 100);
  for (char& c : result) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  return text.size() > result.size() ? result + "..." : result;
}

} // namespace wavepath::gltf
