// What a study can vary, and the configurations that come of it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "host/render/render.h"

namespace wavepath {

struct DimensionValue {
  std::string_view name;
  void (*apply)(RenderSettings&);
};

// A flag of `wavepath render`: --NAME VALUE. A new one is a row in grid.cpp.
struct Dimension {
  std::string_view name;
  std::vector<DimensionValue> values; // the naive one first
};
const std::vector<Dimension>& dimensions();

struct Choice {
  std::string_view dimension, value;
};

struct Configuration {
  std::vector<Choice> choices;
  RenderSettings settings;

  std::string name(std::string_view between = " ") const; // "sobol mis"
  std::string flags() const;                              // "--sampler sobol --direct mis"
};

// Every combination of the values of the dimensions named, which exist; naive ones first.
std::vector<Configuration> make_grid(const std::vector<std::string>& vary, const RenderSettings& base);

} // namespace wavepath
