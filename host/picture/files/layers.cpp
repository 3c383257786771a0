#include "host/picture/files/layers.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "host/film/group_layers.h"

namespace wavepath {
namespace {

constexpr std::string_view kViewLayer = "ViewLayer."; // as Blender names its first one
constexpr const char* kSumsPart = "sums";

// Blender's passes that hold the same as a layer of ours. A pass has channels of one letter.
constexpr std::array<std::pair<std::string_view, std::string_view>, 7> kBlenderPasses = {
    {{"", "Combined"},
     {"albedo", "Denoising Albedo"},
     {"N", "Normal"},
     {"P", "Position"},
     {"emission", "Emit"},
     {"environment", "Env"},
     {"uv", "UV"}}};
// Channels that are a pass of their own.
constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kBlenderChannels = {
    {{"Z", "Depth.Z"}, {"samples", "Debug Sample Count.X"}, {"id.material", "IndexMA.X"}}};

// Layers whose channels are colours.
constexpr std::array<std::string_view, 7> kColourLayers = {"",         "albedo",   "direct",     "indirect",
                                                           "emission", "denoised", "environment"};

bool is_rgba(std::string_view channel) {
  return channel.size() == 1 && std::string_view("RGBA").find(channel) != std::string_view::npos;
}

// "albedo" and "R" of "albedo.R"; "" and the name itself where there is no dot.
std::pair<std::string_view, std::string_view> split(std::string_view channel) {
  const std::size_t dot = channel.rfind('.');
  if (dot == std::string_view::npos) return {"", channel};
  return {channel.substr(0, dot), channel.substr(dot + 1)};
}

std::string_view part_name(std::string_view channel) {
  if (is_rgba(channel)) return "rgba";
  if (channel == "Z") return "depth";
  const auto [layer, letter] = split(channel);
  return layer.empty() ? letter : layer;
}

std::string blender_name(const std::string& channel) {
  std::string name(kViewLayer);
  const auto own = std::ranges::find(kBlenderChannels, channel, [](const auto& pair) { return pair.first; });
  if (own != kBlenderChannels.end()) return name.append(own->second);
  const auto [layer, letter] = split(channel);
  const bool is_scalar = letter.size() > 1; // "roughness", "id.triangle"
  if (is_scalar) {
    name += channel;
    std::replace(name.begin() + static_cast<std::ptrdiff_t>(kViewLayer.size()), name.end(), '.', ' ');
    return name + ".X";
  }
  if (layer.starts_with(kGroupPrefix)) // as Blender names its light groups
    return name.append("Combined_")
        .append(layer.substr(std::string_view(kGroupPrefix).size()))
        .append(".")
        .append(letter);
  const auto pass = std::ranges::find(kBlenderPasses, layer, [](const auto& pair) { return pair.first; });
  return name.append(pass == kBlenderPasses.end() ? layer : pass->second).append(".").append(letter);
}

} // namespace

std::string written_name(LayerNames names, const std::string& channel) {
  // The header of a Cryptomatte names the beginning of its channels, so that they keep their names.
  if (channel.starts_with("Crypto")) return channel;
  return names == LayerNames::blender ? blender_name(channel) : channel;
}

bool is_colour(const std::string& channel) {
  const auto [layer, letter] = split(channel);
  return is_rgba(letter) && (layer.starts_with(kGroupPrefix) || std::ranges::count(kColourLayers, layer) > 0);
}

std::vector<PicturePart> parts_of(const Picture& picture, bool has_sums, const WriteOptions& options) {
  const bool lossy = options.compression == Compression::dwaa;
  std::vector<PicturePart> parts;
  const auto part_named = [&](std::string_view name, bool colour) -> PicturePart& {
    const auto found = std::ranges::find(parts, name, &PicturePart::name);
    if (found != parts.end()) return *found;
    const Compression compression = lossy && !colour ? Compression::zip : options.compression;
    return parts.emplace_back(PicturePart{.name = std::string(name), .channels = {}, .compression = compression});
  };
  for (std::size_t i = 0; i < picture.channels.size(); ++i) {
    const std::string& channel = picture.channels[i].name;
    const bool colour = is_colour(channel);
    const std::string_view name = options.multi_part ? part_name(channel) : !lossy || colour ? "colours" : "data";
    part_named(name, colour).channels.push_back(i);
  }
  if (has_sums) part_named(options.multi_part ? kSumsPart : lossy ? "data" : "colours", false).sums = true;
  if (parts.size() == 1) parts.front().name.clear();
  return parts;
}

} // namespace wavepath
