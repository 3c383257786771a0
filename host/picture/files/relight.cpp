#include "host/picture/files/relight.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/film/group_layers.h"

namespace wavepath {
namespace {

// Layers of light that no group tells apart; of a filtered picture as well, whose filter went by all light.
constexpr std::array<std::string_view, 5> kLayersOfAll = {"direct", "indirect", "emission", "variance", "denoised"};

Channel* channel_of(Picture& picture, const std::string& name) {
  const auto found = std::ranges::find(picture.channels, name, &Channel::name);
  return found == picture.channels.end() ? nullptr : &*found;
}

std::vector<std::string> remove_layers_of_all(Picture& picture) {
  std::vector<std::string> removed;
  std::erase_if(picture.channels, [&](const Channel& channel) {
    const std::string layer = channel.name.substr(0, channel.name.find('.'));
    const bool goes = channel.name.size() > layer.size() && std::ranges::count(kLayersOfAll, layer) > 0;
    if (goes && std::ranges::count(removed, layer) == 0) removed.push_back(layer);
    return goes;
  });
  return removed;
}

} // namespace

std::vector<std::string> relight(const std::string& file, const std::vector<std::string>& groups,
                                 const std::vector<GroupGain>& gains, Picture& picture) {
  if (groups.empty())
    throw Error(file, "has no groups of lights", "render it to an .exr with --light-groups NAMES or each");
  for (const GroupGain& gain : gains)
    if (std::ranges::count(groups, gain.group) == 0)
      throw UsageError("--gain", fmt::format("{} has no group '{}'", file, gain.group),
                       fmt::format("name some of: {}", fmt::join(groups, ", ")));
  const std::vector<std::string> layers = group_layers(groups);
  for (int c = 0; c < 3; ++c) {
    std::vector<Channel*> of_groups;
    for (const std::string& layer : layers) {
      const std::string name = fmt::format("{}.{}", layer, "RGB"[c]);
      of_groups.push_back(channel_of(picture, name));
      if (!of_groups.back()) throw Error(file, fmt::format("lacks channel {}", name), "render it again");
    }
    std::vector<double> factors(groups.size(), 1.0);
    for (const GroupGain& gain : gains)
      factors[static_cast<std::size_t>(std::ranges::find(groups, gain.group) - groups.begin())] = gain.factor[c];
    // Where nothing changes the picture is nearer to its exact sums than a sum of rounded layers.
    if (std::ranges::all_of(factors, [](double factor) { return factor == 1.0; })) continue;
    std::vector<float>& all = picture.channels[static_cast<std::size_t>(c)].values;
    for (std::size_t i = 0; i < all.size(); ++i) {
      double sum = 0.0;
      for (std::size_t g = 0; g < factors.size(); ++g) {
        float& light = of_groups[g]->values[i];
        const double scaled = factors[g] * double{light};
        light = static_cast<float>(scaled);
        sum += scaled;
      }
      all[i] = static_cast<float>(sum);
    }
  }
  return remove_layers_of_all(picture);
}

} // namespace wavepath
