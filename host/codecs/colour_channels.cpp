#include "host/codecs/colour_channels.h"

#include <algorithm>
#include <cctype>
#include <initializer_list>
#include <string_view>

namespace wavepath {
namespace {

using Names = std::initializer_list<std::string_view>;

std::string lower(std::string_view text) {
  std::string letters(text);
  std::transform(letters.begin(), letters.end(), letters.begin(), [](unsigned char c) { return std::tolower(c); });
  return letters;
}

// The first channel of the layer that has one of these names; lower case. The layer of plain channels is "".
std::optional<std::size_t> find_name(const StoredPart& part, const std::string& layer, Names names) {
  for (std::size_t i = 0; i < part.channels.size(); ++i) {
    const std::string& channel = part.channels[i];
    const std::size_t dot = channel.rfind('.');
    const bool plain = dot == std::string::npos;
    if ((plain ? "" : channel.substr(0, dot)) != layer) continue;
    if (std::ranges::count(names, lower(plain ? channel : channel.substr(dot + 1))) > 0) return i;
  }
  return std::nullopt;
}

std::optional<ColourChannels> find_rgb(const std::vector<StoredPart>& parts, std::size_t index,
                                       const std::string& layer) {
  const StoredPart& part = parts[index];
  const auto red = find_name(part, layer, {"r", "red"}), green = find_name(part, layer, {"g", "green"}),
             blue = find_name(part, layer, {"b", "blue"});
  if (!red || !green || !blue) return std::nullopt;
  return ColourChannels{index, {*red, *green, *blue}};
}

// Names of layers in the order of the file, those first that say that they are the picture.
std::vector<std::string> layers_of(const StoredPart& part) {
  std::vector<std::string> layers;
  for (const std::string& channel : part.channels) {
    const std::size_t dot = channel.rfind('.');
    const std::string layer = dot == std::string::npos ? "" : channel.substr(0, dot);
    if (!layer.empty() && std::ranges::count(layers, layer) == 0) layers.push_back(layer);
  }
  std::stable_partition(layers.begin(), layers.end(), [](const std::string& layer) {
    const std::string last = lower(layer.substr(layer.rfind('.') + 1)); // npos + 1 is 0
    const Names whole = {"combined", "beauty", "rgba", "rgb", "color", "colour"};
    return std::ranges::count(whole, last) > 0;
  });
  return layers;
}

} // namespace

std::optional<ColourChannels> colour_channels(const std::vector<StoredPart>& parts) {
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (const auto found = find_rgb(parts, i, "")) return found;
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (const auto grey = find_name(parts[i], "", {"y", "l", "i"})) return ColourChannels{i, {*grey, *grey, *grey}};
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (const std::string& layer : layers_of(parts[i])) {
      if (const auto found = find_rgb(parts, i, layer)) return found;
      if (const auto grey = find_name(parts[i], layer, {"y", "l"})) return ColourChannels{i, {*grey, *grey, *grey}};
    }
  return std::nullopt;
}

std::string channel_list(const std::vector<StoredPart>& parts) {
  std::string names;
  for (const StoredPart& part : parts)
    for (const std::string& name : part.channels)
      if (names.size() < 200) names += (names.empty() ? "" : ", ") + name;
  return names;
}

} // namespace wavepath
