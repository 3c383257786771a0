// wavepath relight: mixes the groups of lights of a picture anew.
#include <algorithm>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "host/base/atomic_file.h"
#include "host/base/error.h"
#include "host/base/output_files.h"
#include "host/base/print.h"
#include "host/cli/commands.h"
#include "host/cli/flags.h"
#include "host/cli/render_flags.h"
#include "host/cli/report.h"
#include "host/film/group_layers.h"
#include "host/passes/passes.h"
#include "host/picture/files/picture_io.h"
#include "host/picture/files/relight.h"

namespace wavepath {
namespace {

struct RelightCommandRequest {
  std::string picture;
  std::vector<GroupGain> gains;
  OutputRequest output;
};

constexpr double kMostGain = 1e6; // products with light stay far from the largest float

// The name of a group may hold "=", a gain does not.
void read_gain(const FlagValue& value, std::vector<GroupGain>& gains) {
  const std::size_t middle = value.text.rfind('=');
  if (middle == std::string::npos || middle == 0)
    value.refuse("has the wrong form", "write it as NAME=X or NAME=R,G,B, such as Key=0.5");
  const FlagValue factor{value.flag, value.text.substr(middle + 1)};
  GroupGain gain{value.text.substr(0, middle), {}};
  gain.factor =
      factor.text.find(',') == std::string::npos ? glm::dvec3(factor.number(0.0, kMostGain)) : factor.triple();
  for (int c = 0; c < 3; ++c)
    if (!(gain.factor[c] >= 0.0 && gain.factor[c] <= kMostGain))
      factor.refuse("is no gain", fmt::format("give numbers from 0 to {:.0f}", kMostGain));
  if (std::ranges::count(gains, gain.group, &GroupGain::group) > 0)
    value.refuse(fmt::format("names '{}' twice", gain.group), "give every group one gain");
  gains.push_back(std::move(gain));
}

void check_relit_outputs(const RelightCommandRequest& request) {
  const std::vector<std::string>& pictures = request.output.pictures;
  if (pictures.empty()) throw UsageError("-o", "is missing", "say where the result goes: -o OUT.exr");
  for (const std::string& path : pictures) require_format(path, 1, 1);
  check_write_options(request.output);
  refuse_overwriting(pictures, std::vector{request.picture});
  for (const std::string& path : pictures) require_writable(path);
}

// The header of the picture, apart from what the mix changes.
PictureInfo info_of(const std::string& path) {
  PictureInfo info;
  info.spp = static_cast<std::uint32_t>(read_number(path, "wavepath.spp").value_or(0.0));
  info.seconds = read_number(path, "wavepath.seconds").value_or(0.0);
  info.seed = static_cast<std::uint32_t>(read_number(path, "wavepath.seed").value_or(0.0));
  info.samples = read_attribute(path, "wavepath.samples");
  info.scene = read_attribute(path, "wavepath.scene");
  info.command = read_attribute(path, "wavepath.command");
  info.filter = read_attribute(path, "wavepath.filter");
  info.bias = read_attribute(path, "wavepath.bias");
  info.world_to_camera = read_matrix(path, "worldToCamera");
  info.world_to_ndc = read_matrix(path, "worldToNDC");
  info.focus = read_number(path, "focus");
  info.frame = read_frame(path);
  info.exposure_seconds = read_number(path, "expTime");
  return info;
}

int run_relight(RelightCommandRequest& request) {
  check_relit_outputs(request);
  Picture picture = read_picture(request.picture);
  for (const std::string& path : request.output.pictures) require_format(path, picture.width, picture.height);
  const std::string groups = read_attribute(request.picture, kGroupsText);
  const std::vector<std::string> names = group_names_of(groups);
  const std::vector<std::string> left_out = relight(request.picture, names, request.gains, picture);
  picture.texts.emplace_back(kGroupsText, groups);
  for (const std::string& name : pass_texts())
    if (const std::string text = read_attribute(request.picture, name); !text.empty())
      picture.texts.emplace_back(name, text);
  std::string gains; // of this mix, upon those that the picture may have already
  if (const std::string before = read_attribute(request.picture, kGainsText); !before.empty()) gains = before + "; ";
  for (const GroupGain& gain : request.gains)
    gains += fmt::format("{}{}={},{},{}", &gain == &request.gains.front() ? "" : " ", gain.group, gain.factor.r,
                         gain.factor.g, gain.factor.b);
  picture.texts.emplace_back(kGainsText, gains);

  Warnings warnings;
  if (!left_out.empty())
    warnings.add(fmt::format("{} left out, which hold light of all groups together", fmt::join(left_out, ", ")));
  Attempts attempts;
  write_pictures(request.output, info_of(request.picture), picture, warnings, attempts);
  print_warnings(warnings);
  if (!request.output.quiet)
    print_err("wavepath: {}: {} groups of lights, {}\n", written_text(request.output, picture), names.size(), gains);
  attempts.finish();
  return kExitDone;
}

} // namespace

Command add_relight(CLI::App& app) {
  CLI::App* command = add_command(
      app, "relight", "mix the groups of lights of a picture anew",
      "The picture is an .exr of 'wavepath render --light-groups'. Its groups keep their layers, scaled by their "
      "gains, "
      "and its R, G, B become their sum. So lights are dimmed, tinted and switched off without another render.");
  const auto request = std::make_shared<RelightCommandRequest>();
  require(add_flag(*command, "Pictures", {"IN", "FILE.exr", "picture with groups of lights"},
                   [=](const FlagValue& value) { request->picture = value.text; }));
  add_flag(
      *command, "Pictures",
      {"--gain", "NAME=X|NAME=R,G,B", "factor of the light of a group; repeatable. 0: the lights are off",
       "1 for all groups"},
      [=](const FlagValue& value) { read_gain(value, request->gains); }, true);
  add_picture_output_flags(*command, request->output, "none: name at least one", false);
  add_switch(*command, "Output", {"-q,--quiet", "", "print no summary", "off"}, request->output.quiet);
  return [request] { return run_relight(*request); };
}

} // namespace wavepath
