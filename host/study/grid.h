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

// A flag of `wavepath render`: --NAME VALUE, or --NAME alone for a value of "on". A new one is a row in grid.cpp.
struct Dimension {
  std::string_view name;
  std::vector<DimensionValue> values;               // the naive one first
  bool (*matters)(const RenderSettings&) = nullptr; // whether the others let it change anything; null = always
};
const std::vector<Dimension>& dimensions();

struct Choice {
  std::string_view dimension, value;
  bool operator==(const Choice&) const = default;
};

struct Configuration {
  std::vector<Choice> choices;
  RenderSettings settings;

  std::string name(std::string_view between = " ") const;      // "sobol mis", "hybrid 16 ao denoise"
  std::string flags() const;                                   // "--sampler sobol --direct mis"
  std::string_view value_of(std::string_view dimension) const; // empty where it changes nothing
};

// The flag that gives a choice; empty where it is what is given without.
std::string flag_of(const Choice& choice);

// Every combination of the values of the dimensions named, which exist; naive ones first. Values that change nothing
// are left out of a configuration, so that none is there twice.
std::vector<Configuration> make_grid(const std::vector<std::string>& vary, const RenderSettings& base);

} // namespace wavepath
