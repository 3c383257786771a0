#include "host/study/grid.h"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "host/render/settings/settings_table.h"

namespace wavepath {

std::vector<std::string_view> dimensions() {
  std::vector<std::string_view> names;
  for (const Setting& row : settings_table())
    if (!row.study.empty()) names.push_back(row.name);
  return names;
}

namespace {

void apply(const Choice& choice, RenderPlan& settings) {
  read_setting(setting_named(choice.dimension), std::string(choice.value), settings);
}

// Without the choices that the integrator does not support, or that have no effect beside the others.
Configuration reduced(const Configuration& full, const RenderPlan& base) {
  Configuration result{{}, base};
  for (const Choice& choice : full.choices) {
    const IntegratorKind& kind = *full.settings.integrator;
    if (!is_supported(setting_named(choice.dimension), kind)) continue;
    if (kind.has_effect && !kind.has_effect(full.settings, choice.dimension)) continue;
    result.choices.push_back(choice);
    apply(choice, result.settings);
  }
  return result;
}

} // namespace

std::string Configuration::name(std::string_view between) const {
  std::vector<std::string> values;
  for (const Choice& choice : choices)
    if (choice.value == "on")
      values.emplace_back(choice.dimension);
    else if (std::isdigit(static_cast<unsigned char>(choice.value.front())))
      values.push_back(
          fmt::format("{}{}{}", choice.value, between, choice.dimension.substr(0, choice.dimension.find('-'))));
    else if (choice.value != "off")
      values.emplace_back(choice.value);
  return fmt::format("{}", fmt::join(values, between));
}

std::string_view Configuration::value_of(std::string_view dimension) const {
  for (const Choice& choice : choices)
    if (choice.dimension == dimension) return choice.value;
  return "";
}

std::string flag_of(const Choice& choice) {
  if (choice.value == "off") return "";
  return choice.value == "on" ? fmt::format("--{}", choice.dimension)
                              : fmt::format("--{} {}", choice.dimension, choice.value);
}

std::string Configuration::flags() const {
  std::vector<std::string> flags;
  for (const Choice& choice : choices)
    if (std::string flag = flag_of(choice); !flag.empty()) flags.push_back(std::move(flag));
  return fmt::format("{}", fmt::join(flags, " "));
}

std::vector<Configuration> make_grid(const std::vector<std::string>& vary, const RenderPlan& base) {
  std::vector<Configuration> product = {{{}, base}};
  for (const std::string& name : vary) {
    std::vector<Configuration> finer;
    for (const Configuration& configuration : product)
      for (const std::string_view value : setting_named(name).study) {
        Configuration& next = finer.emplace_back(configuration);
        next.choices.push_back({setting_named(name).name, value});
        apply(next.choices.back(), next.settings);
      }
    product = std::move(finer);
  }
  std::vector<Configuration> grid;
  for (const Configuration& full : product) {
    Configuration one = reduced(full, base);
    const bool is_new =
        std::none_of(grid.begin(), grid.end(), [&](const Configuration& c) { return c.choices == one.choices; });
    if (is_new) grid.push_back(std::move(one));
  }
  return grid;
}

} // namespace wavepath
