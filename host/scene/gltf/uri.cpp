// Resolves URIs without ever leaving the folder of the glTF file (RFC 3986 percent-encoding and dot segments, RFC 2397
// data URIs).
#include "host/scene/gltf/uri.h"

#include <algorithm>
#include <array>

#include "host/base/read_file.h"

namespace wavepath::gltf {
namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

// The byte that an escape at `i` stands for; -1 where there is none.
int escaped_byte(std::string_view text, std::size_t i) {
  if (text[i] != '%' || i + 2 >= text.size()) return -1;
  const int high = hex_digit(text[i + 1]), low = hex_digit(text[i + 2]);
  return high < 0 || low < 0 ? -1 : high * 16 + low;
}

// A percent sign that no two hexadecimal digits follow stands for itself, as exporters write it.
template <class Bytes>
Bytes percent_decoded(std::string_view text) {
  Bytes result;
  result.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    const int byte = escaped_byte(text, i);
    result.push_back(static_cast<typename Bytes::value_type>(byte < 0 ? text[i] : byte));
    if (byte >= 0) i += 2;
  }
  return result;
}

bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

std::string_view without_blanks_around(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool equals_ignoring_case(std::string_view text, std::string_view lower_case) {
  return std::ranges::equal(text, lower_case, {}, lower);
}

bool has(std::string_view text, char c) { return text.find(c) != std::string_view::npos; }

// Schemes are letters, digits and "+-." up to a colon (RFC 3986, 3.1); a drive of Windows looks the same.
bool has_scheme(std::string_view uri) { return has(uri.substr(0, uri.find_first_of("/\\?#")), ':'); }

// --- data URIs ---

constexpr int kNoDigit = -1, kBlank = -2, kPercent = -3;

constexpr std::array<std::int8_t, 256> kBase64 = [] {
  constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::array<std::int8_t, 256> value;
  value.fill(kNoDigit);
  for (std::size_t i = 0; i < kAlphabet.size(); ++i)
    value[static_cast<std::uint8_t>(kAlphabet[i])] = static_cast<std::int8_t>(i);
  for (const char c : {' ', '\t', '\n', '\v', '\f', '\r'}) value[static_cast<std::uint8_t>(c)] = kBlank;
  value[static_cast<std::uint8_t>('%')] = kPercent;
  return value;
}();

std::string describe_wrong_digit(int c) {
  if (c == '-' || c == '_') return "it is base64url, where glTF takes plain base64";
  if (c == '=') return "its base64 goes on after the padding";
  const bool printable = c > 0x20 && c < 0x7f;
  return "its base64 holds " +
         (printable ? std::string("'") + static_cast<char>(c) + "'" : "byte " + std::to_string(c));
}

// Escapes may stand for any character, and blanks anywhere. Padding may be missing.
UriData base64_decoded(std::string_view text) {
  UriData data;
  data.bytes.resize(text.size() / 4 * 3 + 3);
  std::uint8_t* out = data.bytes.data();
  std::uint32_t bits = 0;
  std::size_t digits = 0;
  bool padded = false;
  const auto digit_at = [&](std::size_t i) { return int{kBase64[static_cast<std::uint8_t>(text[i])]}; };
  for (std::size_t i = 0; i < text.size(); ++i) {
    // Four digits at once, as nearly all of them come.
    for (; digits % 4 == 0 && !padded && i + 4 <= text.size(); i += 4, digits += 4) {
      const int a = digit_at(i), b = digit_at(i + 1), c = digit_at(i + 2), d = digit_at(i + 3);
      if ((a | b | c | d) < 0) break;
      *out++ = static_cast<std::uint8_t>(a << 2 | b >> 4);
      *out++ = static_cast<std::uint8_t>(b << 4 | c >> 2);
      *out++ = static_cast<std::uint8_t>(c << 6 | d);
    }
    if (i == text.size()) break;
    auto c = static_cast<std::uint8_t>(text[i]);
    int digit = kBase64[c];
    if (digit == kPercent) {
      const int byte = escaped_byte(text, i);
      if (byte >= 0) c = static_cast<std::uint8_t>(byte), i += 2;
      digit = byte < 0 || byte == '%' ? kNoDigit : kBase64[c];
    }
    if (digit == kBlank) continue;
    if (c == '=' && digits > 0) {
      padded = true;
      continue;
    }
    if (digit < 0 || padded) return {{}, describe_wrong_digit(padded && digit >= 0 ? '=' : c)};
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    if (const std::size_t index = digits++ % 4) *out++ = static_cast<std::uint8_t>(bits >> (6 - 2 * index));
  }
  if (digits % 4 == 1) return {{}, "its base64 is cut short: " + std::to_string(digits) + " digits"};
  data.bytes.resize(static_cast<std::size_t>(out - data.bytes.data()));
  return data;
}

// --- paths ---

std::vector<std::string_view> segments(std::string_view path, std::string_view separators) {
  std::vector<std::string_view> result;
  for (std::size_t first = 0; first <= path.size();) {
    const std::size_t end = std::min(path.find_first_of(separators, first), path.size());
    result.push_back(path.substr(first, end - first));
    first = end + 1;
  }
  return result;
}

// `name` as a path below `folder`, without its dot segments (RFC 3986, 5.2.4: ".." takes away the segment before it,
// be that empty, a link or not there). A way out of the folder must lead back into it by name.
std::optional<std::filesystem::path> path_inside(const std::filesystem::path& folder, std::string_view name,
                                                 std::string_view separators) {
  if (name.empty() || has(name, '\0') || name[0] == '/' || name[0] == '\\') return std::nullopt;
  std::error_code error;
  const std::string base_name =
      std::filesystem::absolute(folder.empty() ? "." : folder, error).lexically_normal().string();
  if (error) return std::nullopt;
  std::vector<std::string_view> base = segments(base_name, "/");
  while (base.size() > 1 && (base.back().empty() || base.back() == ".")) base.pop_back();
  std::vector<std::string_view> stack = base;
  for (const std::string_view segment : segments(name, separators)) {
    if (segment == ".") continue;
    if (segment != "..")
      stack.push_back(segment);
    else if (!stack.empty())
      stack.pop_back();
  }
  if (stack.size() < base.size() || !std::equal(base.begin(), base.end(), stack.begin())) return std::nullopt;
  std::filesystem::path path = folder;
  // An empty segment would make the path begin anew at the root.
  for (std::size_t i = base.size(); i < stack.size(); ++i)
    if (!stack[i].empty()) path /= stack[i];
  return path;
}

} // namespace

