#include "host/serve/page.h"

#include <algorithm>
#include <cstdint>
#include <string_view>

#include <fmt/format.h>

namespace wavepath {
namespace {

// As browsers want it, from the digits that CMake gives.
std::string base64_of(std::string_view hexadecimal) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t first = 0; first < hexadecimal.size(); first += 6) { // 24 bits
    const std::size_t count = std::min<std::size_t>(6, hexadecimal.size() - first);
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < 6; ++i)
      bits = bits << 4 | (i < count ? static_cast<std::uint32_t>(kDigits.find(hexadecimal[first + i])) : 0);
    const std::size_t letters = count / 2 + 1;
    for (std::size_t i = 0; i < 4; ++i) text += i < letters ? kLetters[bits >> (18 - 6 * i) & 63] : '=';
  }
  return text;
}

} // namespace

std::string served_page_policy() {
  return fmt::format(
      "default-src 'none'; script-src 'sha256-{}'; style-src 'sha256-{}'; connect-src 'self'; img-src 'self' blob:; "
      "base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
      base64_of(kServedScriptHash), base64_of(kServedStyleHash));
}

} // namespace wavepath
