#include "host/render/settings/identity.h"

#include <sstream>

#include <fmt/format.h>

#include "host/render/settings/settings_table.h"
#include "host/render/settings/whole_nets.h"

namespace wavepath {
namespace {

std::string camera_text(const View& view) {
  const auto text = [](const glm::dvec3& v) { return fmt::format("{:a},{:a},{:a}", v.x, v.y, v.z); }; // exact
  return fmt::format("{}/{}/{}/{}/{}", view.orthographic ? "orthographic" : "perspective", text(view.position),
                     text(view.forward), text(view.right), text(view.up));
}

} // namespace

std::string identity_of(std::uint64_t scene_hash, const View& view, const RenderSettings& settings) {
  std::string identity = fmt::format("version={};scene={:016x}", WAVEPATH_VERSION, scene_hash);
  for (const Setting& row : settings_table()) {
    if (row.decides == Decides::nothing || !is_taken(row, *settings.integrator)) continue;
    if (row.identity) {
      if (const std::string text = row.identity(settings); !text.empty())
        identity += fmt::format(";{}={}", row.name, text);
      continue;
    }
    const std::string text = text_of(row, settings);
    identity += fmt::format(";{}={}", row.name, text.empty() ? "default" : text);
  }
  identity += fmt::format(";nets={}", has_whole_nets(settings) ? "whole" : "halved");
  return identity + ";camera=" + camera_text(view);
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
    if (key == "nets") // what else decides that was compared before
      return fmt::format("its pixels have {} nets of samples, not {} ones (--aov variance and --denoise halve them)",
                         ours.substr(split + 1), theirs.substr(split + 1));
    return fmt::format("{} is {}, not {}", key, ours.substr(split + 1), theirs.substr(split + 1));
  }
}

} // namespace wavepath
