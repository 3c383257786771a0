// Lights of a resident scene, and their edits.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <wavepath/session.h>
#include <glm/glm.hpp>

#include "host/base/error.h"
#include "host/library/field_value.h"
#include "host/library/guard.h"
#include "host/library/session_state.h"
#include "host/render/settings/flag_value.h"
#include "host/scene/scene.h"

namespace wavepath_v0 {
namespace {

using wavepath::LightKind;
using wavepath::PunctualLight;

// Reads and writes a field of a light in the units of the interface.
struct LightField {
  const char* name;
  std::size_t count; // of its values
  bool (*has)(LightKind kind);
  std::vector<double> (*read)(const PunctualLight& light);
  void (*write)(const std::vector<double>& value, PunctualLight& light);
};

bool is_local(LightKind kind) { return kind != LightKind::directional; }

const LightField kLightFields[] = {
    {"intensity", 3, [](LightKind) { return true; },
     [](const PunctualLight& light) {
       return std::vector<double>{light.intensity.x, light.intensity.y, light.intensity.z};
     },
     [](const std::vector<double>& value, PunctualLight& light) {
       light.intensity = glm::vec3(value[0], value[1], value[2]);
     }},
    {"range", 1, is_local, [](const PunctualLight& light) { return std::vector<double>{light.range}; },
     [](const std::vector<double>& value, PunctualLight& light) { light.range = value[0]; }},
    {"cones", 2, [](LightKind kind) { return kind == LightKind::spot; },
     [](const PunctualLight& light) {
       return std::vector<double>{glm::degrees(light.inner_cone), glm::degrees(light.outer_cone)};
     },
     [](const std::vector<double>& value, PunctualLight& light) {
       light.inner_cone = glm::radians(value[0]), light.outer_cone = glm::radians(value[1]);
     }},
    {"radius", 1, is_local, [](const PunctualLight& light) { return std::vector<double>{light.extent}; },
     [](const std::vector<double>& value, PunctualLight& light) { light.extent = value[0]; }},
    {"angle", 1, [](LightKind kind) { return kind == LightKind::directional; },
     [](const PunctualLight& light) { return std::vector<double>{2.0 * glm::degrees(light.extent)}; },
     [](const std::vector<double>& value, PunctualLight& light) { light.extent = glm::radians(0.5 * value[0]); }},
};

const LightField& field_of(const PunctualLight& light, const std::string& name) {
  const LightField* found = std::ranges::find(kLightFields, name, &LightField::name);
  if (found == std::end(kLightFields))
    throw wavepath::UsageError(name, "is no field of a light", wavepath::suggestion(name, Session::light_fields()));
  static const char* const kinds[] = {"point", "spot", "directional"};
  if (!found->has(light.kind))
    throw wavepath::UsageError(
        light.name.empty() ? "light" : light.name,
        fmt::format("is a {} light, which has no '{}'", kinds[static_cast<int>(light.kind)], name),
        "give a field that it has");
  return *found;
}

std::uint32_t node_of(std::size_t node) {
  return node == Session::kAddedLight ? wavepath::kNoIndex : static_cast<std::uint32_t>(node);
}

// The light as it will be after update().
PunctualLight light_of(const SessionState& state, std::size_t node) {
  state.session->pose();
  for (const PunctualLight& light : state.session->scene().lights)
    if (light.node == node_of(node)) return light;
  throw wavepath::UsageError(node == Session::kAddedLight ? "light" : fmt::format("node {}", node),
                             "shows no light now", "make its node visible, or name another one");
}

} // namespace

const std::vector<std::string>& Session::light_fields() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const LightField& field : kLightFields) all.emplace_back(field.name);
    return all;
  }();
  return names;
}

std::vector<Named> Session::lights() const {
  return wavepath::guarded([&] {
    const DeviceLock lock(*state_->device);
    state_->session->pose(); // nodes that were shown or hidden
    std::vector<Named> lights;
    for (const PunctualLight& light : state_->session->scene().lights)
      lights.push_back({light.name, light.node == wavepath::kNoIndex ? kAddedLight : light.node});
    return lights;
  });
}

std::vector<double> Session::light(std::size_t node, const std::string& field) const {
  return wavepath::guarded([&] {
    const DeviceLock lock(*state_->device);
    const PunctualLight light = light_of(*state_, node);
    return field_of(light, field).read(light);
  });
}

void Session::set_light(std::size_t node, const std::string& field, const std::vector<double>& value) {
  wavepath::guarded([&] {
    const DeviceLock lock(*state_->device);
    PunctualLight light = light_of(*state_, node);
    const LightField& row = field_of(light, field);
    check_value(field, value, row.count);
    row.write(value, light);
    state_->session->set_light(node_of(node), light);
  });
}

} // namespace wavepath_v0
