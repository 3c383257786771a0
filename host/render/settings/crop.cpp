#include "host/render/settings/crop.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "host/render/settings/cover.h"
#include "host/render/settings/denoising.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/light_groups.h"
#include "host/render/settings/path_reuse.h"
#include "host/render/settings/probing.h"

namespace wavepath {

bool renders_part(const RenderPlan& settings) {
  return settings.crop && settings.integrator->traces_paths && !settings.integrator->splats;
}

FilmShape film_shape(const RenderPlan& settings) {
  FilmShape shape = picture_shape(settings);
  const gpu::FilmArea part = shape.area();
  shape.width = settings.width, shape.height = settings.height, shape.place = {};
  if (!renders_part(settings)) return shape;
  // Cut at the borders of tiles, which hold whole blocks and whole quads; of tile blocks where probes are by quads.
  const std::uint32_t shift_x = std::max(gpu::probe_shift_x(part, shape.probes()), 3u);
  const auto cut = [](std::uint32_t from, std::uint32_t size, std::uint32_t shift, std::uint32_t whole) {
    const std::uint32_t first = from >> shift << shift, end = ((from + size - 1) >> shift) + 1;
    return std::pair(first, std::min(end << shift, whole) - first);
  };
  std::tie(shape.place.left, shape.width) = cut(part.left, part.width, shift_x, settings.width);
  std::tie(shape.place.top, shape.height) = cut(part.top, part.height, 3, settings.height);
  shape.place.whole_width = settings.width, shape.place.whole_height = settings.height;
  return shape;
}

FilmShape picture_shape(const RenderPlan& settings) {
  FilmShape shape{.width = settings.width,
                  .height = settings.height,
                  .aovs = records_aovs(settings),
                  .splats = settings.integrator->splats,
                  .has_probes = has_error_probes(settings),
                  .seed = settings.seed,
                  .quads = reuses_paths(settings),
                  .groups = records_groups(settings) ? static_cast<std::uint32_t>(settings.group_names.size()) : 0,
                  .cover = has_cover(settings)};
  if (!settings.crop) return shape;
  shape.width = settings.crop->width, shape.height = settings.crop->height;
  shape.place = {settings.crop->left, settings.crop->top, settings.width, settings.height};
  return shape;
}

} // namespace wavepath
