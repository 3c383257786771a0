#include "host/cli/render_request.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "host/base/atomic_file.h"
#include "host/base/error.h"
#include "host/base/output_files.h"
#include "host/cli/motion_flags.h"
#include "host/codecs/picture_module.h"
#include "host/picture/place.h"
#include "host/render/report/plan_file.h"
#include "host/render/settings/settings_table.h"
#include "host/session/open_scene.h"
#include "host/session/resolve.h"
#include "host/session/resume.h"

namespace wavepath {
namespace {

// Channels and sums that no output would hold.
void check_channels(const RenderCommandRequest& request) {
  const auto& pictures = request.output.pictures;
  if (std::ranges::count(pictures, PictureFormat::exr, picture_format) > 0) return;
  const bool shown = !request.output.tev.empty(); // tev has all channels
  if (!request.render.settings.aovs.empty() && !shown)
    throw UsageError("--aov", fmt::format("channels go into .exr files, and {} is none", fmt::join(pictures, ", ")),
                     "add -o FILE.exr, or leave out --aov");
  if (request.render.mergeable && !is_given(request.render, "samples"))
    throw UsageError("--mergeable", fmt::format("sums go into .exr files, and {} is none", fmt::join(pictures, ", ")),
                     "add -o FILE.exr, or leave out --mergeable");
}

// Refuses files that cannot be read or written.
void check_files(RenderCommandRequest& request) {
  OutputRequest& output = request.output;
  if (output.pictures.empty() && !request.stays_in_memory)
    output.pictures = {std::filesystem::path(request.scene.path).stem().string() + ".exr"};
  const RenderPlan& settings = request.render.settings;
  for (const std::string& path : output.pictures) {
    require_format(path, settings.width, settings.height);
    if (picture_format(path) == PictureFormat::hdr) begin_loading_pictures(); // its writer, beside the scene
  }
  if (!request.stays_in_memory) {
    check_channels(request);
    check_write_options(output);
  }
  require_file(request.scene.path);
  const std::vector<std::string> targets = targets_of(request);
  refuse_overwriting(targets, inputs_of(request.scene, settings, output.reference));
  check_state_file(request.render.state);
  for (const std::string& target : targets) require_writable(target);
}

// The reference, read early so that a wrong one is refused early. A box-filtered one asks for the same filter.
std::optional<Picture> read_reference(RenderCommandRequest& request) {
  RenderPlan& settings = request.render.settings;
  const std::string& path = request.output.reference;
  std::optional<Picture> reference;
  if (!path.empty()) {
    reference = read_picture(path);
    if (const std::optional<Crop>& crop = settings.crop) {
      const Picture part{crop->width, crop->height, {},
                         false,       {},           {crop->left, crop->top, settings.width, settings.height}};
      reference = cut_to(*reference, part);
      if (!reference)
        throw UsageError(path, "lacks pixels of --crop, or is of another --size",
                         "give a reference of the whole picture");
    } else if (reference->width != settings.width || reference->height != settings.height)
      throw UsageError(path,
                       fmt::format("is {}x{}, the render {}x{}", reference->width, reference->height, settings.width,
                                   settings.height),
                       fmt::format("render with --size {}x{}", reference->width, reference->height));
  }
  const bool box = reference && read_attribute(path, "wavepath.filter") == kFilterNames[gpu::kFilterBox];
  if (box && !is_given(request.render, "filter")) settings.filter = gpu::kFilterBox;
  return reference;
}

} // namespace

void add_flags_of_render(CLI::App& app, RenderCommandRequest& request) {
  add_output_flags(app, request.output);
  add_scene_flags(app, request.scene, true);
  add_shutter_flag(app, request.scene);
  add_sequence_flags(app, request.sequence);
  add_motion_flags(app, request.motion);
  add_view_flags(app, request.scene.view);
  add_picture_flags(app, kByRender, request.render);
  add_stop_flags(app, request.render);
  add_transport_flags(app, kByRender, request.render);
  add_devices_flag(app, request.render);
  add_plan_flags(app, request.render);
  add_replay_flags(app, request.render);
}

std::vector<std::string> targets_of(const RenderCommandRequest& request) {
  std::vector<std::string> targets = request.output.pictures;
  for (const std::string& file : {request.output.stats, request.render.state.file})
    if (!file.empty()) targets.push_back(file);
  return targets;
}

std::optional<Picture> resolve(RenderCommandRequest& request) {
  resolve_settings(request.scene, request.render);
  if (request.render.pixel && !request.output.tev.empty())
    throw UsageError("--pixel", "renders no picture that --tev could show", "leave out one of them");
  if (request.render.pixel)
    require_file(request.scene.path);
  else
    check_files(request);
  if (!request.render.plan_file.empty()) request.render.recorded = read_plan(request.render.plan_file);
  return read_reference(request);
}

void require_writers(const OutputRequest& output) {
  for (const std::string& path : output.pictures)
    if (picture_format(path) == PictureFormat::hdr) picture_module(path);
}

} // namespace wavepath
