// The scene that a viewer shows: a session, the render of it that the viewer steps, and the renders that its shadows
// are compared with. What the user changes becomes edits of the session, which tells what they had redone.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "host/render/progressive/progressive.h"
#include "host/render/progressive/shadow_comparison.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/render_plan.h"
#include "host/render/settings/setting.h"
#include "host/session/session.h"

namespace wavepath {

// What a window wants of its session: no more than it changes is kept, and a move of the camera must not wait.
SessionRequest session_request(const SceneRequest& scene, const RenderRequest& render);

// Whether a viewer offers this setting. It filters frames; the filter of finished pictures is not for it.
bool is_viewed(const Setting& row, const IntegratorKind& kind);
// After settings were changed one by one: what others follow. `planned`: samples a pixel before.
void settle(RenderPlan& settings, std::uint32_t planned);

class ViewedScene {
public:
  // `settings` leave nothing to decide. Throws Error if the device cannot hold the scene.
  ViewedScene(Session& session, const RenderPlan& settings);
  ViewedScene(ViewedScene&&) = delete;

  Session& session() { return session_; }
  Progressive& render() { return render_; }
  const Progressive& render() const { return render_; }

  // Each throws Error; then everything is as it was.
  SessionUpdate move(const ViewRequest& camera); // coarse until rest()
  SessionUpdate set_settings(const RenderPlan& settings, const ViewRequest& camera);
  SessionUpdate set_environment(const EnvironmentRequest& environment);
  SessionUpdate set_variant(const std::string& name);
  void rest();

  // Begins a comparison with the shadow technique `against`, in place of another one. Throws Error; then there is none.
  void compare(std::uint32_t against);
  void stop_comparing() { comparison_.reset(); }
  // Null where there is none; so it is too after another scene had to be packed.
  ShadowComparison* comparison() const { return comparison_.get(); }

  // Steps the render, or the comparison where there is one. False if there was nothing to do.
  bool step() { return comparison_ ? comparison_->step() : render_.step(); }

private:
  Session& session_;
  Progressive& render_;
  std::unique_ptr<ShadowComparison> comparison_;
};

} // namespace wavepath
