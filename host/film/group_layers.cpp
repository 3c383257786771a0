#include "host/film/group_layers.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace wavepath {
namespace {

bool is_safe(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
}

} // namespace

std::vector<std::string> group_layers(const std::vector<std::string>& names) {
  std::vector<std::string> layers;
  for (const std::string& name : names) {
    std::string safe = kGroupPrefix;
    for (const char c : name) safe += is_safe(c) ? c : '_';
    std::string layer = safe;
    for (int number = 2; std::ranges::count(layers, layer) > 0; ++number) layer = fmt::format("{}_{}", safe, number);
    layers.push_back(layer);
  }
  return layers;
}

std::pair<std::string, std::string> group_names_text(const std::vector<std::string>& names) {
  nlohmann::ordered_json table = nlohmann::ordered_json::object();
  const std::vector<std::string> layers = group_layers(names);
  for (std::size_t i = 0; i < names.size(); ++i) table[layers[i]] = names[i];
  return {kGroupsText, table.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)};
}

std::vector<std::string> group_names_of(const std::string& text) {
  const nlohmann::ordered_json table = nlohmann::ordered_json::parse(text, nullptr, false);
  std::vector<std::string> names;
  if (table.is_object())
    for (const auto& [layer, name] : table.items())
      if (name.is_string()) names.push_back(name.get<std::string>());
  return names;
}

} // namespace wavepath
