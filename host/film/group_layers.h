// Layers of groups of lights in a picture: their names, and the header that tells them.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace wavepath {

// Header attribute that names the groups of a picture, in the order of their layers.
inline constexpr const char* kGroupsText = "wavepath.light_groups";
inline constexpr const char* kGroupPrefix = "group.";

// The layer of each group: kGroupPrefix and its name, in which "_" stands for all but letters, digits, "_" and "-".
// Names that would become the same get a number.
std::vector<std::string> group_layers(const std::vector<std::string>& names);

// The attribute: {"group.Key_light": "Key light", ...}; and the names that such a text has, in their order.
std::pair<std::string, std::string> group_names_text(const std::vector<std::string>& names);
std::vector<std::string> group_names_of(const std::string& text);

} // namespace wavepath
