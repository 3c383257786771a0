// Registry of the techniques that a setting chooses among: one row for each technique.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/render/settings/settings_table.h"

namespace wavepath {

template <class... Kinds>
constexpr auto rows_of(const Kinds&... kinds) {
  return std::array{&kinds...};
}

// Declares constants of type KIND, whose names follow ROWS, and the array ROWS of their addresses. Each constant is
// defined in a file of its own; so a technique is named only once.
#define WAVEPATH_ROWS(KIND, ROWS, ...) \
  extern const KIND __VA_ARGS__;       \
  inline constexpr auto ROWS = rows_of(__VA_ARGS__)

// Rows of techniques. A Kind has a member `name`. supports() and check() also need `settings`, the names of the
// settings that the technique supports, and `check`, which throws UsageError if settings contradict it; null = no such
// check.
template <class Kind>
struct Registry {
  std::string_view setting; // name of the setting whose values are the techniques
  std::uint32_t RenderPlan::*value = nullptr;
  std::span<const Kind* const> rows{};        // one for each technique, in the order of the setting's values
  std::string_view built_in{};                // name of value 0, which stands for no technique; empty = there is none
  std::span<const std::string_view> common{}; // settings that every technique supports, but not value 0

  std::vector<std::string_view> names() const {
    std::vector<std::string_view> names;
    if (!built_in.empty()) names.push_back(built_in);
    for (const Kind* row : rows) names.push_back(row->name);
    return names;
  }

  // The technique chosen; null for the built-in value.
  const Kind* find(const RenderPlan& settings) const {
    const std::size_t first = built_in.empty() ? 0 : 1, index = settings.*value;
    return index < first ? nullptr : rows[index - first];
  }
  std::string_view name(const RenderPlan& settings) const {
    const Kind* row = find(settings);
    return row ? row->name : built_in;
  }

  // True if the chosen technique supports a setting, or if no technique lists it.
  bool supports(const RenderPlan& settings, std::string_view name) const {
    const auto lists = [&](const Kind* row) {
      return std::ranges::count(row->settings, name) > 0 || std::ranges::count(common, name) > 0;
    };
    const Kind* row = find(settings);
    return row && lists(row) ? true : std::ranges::none_of(rows, lists);
  }

  // Throws UsageError if settings contradict the chosen technique.
  void check(const RenderPlan& settings) const {
    if (const Kind* row = find(settings); row && row->check) row->check(settings);
    for (const Setting& other : settings_table())
      if (!is_default(other, settings) && !supports(settings, other.name))
        throw UsageError(fmt::format("--{}", other.name),
                         fmt::format("is not supported by --{} {}", setting, name(settings)), "leave it out");
  }
};

} // namespace wavepath
