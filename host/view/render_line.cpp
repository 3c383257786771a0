#include "host/view/render_line.h"

#include <fmt/format.h>

#include "host/base/shell_quote.h"
#include "host/film/picture_io.h"
#include "host/render/integrator.h"
#include "host/render/stats.h"
#include "host/view/camera_control.h"

namespace wavepath {

std::string render_line(const std::string& scene, const ViewRequest& camera, const RenderSettings& settings,
                        const DisplayOptions& display, const std::string& more) {
  const RenderSettings usual;
  const std::uint32_t whole = settings.sample_total > 0 ? settings.sample_total : settings.last_sample;
  std::string line = fmt::format("wavepath render {}{} --size {}x{} --spp {}", shell_quoted(scene),
                                 camera_flags(camera), settings.width, settings.height, whole);
  if (whole > settings.last_sample) line += fmt::format(" --samples 0:{}", settings.last_sample); // strata of the whole
  const auto add = [&line](const char* flag, const auto& value, const auto& otherwise) {
    if (value != otherwise) line += fmt::format(" {} {}", flag, value);
  };
  const auto name = [](const auto& names, auto value) { return std::string(names[static_cast<std::size_t>(value)]); };
  add("--integrator", settings.integrator->name, usual.integrator->name);
  add("--max-depth", settings.max_depth, usual.max_depth);
  add("--sampler", name(kSamplerNames, settings.sampler), name(kSamplerNames, usual.sampler));
  add("--hemisphere", name(kHemisphereNames, settings.hemisphere), name(kHemisphereNames, usual.hemisphere));
  add("--direct", name(kDirectNames, settings.direct), name(kDirectNames, usual.direct));
  add("--filter", name(kFilterNames, settings.filter), name(kFilterNames, usual.filter));
  add("--seed", settings.seed, usual.seed);
  if (!settings.integrator->traces_paths) {
    add("--shadow-samples", settings.shadow_samples, usual.shadow_samples);
    add("--ao-samples", settings.ao_samples, usual.ao_samples);
    if (settings.ao_radius) line += fmt::format(" --ao-radius {}", *settings.ao_radius);
    if (const auto& ambient = settings.ambient)
      line += fmt::format(" --ambient {},{},{}", ambient->x, ambient->y, ambient->z);
    if (settings.denoise) line += " --denoise";
  }
  add("--exposure", display.exposure, 0.0);
  add("--tonemap", name(kTonemapNames, display.tonemap), name(kTonemapNames, WriteOptions{}.tonemap));
  return line + more;
}

} // namespace wavepath
