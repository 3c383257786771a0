#include "host/study/grid.h"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "host/render/integrator.h"

namespace wavepath {

const std::vector<Dimension>& dimensions() {
  using S = RenderSettings;
  const auto shades = [](const S& s) { return s.integrator->finds_light; };
  const auto rasterizes = [](const S& s) { return !s.integrator->traces_paths; };
  static const std::vector<Dimension> kDimensions = {
      {"sampler",
       {{"independent", [](S& s) { s.sampler = gpu::kSamplerIndependent; }},
        {"stratified", [](S& s) { s.sampler = gpu::kSamplerStratified; }},
        {"sobol", [](S& s) { s.sampler = gpu::kSamplerSobol; }}}},
      {"direct",
       {{"bsdf", [](S& s) { s.direct = gpu::kDirectBsdf; }},
        {"nee", [](S& s) { s.direct = gpu::kDirectNee; }},
        {"mis", [](S& s) { s.direct = gpu::kDirectMis; }}},
       shades},
      {"hemisphere",
       {{"uniform", [](S& s) { s.hemisphere = gpu::kHemisphereUniform; }},
        {"cosine", [](S& s) { s.hemisphere = gpu::kHemisphereCosine; }}},
       shades},
      {"integrator",
       {{"path", [](S& s) { s.integrator = find_integrator("path"); }},
        {"hybrid", [](S& s) { s.integrator = find_integrator("hybrid"); }},
        {"ao", [](S& s) { s.integrator = find_integrator("ao"); }}}},
      {"shadow-samples",
       {{"1", [](S& s) { s.shadow_samples = 1; }},
        {"4", [](S& s) { s.shadow_samples = 4; }},
        {"16", [](S& s) { s.shadow_samples = 16; }}},
       [](const S& s) { return takes(*s.integrator, "shadow-samples"); }},
      {"ao-samples",
       {{"1", [](S& s) { s.ao_samples = 1; }},
        {"4", [](S& s) { s.ao_samples = 4; }},
        {"16", [](S& s) { s.ao_samples = 16; }}},
       rasterizes},
      {"denoise", {{"off", [](S& s) { s.denoise = false; }}, {"on", [](S& s) { s.denoise = true; }}}, rasterizes},
  };
  return kDimensions;
}

namespace {

const Dimension& dimension_of(std::string_view name) {
  return *std::find_if(dimensions().begin(), dimensions().end(), [&](const Dimension& d) { return d.name == name; });
}

void apply(const Choice& choice, RenderSettings& settings) {
  const std::vector<DimensionValue>& values = dimension_of(choice.dimension).values;
  std::find_if(values.begin(), values.end(), [&](const DimensionValue& v) {
    return v.name == choice.value;
  })->apply(settings);
}

// Without the choices that change nothing.
Configuration reduced(const Configuration& full, const RenderSettings& base) {
  Configuration result{{}, base};
  for (const Choice& choice : full.choices) {
    const auto matters = dimension_of(choice.dimension).matters;
    if (matters && !matters(full.settings)) continue;
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

std::vector<Configuration> make_grid(const std::vector<std::string>& vary, const RenderSettings& base) {
  std::vector<Configuration> product = {{{}, base}};
  for (const std::string& name : vary) {
    std::vector<Configuration> finer;
    for (const Configuration& configuration : product)
      for (const DimensionValue& value : dimension_of(name).values) {
        Configuration& next = finer.emplace_back(configuration);
        next.choices.push_back({dimension_of(name).name, value.name});
        value.apply(next.settings);
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
