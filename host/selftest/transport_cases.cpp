// Cases of light transport: furnaces, Fresnel, enclosures, lights of extreme size and strength.
#include <cmath>

#include <fmt/format.h>

#include "host/selftest/scenes.h"
#include "host/selftest/selftest.h"

namespace wavepath {
namespace {

// A white plane under a white sky: every sample is exactly 1.
Measurement lambert_furnace(const SelftestContext& context) {
  Scene scene;
  add_quad(scene, {-1e3f, 0, 1e3f}, {2e3f, 0, 0}, {0, 0, -2e3f}, add_lambert(scene, glm::vec3(1.0f)));
  scene.environment.radiance = glm::vec3(1.0f);
  look_at(scene, {0, 1, 0}, {0, 0, -1}, 0.5);
  RenderSettings settings;
  settings.width = settings.height = 16;
  settings.last_sample = 16;
  settings.max_depth = 4;
  const RenderResult result = render_scene(context.device, scene, settings);
  double worst = 0.0;
  for (const float value : result.picture.channels[0].values) worst = std::max(worst, std::abs(double(value) - 1.0));
  return judge_near(1.0 + worst, 1.0, 1e-6, "the pixel farthest from 1");
}

constexpr SelftestCase kCases[] = {
    {22, "white furnace, Lambert", "diffuse surfaces gain or lose light at every bounce", lambert_furnace},
};

} // namespace

std::span<const SelftestCase> transport_cases() { return kCases; }

} // namespace wavepath
