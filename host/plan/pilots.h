// The pilots that decide about a render before it begins: short renders of a small picture, which are thrown away.
//
// docs/architecture.md lists all short renders. Those that the render loop itself makes (training of light selection
// and guiding, noise, ambient light) are sized where they are made, since their results are used by the render itself.
#pragma once

#include <cstdint>
#include <string_view>

namespace wavepath {

struct PilotRow {
  std::string_view decides;    // name of the setting
  std::uint32_t side, samples; // of a pilot's picture: pixels along the longer side, samples a pixel
  std::uint32_t pictures;      // least number of such pictures that a decision takes
  std::uint32_t seed;          // exclusive-ored with the seed of the render
  double render_over_pilots;   // least ratio of the render's paths to those of all pictures
  double worthwhile;           // a candidate is taken if its cost, relative to the rule's choice, is below this
};

// Relative costs above this do not differ significantly from 1.
inline constexpr double kWorthwhile = 0.9;

// Several sky samples must promise a large gain. With a floor and three balls under an open sky, costs of 0.78x and
// 0.81x were predicted, but four directions took 1.03x and seven learned ones 3.5x (generated scene 10, llvmpipe):
// counted work leaves out the cost of shading. Where several samples pay, they take 0.31x to 0.45x (Sponza).
inline constexpr PilotRow kSkyPilot{"sky-samples", 48, 8, 2, 0x85ebca6bu, 20.0, 0.7};
// The first row is of each candidate; the second repeats candidates whose costs are close. The first candidate is left
// only for one whose cost is lower by a standard error.
inline constexpr PilotRow kIntegratorPilot{"integrator", 64, 16, 1, 0x9e3779b9u, 20.0, 1.0};
inline constexpr PilotRow kIntegratorPilotAgain{"integrator", 64, 64, 1, 0x9e3779b9u, 10.0, 1.0};
// The picture of the pilot shows few quads of the whole picture at full resolution (RenderPlan::quad_scale).
inline constexpr PilotRow kReusePilot{"reuse", 96, 4, 2, 0x27d4eb2fu, 14.0, kWorthwhile};
inline constexpr PilotRow kPilots[] = {kSkyPilot, kIntegratorPilot, kIntegratorPilotAgain, kReusePilot};

} // namespace wavepath
