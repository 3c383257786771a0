// wavepath convert: makes glTF of a scene of pbrt-v4 or Mitsuba 3, and tells what is lost.
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "host/base/error.h"
#include "host/base/output_files.h"
#include "host/base/print.h"
#include "host/cli/commands.h"
#include "host/cli/flags.h"
#include "host/convert/convert.h"

namespace wavepath {
namespace {

struct ConvertRequest {
  std::string input, output;
  bool json = false, quiet = false;
};

void print_document(const convert::Converted& result) {
  nlohmann::ordered_json lost = nlohmann::ordered_json::array();
  for (const auto& [what, count] : result.losses.counts()) lost.push_back({{"what", what}, {"count", count}});
  const nlohmann::ordered_json document = {{"format", result.format},       {"files", result.files},
                                           {"render", result.command},      {"shapes", result.shapes},
                                           {"instances", result.instances}, {"triangles", result.triangles},
                                           {"materials", result.materials}, {"images", result.images},
                                           {"lights", result.lights},       {"lost", lost}};
  print_out("{}\n", document.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

int run_convert(const ConvertRequest& request) {
  const std::vector<std::string> outputs = convert::files_of(request.output), inputs = {request.input};
  refuse_overwriting(outputs, inputs);
  const convert::Converted result = convert::convert_scene(request.input, request.output);
  for (const auto& [what, count] : result.losses.counts())
    print_err("wavepath: lost: {}{}\n", what, count > 1 ? fmt::format(" ({} times)", count) : "");
  if (!request.quiet)
    print_err("wavepath: {}: {} shapes, {} instances, {} triangles, {} lights of {}\n", request.output, result.shapes,
              result.instances, result.triangles, result.lights, result.format);
  if (request.json)
    print_document(result);
  else
    print_out("{}\n", result.command);
  return kExitDone;
}

} // namespace

Command add_convert(CLI::App& app) {
  CLI::App* command = add_command(
      app, "convert", "make glTF of a scene of pbrt-v4 or Mitsuba 3, and name what is lost",
      "Prints the command that renders the scene as its file says: size, environment, lens. An environment map becomes "
      "an EXR beside the output, OUT.env.exr, and a medium of voxels OUT.nvdb. Each thing that glTF cannot say is "
      "named on stderr, with its count. "
      "docs/convert.md");
  const auto request = std::make_shared<ConvertRequest>();
  require(add_flag(*command, "Scene", {"IN", "FILE", "scene of pbrt-v4 (.pbrt) or Mitsuba 3 (.xml)"},
                   [=](const FlagValue& value) { request->input = value.text; }));
  require(add_flag(*command, "Scene", {"OUT", "FILE", "the glTF file, .glb or .gltf"},
                   [=](const FlagValue& value) { request->output = value.text; }));
  add_switch(*command, "Output", {"--json", "", "print a JSON document with all counts on stdout", "off"},
             request->json);
  add_switch(*command, "Output", {"-q,--quiet", "", "print no summary", "off"}, request->quiet);
  return [request] { return run_convert(*request); };
}

} // namespace wavepath
