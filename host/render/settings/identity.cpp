#include "host/render/settings/identity.h"

#include <algorithm>
#include <sstream>
#include <vector>

#include <fmt/format.h>

#include "host/render/settings/probing.h"
#include "host/render/settings/settings_table.h"

namespace wavepath {
namespace {

std::string camera_text(const View& view) {
  const auto text = [](const glm::dvec3& v) { return fmt::format("{:a},{:a},{:a}", v.x, v.y, v.z); }; // exact
  std::string camera = fmt::format("{}/{}/{}/{}/{}", view.orthographic ? "orthographic" : "perspective",
                                   text(view.position), text(view.forward), text(view.right), text(view.up));
  if (has_camera_model(view))
    camera += fmt::format("/{}/{:a},{:a}/{:a}/{:a},{:a}/{:a}", static_cast<int>(view.panorama), view.shift.x,
                          view.shift.y, view.angle_limit, view.clip.near, view.clip.far, view.eye_distance);
  if (view.velocity != glm::dvec3(0.0)) camera += "/" + text(view.velocity);
  return camera;
}

struct Record {
  std::string key, value;
};

std::vector<Record> records_of(const std::string& identity) {
  std::vector<Record> records;
  std::istringstream lines(identity);
  for (std::string text; std::getline(lines, text, ';');) {
    const std::size_t split = std::min(text.find('='), text.size());
    records.push_back({text.substr(0, split), text.substr(std::min(split + 1, text.size()))});
  }
  return records;
}

} // namespace

std::string identity_of(std::uint64_t scene_hash, const View& view, const RenderPlan& settings) {
  std::string identity = fmt::format("version={};scene={:016x}", WAVEPATH_VERSION, scene_hash);
  for (const Setting& row : settings_table()) {
    if (row.decides == Decides::nothing || !is_supported(row, settings)) continue;
    if (row.identity) {
      if (const std::string text = row.identity(settings); !text.empty())
        identity += fmt::format(";{}={}", row.name, text);
      continue;
    }
    const std::string text = text_of(row, settings);
    identity += fmt::format(";{}={}", row.name, text.empty() ? "default" : text);
  }
  identity += fmt::format(";nets={}", has_error_probes(settings) ? "whole" : "halved");
  return identity + ";camera=" + camera_text(view);
}

std::optional<std::string> first_difference(const std::string& identity, const std::string& expected) {
  const std::vector<Record> ours = records_of(identity), theirs = records_of(expected);
  for (const Record& record : ours) {
    const auto other = std::ranges::find(theirs, record.key, &Record::key);
    if (other == theirs.end() || other->value == record.value) continue;
    if (record.key == "scene") return "the scene is another";
    if (record.key == "camera") return "the camera is another";
    if (record.key == "nets") // what else decides that was compared before
      return fmt::format("it has {} (--aov variance and --denoise split samples between replicates)",
                         record.value == "whole" ? "error probes, not samples split between two replicates"
                                                 : "samples split between two replicates, not error probes");
    return fmt::format("{} is {}, not {}", record.key, record.value, other->value);
  }
  // Where pixels share nothing no record says so.
  const auto has_reuse = [](const std::vector<Record>& records) {
    return std::ranges::find(records, "reuse", &Record::key) != records.end();
  };
  if (has_reuse(ours) != has_reuse(theirs)) return has_reuse(ours) ? "reuse is on, not off" : "reuse is off, not on";
  if (identity != expected) return "other settings are recorded in it";
  return std::nullopt;
}

} // namespace wavepath
