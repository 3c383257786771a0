// wavepath render: resolves the request, prepares the scene, plans, renders, writes and reports.
#include <memory>

#include "host/cli/commands.h"
#include "host/cli/flags.h"
#include "host/cli/motion_flags.h"
#include "host/cli/render_finish.h"
#include "host/cli/render_request.h"
#include "host/cli/render_run.h"
#include "host/cli/sequence.h"
#include "host/cli/sequence_request.h"

namespace wavepath {
namespace {

int run_render(RenderCommandRequest& request) {
  const std::string& animation = request.scene.load.animation;
  check_sequence(request.sequence, animation);
  check_motion(request.motion, request.render.settings, animation, request.sequence.frames.has_value());
  if (request.sequence.frames) return render_sequence(request);
  const std::optional<Picture> reference = resolve(request);
  const std::unique_ptr<Session> session = open_session(request, SessionUse::one_picture);
  session->update(request.render);
  Prepared& prepared = session->prepared();
  require_writers(request.output);
  plan_render(request, prepared);
  if (request.render.pixel) return replay(request, prepared);
  Rendered rendered =
      run(request, prepared, reference, [&](const RenderResult& so_far) { save_so_far(request, prepared, so_far); });
  return finish(request, prepared, rendered, reference);
}

} // namespace

Command add_render(CLI::App& app, const std::string& command_line) {
  CLI::App* command = add_command(app, "render", "render a glTF scene to a picture");
  const auto request = std::make_shared<RenderCommandRequest>();
  request->command_line = command_line;
  add_flags_of_render(*command, *request);
  return [request] { return run_render(*request); };
}

} // namespace wavepath
