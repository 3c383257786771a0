// The rows of the table of settings: values and meaning of what can be set about local illumination.
#include <fmt/format.h>

#include "host/integrators/hybrid/shading/catalogue.h"
#include "host/render/settings/shading_settings.h"

namespace wavepath {
namespace {

using S = RenderSettings;

constexpr double kMostShininess = 1e5, kMostAttenuation = 1e10, kFarthestCue = 1e15;

void read_attenuation(const FlagValue& value, S& settings) {
  settings.attenuation.reset();
  if (value.text == "physical") return;
  const glm::dvec3 terms = value.triple();
  for (int i = 0; i < 3; ++i)
    if (!(terms[i] >= 0.0 && terms[i] <= kMostAttenuation))
      value.refuse("is no attenuation", fmt::format("give three numbers from 0 to {}, or physical", kMostAttenuation));
  const glm::vec3 held(terms); // what is too small for a float would divide by zero
  if (held == glm::vec3(0.0f)) value.refuse("leaves light unbounded", "give at least one term above 0");
  settings.attenuation = held;
}

std::string attenuation_text(const S& settings) {
  const std::optional<glm::vec3>& terms = settings.attenuation;
  return terms ? fmt::format("{},{},{}", terms->x, terms->y, terms->z) : "physical";
}

void read_depth_cue(const FlagValue& value, S& settings) {
  settings.depth_cue.reset();
  if (value.text == "off") return;
  const auto [near, far] = value.split(',', "write it as NEAR,FAR, such as 2,10");
  const glm::vec2 range(near.number(0.0, kFarthestCue), far.number(0.0, kFarthestCue));
  if (!(range.x < range.y)) value.refuse("is an empty range", "give NEAR,FAR with NEAR below FAR");
  settings.depth_cue = range;
}

std::string depth_cue_text(const S& settings) {
  return settings.depth_cue ? fmt::format("{},{}", settings.depth_cue->x, settings.depth_cue->y) : "off";
}

} // namespace

std::vector<Setting> shading_rows() {
  static const std::vector<std::string_view> names = kShadingModels.names();
  return {
      {.name = "shading",
       .value = ChoiceValue{&S::shading, names},
       .meaning =
           "model of direct light on visible surfaces. gltf: the material of the file. The others: classic models",
       .label = "shading",
       .study = names},
      {.name = "interpolation",
       .value = ChoiceValue{&S::interpolation, kInterpolationNames},
       .meaning = "positions at which a classic model of --shading is evaluated. flat: once per face. gouraud: at its "
                  "corners. phong: in every pixel",
       .label = "interpolation",
       .study = {"flat", "gouraud", "phong"}},
      {.name = "shininess",
       .value = OptionalNumberValue{&S::shininess, 0.0, kMostShininess},
       .meaning = "exponent of the highlights of a classic model",
       .placeholder = "N",
       .initial = "from the material's roughness"},
      {.name = "attenuation",
       .value = SpecialValue{read_attenuation, attenuation_text},
       .meaning = "falloff of lights with the distance d in a classic model. physical: 1 / d^2. Numbers: 1 / (CONST + "
                  "LINEAR d + QUADRATIC d^2)",
       .placeholder = "physical|CONST,LINEAR,QUADRATIC",
       .initial = "physical"},
      {.name = "depth-cue",
       .value = SpecialValue{read_depth_cue, depth_cue_text},
       .meaning = "depths in metres between which surfaces fade into the background",
       .placeholder = "NEAR,FAR",
       .initial = "off"},
  };
}

} // namespace wavepath
