#include "host/session/viewing/viewed_scene.h"

#include "host/base/error.h"
#include "host/render/settings/denoising.h"
#include "host/render/settings/setting.h"
#include "host/scene/pack/light_groups.h"

namespace wavepath {

SessionRequest session_request(const SceneRequest& scene, const RenderRequest& render) {
  return {.scene = scene, .render = render, .use = SessionUse::light, .keeps_cut = true};
}

bool is_viewed(const Setting& row, const IntegratorKind& kind) {
  return row.label && is_supported(row, kind) && !(row.name == "denoise" && kind.traces_paths);
}

void settle(RenderPlan& settings, std::uint32_t planned) {
  if (denoises_film(settings)) settings.denoise = kDenoiseOff; // the integrator has become another
  if (settings.sample_total != planned) settings.last_sample = settings.sample_total;
}

ViewedScene::ViewedScene(Session& session, const RenderPlan& settings)
    : session_(session), render_(session.begin(settings, [this] { comparison_.reset(); })) {}

SessionUpdate ViewedScene::move(const ViewRequest& camera) {
  session_.set_view(camera);
  const SessionUpdate update = session_.update();
  if (comparison_) comparison_->move(session_.view(render_.settings().width, render_.settings().height));
  return update;
}

SessionUpdate ViewedScene::set_settings(const RenderPlan& settings, const ViewRequest& camera) {
  const auto take = [&](const RenderPlan& wanted) {
    session_.set_view(camera);
    session_.set_settings(wanted);
    const SessionUpdate update = session_.update();
    if (comparison_ && supports(*wanted.integrator, "shadows")) comparison_->follow(render_.view());
    return update;
  };
  const RenderPlan before = render_.settings();
  try {
    return take(settings);
  } catch (const Error&) {
    comparison_.reset(); // which may have come half the way
    take(before);
    throw;
  }
}

SessionUpdate ViewedScene::set_environment(const EnvironmentRequest& environment) {
  session_.set_environment(environment);
  try {
    const RenderPlan& settings = render_.settings();
    if (find_group_names(session_.scene(), settings.light_groups) != settings.group_names)
      throw Error("--light-groups", "has other groups under this environment", "begin another window for it");
    return session_.update();
  } catch (const Error&) {
    session_.reset_environment();
    session_.update();
    throw;
  }
}

SessionUpdate ViewedScene::set_variant(const std::string& name) {
  const std::string before = session_.scene_request().load.variant;
  session_.set_variant(name);
  try {
    return session_.update();
  } catch (const Error&) {
    session_.set_variant(before);
    session_.update();
    throw;
  }
}

void ViewedScene::rest() {
  render_.rest();
  if (comparison_) comparison_->rest();
}

void ViewedScene::compare(std::uint32_t against) {
  comparison_.reset();
  comparison_ = std::make_unique<ShadowComparison>(render_, against);
}

} // namespace wavepath
