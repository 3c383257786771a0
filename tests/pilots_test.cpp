// What pilots take of a render, counted in paths: over renders of all lengths, never more than a tenth with the
// training of lights and the pilot of noise, and nothing but training where a render is over within a second.
#include <cstdint>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/plan/adaptive.h"
#include "host/plan/pilot_runner.h"
#include "host/plan/reuse.h"
#include "host/plan/training.h"
#include "host/render/pilot_work.h"
#include "host/render/workspace/light_training.h"

namespace wavepath {
namespace {

struct Size {
  std::uint32_t width, height;
};
constexpr Size kSizes[] = {{32, 24},   {64, 48},   {200, 150},  {256, 192},
                           {400, 100}, {640, 480}, {1280, 720}, {3840, 2160}};

RenderPlan render_of(const Size& size, std::uint32_t spp) {
  RenderPlan settings;
  settings.width = size.width, settings.height = size.height, settings.last_sample = spp;
  settings.integrator = IntegratorSetting::automatic();
  return settings;
}

// At worst: of every row that is affordable all pictures, as fractions of the render. Where lights are learned, the
// first pilot of several rows trains.
struct Shares {
  double training, deciding;
};
Shares worst_case(const RenderPlan& render, bool learns) {
  const double all = expected_paths(render, DeviceClass::cpu),
               part = learns ? static_cast<double>(kPartTrainingPaths) : 0.0;
  const auto fraction = [&](const PilotRow& row, bool made) {
    return made ? PilotRunner::paths_of_all(row, render) / all : 0.0;
  };
  const BearsReuse reuse = where_to_try_reuse(render, DeviceClass::cpu);
  const bool tries_reuse = reuse == BearsReuse::anywhere || (reuse == BearsReuse::untrained && !learns);
  const bool integrators = is_affordable(kIntegratorPilot, render, DeviceClass::cpu, part);
  const bool again = integrators && is_affordable(kIntegratorPilotAgain, render, DeviceClass::cpu);
  const double training = learns ? static_cast<double>(light_training_paths(render, DeviceClass::cpu)) / all : 0.0;
  const double deciding = fraction(kSkyPilot, is_affordable(kSkyPilot, render, DeviceClass::cpu)) +
                          fraction(kIntegratorPilot, integrators) + fraction(kIntegratorPilotAgain, again) +
                          fraction(kReusePilot, tries_reuse) + (integrators || tries_reuse ? part / all : 0.0);
  return {training, deciding};
}

TEST(Pilots, HaveAtMostATenthOfAnyRender) {
  double most = 0.0;
  for (const Size& size : kSizes)
    for (std::uint32_t spp = 1; spp <= 1u << 16; spp += 1 + spp / 9)
      for (const bool learns : {false, true}) {
        const Shares shares = worst_case(render_of(size, spp), learns);
        EXPECT_LE(shares.training + shares.deciding, kPilotsOfRender)
            << fmt::format("{}x{}, {} samples, {}", size.width, size.height, spp, learns ? "learned" : "");
        most = std::max(most, shares.training + shares.deciding);
      }
  EXPECT_GT(most, 0.08) << "the rows of the table count";
}

TEST(Pilots, LeaveRendersOfLessThanASecondAlone) {
  for (const Size& size : kSizes)
    for (std::uint32_t spp = 1; spp <= 4096; spp *= 2) {
      const RenderPlan render = render_of(size, spp);
      if (paths_of(render) >= 1e6) continue;
      const Shares shares = worst_case(render, true);
      EXPECT_EQ(shares.deciding, 0.0) << size.width << " " << spp;
      EXPECT_LE(shares.training, 1.0 / 26.0) << size.width << " " << spp;
      EXPECT_FALSE(may_pay_adaptive(render)) << size.width << " " << spp;
    }
}

// The pilot of noise takes what the others leave (plan.cpp), which is enough for it from 12 samples on where one pilot
// found that other integrators need not be tried.
TEST(Pilots, LeaveEnoughForThatOfNoise) {
  for (const Size& size : {Size{256, 192}, Size{640, 480}, Size{1280, 720}, Size{3840, 2160}})
    for (const std::uint32_t spp : {12u, 16u, 32u, 64u, 256u})
      for (const bool learns : {false, true}) {
        const RenderPlan render = render_of(size, spp);
        if (!may_pay_adaptive(render)) continue;
        const Shares shares = worst_case(render, learns);
        const PilotRow& row = kIntegratorPilot;
        const double untried =
            is_affordable(row, render, DeviceClass::cpu, learns ? static_cast<double>(kPartTrainingPaths) : 0.0)
                ? 2.0 / 3.0 * PilotRunner::paths_of_all(row, render) / expected_paths(render, DeviceClass::cpu)
                : 0.0;
        const double noise = noise_pilot_fraction(render, DeviceClass::cpu);
        EXPECT_LE(noise, 1.0 / 32.0 + 1e-9) << size.width << " " << spp;
        EXPECT_LE(shares.training + shares.deciding - untried + noise, kPilotsOfRender)
            << size.width << " " << spp << " " << learns;
      }
}

} // namespace
} // namespace wavepath
