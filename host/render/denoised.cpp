#include "host/render/denoised.h"

#include <algorithm>
#include <iterator>

#include "host/base/clock.h"
#include "host/picture/files/picture_io.h"
#include "host/picture/filter/denoise.h"
#include "host/picture/filter/oidn.h"
#include "host/render/settings/denoising.h"

namespace wavepath {

DenoiseReport add_denoised(Picture& picture, const Film& film, std::uint32_t how) {
  const Clock::time_point start = Clock::now();
  const NoisyPicture noisy = noisy_picture(film);
  const std::vector<glm::vec3> filtered = how == kDenoiseOidn ? denoise_by_oidn(noisy) : denoise(noisy);
  glm::dvec3 before(0.0), after(0.0);
  std::vector<Channel> channels;
  for (int c = 0; c < 3; ++c) {
    Channel channel{std::string(kShownPrefix) + "RGB"[c], std::vector<float>(filtered.size())};
    for (std::size_t i = 0; i < filtered.size(); ++i) {
      channel.values[i] = filtered[i][c];
      before[c] += noisy.color[i][c];
      after[c] += filtered[i][c];
    }
    channels.push_back(std::move(channel));
  }
  std::ranges::move(channels, std::back_inserter(picture.channels));
  const double all = before.x + before.y + before.z;
  return {how == kDenoiseOidn ? "oidn" : "own", seconds_since(start),
          all > 0.0 ? (after.x + after.y + after.z) / all : 1.0};
}

void denoise_if_asked(RenderResult& result, const RenderPlan& settings) {
  if (denoises_film(settings)) result.denoised = add_denoised(result.picture, *result.film, settings.denoise);
}

} // namespace wavepath
