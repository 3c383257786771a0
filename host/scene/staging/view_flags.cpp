#include "host/scene/staging/view_flags.h"

#include <cmath>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/base/shell_quote.h"

namespace wavepath {
namespace {

// The angle in degrees that --yfov turns into exactly these radians; rounding may need a neighbour of the quotient.
double exact_degrees(double radians) {
  const double first = glm::degrees(radians);
  double lower = first, upper = first;
  for (int i = 0; i < 4; ++i) {
    if (glm::radians(lower) == radians) return lower;
    if (glm::radians(upper) == radians) return upper;
    lower = std::nextafter(lower, 0.0), upper = std::nextafter(upper, 360.0);
  }
  return first;
}

std::string triple(const glm::dvec3& v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }

} // namespace

std::string camera_flags(const ViewRequest& request) {
  std::string flags;
  const auto add = [&](const char* flag, const std::string& value) { flags += fmt::format(" {} {}", flag, value); };
  if (!request.camera.empty()) add("--camera", shell_quoted(request.camera));
  if (request.eye) add("--eye", triple(*request.eye));
  if (request.look_at) add("--look-at", triple(*request.look_at));
  if (request.up) add("--up", triple(*request.up));
  if (request.yfov) add("--yfov", fmt::format("{}", exact_degrees(*request.yfov)));
  if (request.projection)
    add("--projection", std::string(kProjectionNames[static_cast<std::size_t>(*request.projection)]));
  if (request.fov) add("--fov", fmt::format("{}", exact_degrees(*request.fov)));
  if (request.ymag) add("--ymag", fmt::format("{}", *request.ymag));
  if (request.shift) add("--shift", fmt::format("{},{}", request.shift->x, request.shift->y));
  if (const auto& k = request.intrinsics) add("--intrinsics", fmt::format("{},{},{},{}", k->fx, k->fy, k->cx, k->cy));
  if (request.clips_as_file) add("--clip", "file");
  if (request.clip) add("--clip", fmt::format("{},{}", request.clip->near, request.clip->far));
  if (request.stereo != 0.0) add("--stereo", fmt::format("{}", request.stereo));
  if (request.velocity != glm::dvec3(0.0)) add("--velocity", triple(request.velocity));
  return flags;
}

} // namespace wavepath
