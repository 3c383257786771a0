#include "host/study/grid.h"

#include <algorithm>

#include <fmt/format.h>

namespace wavepath {

const std::vector<Dimension>& dimensions() {
  using S = RenderSettings;
  static const std::vector<Dimension> kDimensions = {
      {"sampler",
       {{"independent", [](S& s) { s.sampler = gpu::kSamplerIndependent; }},
        {"stratified", [](S& s) { s.sampler = gpu::kSamplerStratified; }},
        {"sobol", [](S& s) { s.sampler = gpu::kSamplerSobol; }}}},
      {"direct",
       {{"bsdf", [](S& s) { s.direct = gpu::kDirectBsdf; }},
        {"nee", [](S& s) { s.direct = gpu::kDirectNee; }},
        {"mis", [](S& s) { s.direct = gpu::kDirectMis; }}}},
      {"hemisphere",
       {{"uniform", [](S& s) { s.hemisphere = gpu::kHemisphereUniform; }},
        {"cosine", [](S& s) { s.hemisphere = gpu::kHemisphereCosine; }}}},
  };
  return kDimensions;
}

std::string Configuration::name(std::string_view between) const {
  std::vector<std::string_view> values;
  for (const Choice& choice : choices) values.push_back(choice.value);
  return fmt::format("{}", fmt::join(values, between));
}

std::string Configuration::flags() const {
  std::vector<std::string> flags;
  for (const Choice& choice : choices) flags.push_back(fmt::format("--{} {}", choice.dimension, choice.value));
  return fmt::format("{}", fmt::join(flags, " "));
}

std::vector<Configuration> make_grid(const std::vector<std::string>& vary, const RenderSettings& base) {
  std::vector<Configuration> grid = {{{}, base}};
  for (const std::string& name : vary) {
    const auto dimension =
        std::find_if(dimensions().begin(), dimensions().end(), [&](const Dimension& d) { return d.name == name; });
    std::vector<Configuration> finer;
    for (const Configuration& configuration : grid)
      for (const DimensionValue& value : dimension->values) {
        Configuration& next = finer.emplace_back(configuration);
        next.choices.push_back({dimension->name, value.name});
        value.apply(next.settings);
      }
    grid = std::move(finer);
  }
  return grid;
}

} // namespace wavepath
