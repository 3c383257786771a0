#include "host/integrators/hybrid/shadows/cookie.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/picture/files/picture_io.h"
#include "kernels/hybrid/shadows/cookie_types.h"

namespace wavepath {

std::vector<glm::vec4> read_cookie(const std::string& path, const DeviceInfo& device) {
  if (path.empty()) return std::vector<glm::vec4>(gpu::kCookieHeaderTexels);
  const Picture picture = read_light(path);
  const std::size_t texels = std::size_t{picture.width} * picture.height;
  const std::uint64_t most = std::min(device.max_texels(16), device.max_allocation / sizeof(glm::vec4));
  if (texels + gpu::kCookieHeaderTexels > most)
    throw Error(path,
                fmt::format("is {}x{} pixels, {:.0f} MiB on the device; at most {} pixels", picture.width,
                            picture.height, texels * sizeof(glm::vec4) / 1048576.0, most),
                "use a smaller picture");
  std::vector<glm::vec4> cookie = {
      glm::vec4(std::bit_cast<float>(picture.width), std::bit_cast<float>(picture.height), 0, 0)};
  cookie.reserve(texels + gpu::kCookieHeaderTexels);
  for (std::size_t i = 0; i < texels; ++i) {
    glm::vec4 texel(0.0f);
    for (std::size_t c = 0; c < 3; ++c) {
      texel[static_cast<int>(c)] = picture.channels[c].values[i];
      if (!(texel[static_cast<int>(c)] >= 0.0f) || !std::isfinite(texel[static_cast<int>(c)]))
        throw Error(path, fmt::format("has a value of {} as light", texel[static_cast<int>(c)]),
                    "use a picture without negative and infinite values");
    }
    cookie.push_back(texel);
  }
  return cookie;
}

} // namespace wavepath