bool is_data_uri(std::string_view uri) {
  constexpr std::string_view kScheme = "data:";
  while (!uri.empty() && is_blank(uri.front())) uri.remove_prefix(1);
  return equals_ignoring_case(uri.substr(0, kScheme.size()), kScheme);
}

UriData decode_data_uri(std::string_view uri) {
  const std::size_t comma = uri.find(',');
  if (comma == std::string_view::npos) return {{}, "it has no comma before its data"};
  const std::string_view data = uri.substr(comma + 1);
  std::string_view kind = uri.substr(0, comma);
  kind.remove_prefix(kind.find(':') + 1);
  const std::vector<std::string_view> parameters = segments(kind, ";");
  for (std::size_t i = 1; i < parameters.size(); ++i) { // 0 is the media type
    const std::string_view parameter = without_blanks_around(parameters[i]);
    if (equals_ignoring_case(parameter, "base64") && i + 1 == parameters.size()) return base64_decoded(data);
    if (!parameter.empty() && !has(parameter, '='))
      return {{}, "its encoding '" + shown(std::string(parameter)) + "' is not known, or not last before the comma"};
  }
  const std::string_view type = without_blanks_around(parameters[0]);
  if (!type.empty() && !has(type, '/')) return {{}, "'" + shown(std::string(type)) + "' is no media type"};
  return {percent_decoded<std::vector<std::uint8_t>>(data), {}, true};
}

std::optional<std::filesystem::path> resolve_uri(const std::filesystem::path& folder, const std::string& uri) {
  if (has_scheme(uri)) return std::nullopt;
  const std::string name = percent_decoded<std::string>(uri);
  // Windows separates by backslashes, and some of its exporters write them; elsewhere they may be part of a name.
  // Neither reading must lead out.
  const auto split = path_inside(folder, name, "/\\"), decoded = path_inside(folder, name, "/");
  // Some exporters leave names such as "50%20.png" unencoded.
  const auto literal = path_inside(folder, uri, "/");
  if (!decoded || !split || !literal) return std::nullopt;
  // Last, because they may as well stand for themselves in a name.
  const auto without_query =
      path_inside(folder, percent_decoded<std::string>(uri.substr(0, uri.find_first_of("?#"))), "/");
  for (const auto& path : {split, decoded, literal, without_query})
    if (path && regular_file_size(*path)) return path;
  return decoded;
}

std::string shown(const std::string& text) {
  std::string result = text.substr(0, 100);
  for (char& c : result) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  return text.size() > result.size() ? result + "..." : result;
}

} // namespace wavepath::gltf
