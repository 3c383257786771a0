#include "host/render/identity.h"

#include <sstream>

#include <fmt/format.h>

#include "host/render/integrator.h"
#include "host/render/stats.h"

namespace wavepath {
namespace {

std::string camera_text(const View& view) {
  const auto text = [](const glm::dvec3& v) { return fmt::format("{:a},{:a},{:a}", v.x, v.y, v.z); }; // exact
  return fmt::format("{}/{}/{}/{}/{}", view.orthographic ? "orthographic" : "perspective", text(view.position),
                     text(view.forward), text(view.right), text(view.up));
}

std::string integrator_text(const RenderSettings& settings) {
  const std::string_view name = settings.integrator->name;
  if (settings.integrator->traces_paths) return std::string(name);
  const glm::vec3 ambient = settings.ambient.value_or(glm::vec3(-1.0f)); // estimated
  return fmt::format("{}/{}/{}/{:a}/{:a},{:a},{:a}", name, settings.shadow_samples, settings.ao_samples,
                     settings.ao_radius.value_or(-1.0), ambient.r, ambient.g, ambient.b);
}

} // namespace

std::string identity_of(std::uint64_t scene_hash, const View& view, const RenderSettings& settings) {
  // Only the stratified sampler lays its points out for a known number of them.
  const std::uint32_t total = settings.sample_total > 0 ? settings.sample_total : settings.last_sample;
  const std::string strata = settings.sampler == gpu::kSamplerStratified ? fmt::format("{}", total) : "any";
  return fmt::format(
      "version={};scene={:016x};size={}x{};seed={};sampler={};max-depth={};direct={};hemisphere={};filter={};spp={};"
      "adaptive={};aovs={};integrator={};camera={}",
      WAVEPATH_VERSION, scene_hash, settings.width, settings.height, settings.seed, kSamplerNames[settings.sampler],
      settings.max_depth, kDirectNames[settings.direct], kHemisphereNames[settings.hemisphere],
      kFilterNames[settings.filter], strata, settings.adaptive ? "on" : "off", settings.aovs.empty() ? "no" : "yes",
      integrator_text(settings), camera_text(view));
}

std::optional<std::string> first_difference(const std::string& identity, const std::string& expected) {
  std::istringstream a(identity), b(expected);
  std::string ours, theirs;
  while (true) {
    const bool more_a = static_cast<bool>(std::getline(a, ours, ';')),
               more_b = static_cast<bool>(std::getline(b, theirs, ';'));
    if (!more_a && !more_b) return std::nullopt;
    if (!more_a || !more_b) return "other settings are recorded in it";
    if (ours == theirs) continue;
    const std::size_t split = ours.find('=');
    if (split == std::string::npos || theirs.compare(0, split + 1, ours, 0, split + 1) != 0)
      return "other settings are recorded in it";
    const std::string key = ours.substr(0, split);
    if (key == "scene") return "the scene is another";
    if (key == "camera") return "the camera is another";
    return fmt::format("{} is {}, not {}", key, ours.substr(split + 1), theirs.substr(split + 1));
  }
}

} // namespace wavepath
