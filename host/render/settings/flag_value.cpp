// Reads flag values, and suggests what was probably meant (edit distance after Damerau, 1964).
#include "host/render/settings/flag_value.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "host/base/error.h"

namespace wavepath {
namespace {

template <class T>
std::optional<T> parse(std::string_view text) {
  T value{};
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<double> parse_finite(std::string_view text) {
  const std::optional<double> value = parse<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

// Insertions, deletions, replacements and swaps of neighbours.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i)
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        d[i][j] = i + j;
        continue;
      }
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[a.size()][b.size()];
}

} // namespace

void FlagValue::refuse(const std::string& problem, const std::string& remedy) const {
  throw UsageError(flag, fmt::format("'{}' {}", text, problem), remedy);
}

std::uint32_t FlagValue::whole_number(std::uint64_t lowest, std::uint64_t highest) const {
  const std::optional<std::uint64_t> value = parse<std::uint64_t>(text);
  if (!value || *value < lowest || *value > highest)
    refuse("is not a whole number in range", fmt::format("give one from {} to {}", lowest, highest));
  return static_cast<std::uint32_t>(*value);
}

double FlagValue::number(double lowest, double highest) const {
  const std::optional<double> value = parse_finite(text);
  if (!value || *value < lowest || *value > highest)
    refuse("is not a number in range", fmt::format("give one from {} to {}", lowest, highest));
  return *value;
}

double FlagValue::positive_number() const {
  const std::optional<double> value = parse_finite(text);
  if (!value || !(*value > 0.0)) refuse("is not a number above zero", "give one, such as 0.5");
  return *value;
}

glm::dvec3 FlagValue::triple() const {
  const std::vector<double> values = numbers(3, "write them as X,Y,Z without spaces");
  return {values[0], values[1], values[2]};
}

std::vector<double> FlagValue::numbers(std::size_t count, const char* remedy) const {
  constexpr std::string_view kWords[] = {"no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine"};
  std::vector<double> values;
  std::string_view rest = text;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t end = i + 1 < count ? rest.find(',') : rest.size();
    const std::optional<double> value =
        end == std::string_view::npos ? std::nullopt : parse_finite(rest.substr(0, end));
    if (!value)
      refuse(count < std::size(kWords) ? fmt::format("is not {} numbers", kWords[count]) : "lacks a number", remedy);
    values.push_back(*value);
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return values;
}

std::uint32_t FlagValue::choice(std::span<const std::string_view> names) const {
  const auto found = std::find(names.begin(), names.end(), text);
  if (found == names.end())
    refuse("is unknown", suggestion(text, std::vector<std::string>(names.begin(), names.end())));
  return static_cast<std::uint32_t>(found - names.begin());
}

std::pair<FlagValue, FlagValue> FlagValue::split(char separator, const char* remedy) const {
  const std::size_t middle = text.find(separator);
  if (middle == std::string::npos) refuse("has the wrong form", remedy);
  return {{flag, text.substr(0, middle)}, {flag, text.substr(middle + 1)}};
}

std::vector<std::string> FlagValue::list(std::span<const std::string_view> names) const {
  std::vector<std::string> list;
  for (std::size_t first = 0; first <= text.size();) {
    const std::size_t end = std::min(text.find(',', first), text.size());
    const FlagValue name{flag, text.substr(first, end - first)};
    name.choice(names);
    if (std::find(list.begin(), list.end(), name.text) == list.end()) list.push_back(name.text);
    first = end + 1;
  }
  return list;
}

std::string nearest_name(const std::string& text, std::span<const std::string> names) {
  std::string nearest;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const std::string& name : names) {
    // Something cut short ("--out") is meant more probably than its distance tells.
    const std::size_t distance = text.size() >= 2 && name.starts_with(text) ? 1 : edit_distance(text, name);
    if (distance < least) nearest = name, least = distance;
  }
  return least <= std::max<std::size_t>(2, text.size() / 2) ? nearest : "";
}

std::string suggestion(const std::string& text, std::span<const std::string> names) {
  const std::string nearest = nearest_name(text, names);
  return nearest.empty() ? fmt::format("choose from {}", fmt::join(names, ", "))
                         : fmt::format("did you mean {}?", nearest);
}

} // namespace wavepath
