#include "host/serve/access.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>

#include <sys/random.h>

#include <fmt/format.h>

#include "host/base/error.h"

namespace wavepath {

std::string make_token() {
  std::array<std::uint8_t, 32> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw Error("serve", "the system gives no random numbers", "use wavepath render");
  std::string token;
  for (const std::uint8_t byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

bool same_secret(std::string_view given, std::string_view secret) {
  if (secret.empty()) return false;
  std::size_t different = given.size() ^ secret.size();
  for (std::size_t i = 0; i < given.size(); ++i)
    different |= static_cast<unsigned char>(given[i]) ^ static_cast<unsigned char>(secret[i % secret.size()]);
  return different == 0;
}

std::string host_name(std::string_view host) {
  const std::size_t end = host.starts_with('[') ? host.find(']') + 1 : std::min(host.find(':'), host.size());
  if (end == 0) return ""; // a bracket that is not closed
  const std::string_view port = host.substr(end);
  const bool is_digits =
      port.size() > 1 && std::ranges::all_of(port.substr(1), [](unsigned char c) { return std::isdigit(c) != 0; });
  if (!port.empty() && (port[0] != ':' || !is_digits)) return "";
  std::string name(host.substr(0, end));
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name;
}

bool is_loopback(std::string_view name) {
  if (name == "localhost" || name == "[::1]" || name == "::1") return true;
  // 127.0.0.0/8 in digits; 127.0.0.1.example.com is somebody's.
  return name.starts_with("127.") && std::ranges::count(name, '.') == 3 &&
         std::ranges::all_of(name, [](unsigned char c) { return std::isdigit(c) || c == '.'; });
}

bool is_allowed_host(std::string_view host, std::span<const std::string> others) {
  const std::string name = host_name(host);
  return !name.empty() && (is_loopback(name) || std::ranges::find(others, name) != others.end());
}

bool is_allowed_origin(std::string_view origin, std::span<const std::string> others) {
  for (const std::string_view scheme : {"http://", "https://"})
    if (origin.starts_with(scheme)) return is_allowed_host(origin.substr(scheme.size()), others);
  return false; // "null" and others
}

} // namespace wavepath
