#include "host/render/report/camera_json.h"

#include <cmath>

#include <glm/gtc/constants.hpp>

namespace wavepath {
namespace {

using Json = nlohmann::ordered_json;

Json list_of(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

} // namespace

Json camera_json(const View& view, std::uint32_t width, std::uint32_t height) {
  const Projection projection = view.panorama == Panorama::fisheye  ? Projection::fisheye
                                : view.panorama == Panorama::sphere ? Projection::equirectangular
                                : view.orthographic                 ? Projection::orthographic
                                                                    : Projection::perspective;
  const std::optional<glm::dvec2> angles = angles_of(view);
  const std::optional<Intrinsics> k = intrinsics_of(view, width, height);
  return {{"projection", kProjectionNames[static_cast<std::size_t>(projection)]},
          {"position", list_of(view.position)},
          {"forward", list_of(view.forward)},
          {"right", list_of(view.right)},
          {"up", list_of(view.up)},
          {"shift", {0.5 * view.shift.x, 0.5 * view.shift.y}},
          {"clip", {view.clip.near, std::isfinite(view.clip.far) ? Json(view.clip.far) : Json()}},
          {"stereo", view.eye_distance},
          {"velocity", list_of(view.velocity)},
          {"fov", angles ? Json{glm::degrees(angles->x), glm::degrees(angles->y)} : Json()},
          {"intrinsics", k ? Json{k->fx, k->fy, k->cx, k->cy} : Json()}};
}

Json camera_json(const Camera& camera) {
  Json matrix = Json::array();
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) matrix.push_back(camera.world_from_camera[column][row]);
  Json json = {{"name", camera.name},
               {"kind", camera.orthographic ? "orthographic" : "perspective"},
               {"znear", camera.znear ? Json(*camera.znear) : Json()},
               {"zfar", camera.zfar ? Json(*camera.zfar) : Json()},
               {"world_from_camera", matrix}};
  if (camera.orthographic)
    json.update({{"xmag", camera.xmag}, {"ymag", camera.ymag}});
  else
    json.update({{"yfov", glm::degrees(camera.yfov)}, {"aspect", camera.aspect > 0.0 ? Json(camera.aspect) : Json()}});
  return json;
}

} // namespace wavepath
