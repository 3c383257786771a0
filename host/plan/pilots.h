// The pilots that decide about a render before it begins: short renders of a small picture, which are thrown away.
//
// docs/architecture.md lists all short renders. Those that the render loop itself makes (training of light selection
// and guiding, noise, ambient light) are sized where they are made, since their results are used by the render itself.
#pragma once

#include <cstdint>
#include <string_view>

#include "host/render/settings/worthwhile.h"

namespace wavepath {

// Pilots, with the training of lights and the pilot of noise, have at most a tenth of the paths of any render: a 64th
// is left to each of two rows, a 20th to that of integrators, a 26th to training (training.h), and to noise what is
// left (adaptive.h). tests/pilots_test.cpp counts.
inline constexpr double kPilotsOfRender = 0.1;

// Paths of a render below which kernels that bear what its pilots tried serve it to the end, though nothing was taken.
// Giving them up costs compiling: 5 % more of all seconds at 64 samples of 256x192 pixels, 2 % less at 256 (generated
// scene 3, llvmpipe).
inline constexpr double kCpuKeepsKernels = 6e6;

struct PilotRow {
  std::string_view decides;    // name of the setting
  std::uint32_t side, samples; // of a pilot's picture: pixels along the longer side, samples a pixel
  std::uint32_t pictures;      // largest number of such pictures that a decision takes
  std::uint32_t seed;          // exclusive-ored with the seed of the render
  double render_over_pilots;   // least ratio of the render's paths to those of all pictures
  double worthwhile;           // a candidate is taken if its cost, relative to the rule's choice, is below this
};

// Several sky samples must promise a large gain. With a floor and three balls under an open sky, costs of 0.78x and
// 0.81x were predicted, but four directions took 1.03x and seven learned ones 3.5x (generated scene 10, llvmpipe):
// counted work leaves out the cost of shading. Where several samples pay, they take 0.31x to 0.45x (Sponza).
inline constexpr PilotRow kSkyPilot{"sky-samples", 48, 8, 2, 0x85ebca6bu, 64.0, 0.7};
// The first row is of each candidate; the second repeats candidates whose costs are close. The first candidate is left
// only for one whose cost is lower by a standard error.
inline constexpr PilotRow kIntegratorPilot{"integrator", 64, 16, 3, 0x9e3779b9u, 20.0, 1.0};
inline constexpr PilotRow kIntegratorPilotAgain{"integrator", 64, 64, 2, 0x9e3779b9u, 32.0, 1.0};
// The picture of the pilot shows few quads of the whole picture at full resolution (RenderPlan::quad_scale).
inline constexpr PilotRow kReusePilot{"reuse", 64, 4, 2, 0x27d4eb2fu, 64.0, kWorthwhile};
inline constexpr PilotRow kPilots[] = {kSkyPilot, kIntegratorPilot, kIntegratorPilotAgain, kReusePilot};

} // namespace wavepath
