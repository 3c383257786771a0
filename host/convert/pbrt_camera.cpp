// Cameras and films of pbrt-v4.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/convert/pbrt_reader.h"

namespace wavepath::convert {
namespace {

constexpr double kDegree = 3.141592653589793 / 180.0;

} // namespace

void read_camera(PbrtReader& reader, const std::string& type, const PbrtParams& params) {
  Camera camera;
  camera.yfov = std::clamp(params.number("fov", 90.0), 0.01, 179.9) * kDegree; // of the shorter side, until finished
  camera.orthographic = type == "orthographic";
  if (type == "realistic" || type == "spherical")
    reader.scene.losses.add(fmt::format("camera '{}': a perspective one instead", type));
  else if (type != "perspective" && type != "orthographic")
    reader.tokens.fail(fmt::format("camera '{}' is none of pbrt-v4", type));
  camera.aperture = std::max(0.0, params.number("lensradius", 0.0));
  camera.focus = params.number("focaldistance", 1e6);
  if (const PbrtParam* window = params.find("screenwindow"); window && window->numbers.size() == 4) {
    const std::vector<double>& w = window->numbers;
    camera.ymag = 0.5 * std::abs(w[3] - w[2]), camera.xmag = 0.5 * std::abs(w[1] - w[0]);
    if (!camera.orthographic)
      camera.yfov = 2.0 * std::atan(std::tan(0.5 * camera.yfov) * std::min(camera.xmag, camera.ymag));
    if (std::abs(w[0] + w[1]) > 1e-6 || std::abs(w[2] + w[3]) > 1e-6)
      reader.scene.losses.add("screen window off the view axis: centred instead (see --shift)");
  } else {
    camera.xmag = camera.ymag = 0.0; // by the film
  }
  for (const char* name : {"shutteropen", "shutterclose"}) params.find(name);
  const double open = params.number("shutteropen", 0.0), close = params.number("shutterclose", 1.0);
  if (close > open) reader.scene.film_gain *= close - open;
  tell_unused(reader, fmt::format("camera '{}'", type), params);
  reader.coordinate_systems["camera"] = glm::inverse(reader.now.transform);
  // pbrt's cameras look along +Z.
  glm::dmat4 flip(1.0);
  flip[2][2] = -1.0;
  place_camera(reader.scene, camera, glm::inverse(reader.now.transform), flip);
}

void read_film(PbrtReader& reader, const PbrtParams& params) {
  const auto pixels = [&](const char* name, double otherwise) {
    return static_cast<std::uint32_t>(std::clamp(params.number(name, otherwise), 1.0, 65536.0));
  };
  reader.scene.width = pixels("xresolution", 1280.0), reader.scene.height = pixels("yresolution", 720.0);
  reader.scene.film_gain *= std::max(0.0, params.number("iso", 100.0)) / 100.0;
  const std::string sensor = params.text("sensor", "cie1931");
  if (sensor != "cie1931") reader.scene.losses.add(fmt::format("colours of the sensor '{}'", sensor));
  if (params.number("whitebalance", 0.0) > 0.0) reader.scene.losses.add("white balance of the film");
  for (const char* name : {"filename", "diagonal", "savefp16", "maxcomponentvalue"}) params.find(name);
  tell_unused(reader, "the film", params);
}

void finish_camera(PbrtReader& reader) {
  Description& scene = reader.scene;
  if (!scene.camera) return;
  if (scene.width == 0) scene.width = 1280, scene.height = 720;
  Camera& camera = *scene.camera;
  const double aspect = static_cast<double>(scene.width) / scene.height;
  if (camera.xmag == 0.0) camera.ymag = std::max(1.0, 1.0 / aspect), camera.xmag = camera.ymag * aspect;
  if (aspect < 1.0) camera.yfov = 2.0 * std::atan(std::tan(0.5 * camera.yfov) / aspect);
}

} // namespace wavepath::convert
