#include "host/render/progressive/shadow_comparison.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/picture/files/picture_io.h"
#include "host/render/settings/settings_table.h"
#include "host/render/settings/shadow_settings.h"

namespace wavepath {
namespace {

// True if both settings give the same render: settings without effect on the technique do not count.
bool same_render(const RenderPlan& a, const RenderPlan& b) {
  if (a.integrator != b.integrator || a.width != b.width || a.height != b.height || a.aovs != b.aovs ||
      a.first_sample != b.first_sample || a.last_sample != b.last_sample)
    return false;
  return std::ranges::all_of(settings_table(), [&](const Setting& row) {
    const bool has_effect =
        is_supported(row, a) && (!a.integrator->has_effect || a.integrator->has_effect(a, row.name));
    return !has_effect || row.decides == Decides::nothing || text_of(row, a) == text_of(row, b);
  });
}

void take(Progressive& render, const RenderPlan& settings, const View& view) {
  if (!same_render(render.settings(), settings)) render.set_settings(settings, view);
}

} // namespace

ShadowComparison::ShadowComparison(Progressive& shown, std::uint32_t against) : shown_(shown), against_(against) {
  truth_ = shown.beside(truth_settings());
  const RenderPlan light = light_settings();
  const IntegratorKind& kind = *light.integrator;
  if (!kind.unsupported_reason || kind.unsupported_reason(light, shown.scene()).empty()) light_ = shown.beside(light);
}

// Techniques answer light samples alone: the truth estimates direct light as `shown` does, so that shadows alone
// differ.
RenderPlan ShadowComparison::truth_settings() const {
  RenderPlan settings = shown_.settings();
  settings.direct = direct_of(settings);
  settings.shadows = against_;
  return settings;
}

// A map of which all light passes: the smallest would do, and the cheapest technique.
RenderPlan ShadowComparison::light_settings() const {
  RenderPlan settings = shown_.settings();
  read_setting(setting_named("shadows"), "map", settings);
  settings.shadow_size = 64;
  settings.shadow_bias = RenderPlan{}.shadow_bias;
  settings.shadow_bias_amount.reset();
  settings.shadow_source = kShadowSourceRaster;
  settings.shadow_ambient = 1.0;
  return settings;
}

bool ShadowComparison::step() {
  std::array<Progressive*, 3> renders = {&shown_, truth_.get(), light_.get()};
  const auto samples = [](const Progressive* render) { return render ? render->spp() : ~0u; };
  std::ranges::stable_sort(renders, {}, samples);
  return std::ranges::any_of(renders, [](Progressive* render) { return render && render->step(); });
}

bool ShadowComparison::is_done() const { return truth_->is_done() && (!light_ || light_->is_done()); }

std::uint64_t ShadowComparison::samples() const { return std::uint64_t{truth_->spp()} + (light_ ? light_->spp() : 0); }

void ShadowComparison::move(const View& view) {
  truth_->move(view);
  if (light_) light_->move(view);
}

void ShadowComparison::rest() {
  truth_->rest();
  if (light_) light_->rest();
}

void ShadowComparison::follow(const View& view) {
  take(*truth_, truth_settings(), view);
  if (light_) take(*light_, light_settings(), view);
}

std::uint32_t ShadowComparison::common_spp() const {
  const auto full = [](const Progressive& render) { return render.coarse() == 1 ? render.spp() : 0; };
  const std::uint32_t both = std::min(full(shown_), full(*truth_));
  return light_ ? std::min(both, full(*light_)) : both;
}

ShadowVerdict ShadowComparison::judge() {
  if (!light_) return {};
  const Picture picture = shown_.picture(), truth = truth_->picture(), light = light_->picture();
  const ShadowedPicture ours{picture, light}, theirs{truth, light};
  return {score_shadows(ours, theirs), false_shadow_map(ours, theirs)};
}

std::uint32_t split_column(double at, std::uint32_t width) {
  return static_cast<std::uint32_t>(std::lround(std::clamp(at, 0.0, 1.0) * width));
}

Picture split_picture(Picture left, const Picture& right, double at) {
  const std::size_t first = split_column(at, left.width), width = left.width;
  for (Channel& channel : left.channels) {
    const Channel* other = find_channel(right, channel.name);
    if (!other) continue;
    for (std::size_t i = 0; i < channel.values.size(); ++i)
      if (i % width >= first) channel.values[i] = other->values[i];
  }
  return left;
}

} // namespace wavepath
