// Registries of techniques that a setting chooses among: a row a technique, which says what is known of it.
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

// Declares the constants of type KIND that are named behind ROWS, each defined in a file of its own, and ROWS, the
// array of their addresses: so that a technique is named once.
#define WAVEPATH_ROWS(KIND, ROWS, ...) \
  extern const KIND __VA_ARGS__;       \
  inline constexpr auto ROWS = rows_of(__VA_ARGS__)

// A Kind has a member `name`; for takes() and check() also `settings`, those that the technique takes, and `check`,
// null or a function that throws UsageError where settings do not go with it.
template <class Kind>
struct Registry {
  std::string_view setting; // its values are the names
  std::uint32_t RenderPlan::*value = nullptr;
  std::span<const Kind* const> rows{};        // in the order of the values
  std::string_view built_in{};                // the value before theirs, which no technique stands for; empty = none
  std::span<const std::string_view> common{}; // settings that every technique takes, and what is built in does not

  std::vector<std::string_view> names() const {
    std::vector<std::string_view> names;
    if (!built_in.empty()) names.push_back(built_in);
    for (const Kind* row : rows) names.push_back(row->name);
    return names;
  }

  // Null for what is built in.
  const Kind* find(const RenderPlan& settings) const {
    const std::size_t first = built_in.empty() ? 0 : 1, index = settings.*value;
    return index < first ? nullptr : rows[index - first];
  }
  std::string_view name(const RenderPlan& settings) const {
    const Kind* row = find(settings);
    return row ? row->name : built_in;
  }

  // Whether a setting means something to the technique chosen; one that no technique lists always does.
  bool supports(const RenderPlan& settings, std::string_view name) const {
    const auto lists = [&](const Kind* row) {
      return std::ranges::count(row->settings, name) > 0 || std::ranges::count(common, name) > 0;
    };
    const Kind* row = find(settings);
    return row && lists(row) ? true : std::ranges::none_of(rows, lists);
  }

  // Throws UsageError where settings do not go with the technique chosen.
  void check(const RenderPlan& settings) const {
    if (const Kind* row = find(settings); row && row->check) row->check(settings);
    for (const Setting& other : settings_table())
      if (!is_default(other, settings) && !supports(settings, other.name))
        throw UsageError(fmt::format("--{}", other.name),
                         fmt::format("is not supported by --{} {}", setting, name(settings)), "leave it out");
  }
};

} // namespace wavepath
