#include "host/convert/mitsuba_scene.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "host/convert/mitsuba_reader.h"

namespace wavepath::convert {
namespace {

constexpr int kDeepWithoutEnd = 32; // bounces of a render whose file knows no limit

// Mitsuba counts the surfaces of a path with the light, wavepath the bounces before it.
int depth_of(const MitsubaReader& reader, const pugi::xml_node& integrator) {
  const pugi::xml_node inner = integrator.child("integrator");
  if (inner) return depth_of(reader, inner);
  const std::string type = attribute(reader, integrator, "type");
  const double depth = read_float(reader, integrator, "max_depth", type == "direct" ? 2.0 : -1.0);
  return depth < 0.0 ? kDeepWithoutEnd : static_cast<int>(std::clamp(depth - 1.0, 0.0, 1000.0));
}

} // namespace

Description read_mitsuba(const std::string& path) {
  MitsubaReader reader;
  reader.scene.format = "Mitsuba";
  for (const pugi::xml_node& node : read_elements(reader, path)) {
    const std::string_view tag = node.name();
    if (tag == "shape")
      read_shape_of(reader, node);
    else if (tag == "emitter")
      read_emitter(reader, node);
    else if (tag == "sensor")
      read_sensor(reader, node);
    else if (tag == "integrator")
      reader.scene.max_depth = depth_of(reader, node);
    else if (tag != "bsdf" && tag != "texture" && tag != "medium" && tag != "spectrum" && tag != "string" &&
             tag != "integer" && tag != "float" && tag != "boolean" && tag != "sampler" && tag != "film")
      reader.scene.losses.add(fmt::format("element <{}>", tag));
  }
  return std::move(reader.scene);
}

} // namespace wavepath::convert
