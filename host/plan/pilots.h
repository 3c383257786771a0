// The pilots that decide about a render before it begins: short renders of a small picture, which are thrown away.
//
// docs/architecture.md lists all short renders beside a render; those that the loop makes (training of light selection
// and guiding, noise, ambient light) are sized where they are made, since what they learn goes into the render itself.
#pragma once

#include <cstdint>
#include <string_view>

namespace wavepath {

struct PilotRow {
  std::string_view decides;    // name of the setting
  std::uint32_t side, samples; // of its picture: pixels along the longer side, samples a pixel
  std::uint32_t pictures;      // how many of these, at least
  std::uint32_t seed;          // by exclusive or with the render's own
  double render_over_pilots;   // paths of the render, at least, over those of its pictures
  double worthwhile;           // cost beside the rule's below which a candidate is taken
};

// A candidate whose cost is above this is not told from chance.
inline constexpr double kWorthwhile = 0.9;

// Several sky samples are taken only where they pay by factors. With a floor and three balls under an open sky, where
// costs of 0.78 and 0.81 were predicted, four directions take 1.03, and seven that are learned 3.5 (generated scene 10,
// llvmpipe): counted work leaves out what shading takes. Where it pays, it pays 0.31 to 0.45 (Sponza).
inline constexpr PilotRow kSkyPilot{"sky-samples", 48, 8, 2, 0x85ebca6bu, 20.0, 0.7};
// Of each candidate; and of those that may be alike once more. One is left for another by a standard error.
inline constexpr PilotRow kIntegratorPilot{"integrator", 64, 16, 1, 0x9e3779b9u, 20.0, 1.0};
inline constexpr PilotRow kIntegratorPilotAgain{"integrator", 64, 64, 1, 0x9e3779b9u, 10.0, 1.0};
// Pixels of the pilot are those of few quads of the picture.
inline constexpr PilotRow kReusePilot{"reuse", 96, 4, 2, 0x27d4eb2fu, 14.0, kWorthwhile};
inline constexpr PilotRow kPilots[] = {kSkyPilot, kIntegratorPilot, kIntegratorPilotAgain, kReusePilot};

} // namespace wavepath
