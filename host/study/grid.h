// The settings that a study can vary, and the grid of configurations that they span.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "host/render/settings/render_plan.h"

namespace wavepath {

// The settings that can be varied: rows of the table of settings with values for an axis.
std::vector<std::string_view> dimensions();

struct Choice {
  std::string_view dimension, value;
  bool operator==(const Choice&) const = default;
};

struct Configuration {
  std::vector<Choice> choices;
  RenderPlan settings;

  std::string name(std::string_view between = " ") const;      // "sobol mis", "hybrid 16 ao denoise"
  std::string flags() const;                                   // "--sampler sobol --direct mis"
  std::string_view value_of(std::string_view dimension) const; // empty where it changes nothing
};

// The flag that gives a choice; empty for a switch that is off.
std::string flag_of(const Choice& choice);

// Every combination of the values of the dimensions named, which exist; naive ones first. Values that the integrator
// does not support are left out of a configuration, so that none is there twice.
std::vector<Configuration> make_grid(const std::vector<std::string>& vary, const RenderPlan& base);

} // namespace wavepath
