// wavepath parts: prints the commands that render a picture in parts by samples, and the one that joins them. Any
// scheduler can run them; nothing is rendered here.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "host/base/error.h"
#include "host/base/print.h"
#include "host/base/shell_quote.h"
#include "host/cli/commands.h"
#include "host/cli/flags.h"
#include "host/cli/render_flags.h"
#include "host/cli/render_request.h"

namespace wavepath {
namespace {

struct PartsRequest {
  RenderCommandRequest whole;
  std::uint32_t count = 0;
};

// Flags that the lines set by themselves, or that go into the line of `merge`.
std::set<std::string> flags_of_files() {
  CLI::App app;
  OutputRequest output;
  add_picture_output_flags(app, output, "", false);
  std::set<std::string> names{"samples", "stats", "json", "count"};
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.insert(name);
  return names;
}

// Refuses flags that have no meaning for a part.
void refuse_what_no_part_has(const CLI::App& command) {
  const std::pair<const char*, const char*> refused[] = {
      {"checkpoint", "leave it out: each part has a state file of its own, and goes on from it"},
      {"resume", "leave it out: each part has a state file of its own, and goes on from it"},
      {"frames", "split the frames instead: --frames A:B in each command"},
      {"turntable", "split the frames instead: --frames A:B in each command"},
      {"pixel", "use 'wavepath render'"},
      {"tev", "show the merged picture"},
      {"save-every", "leave it out: the state file of a part holds what it has"},
      {"reference", "compare the merged picture with it ('wavepath compare')"},
  };
  for (const auto& [name, remedy] : refused)
    if (const CLI::Option* option = command.get_option_no_throw(fmt::format("--{}", name)); option && option->count())
      throw UsageError(fmt::format("--{}", name), "is no flag of a part", remedy);
}

// The words of the given flags for which `takes(name)` holds, as a shell takes them.
template <class Takes>
std::string words_of(const CLI::App& command, const Takes& takes) {
  std::string words;
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0 || option->get_lnames().empty()) continue;
    const std::string& name = option->get_lnames().back();
    if (!takes(name)) continue;
    const std::vector<std::string>& texts = option->results();
    const bool takes_all = option->get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll;
    for (std::size_t i = takes_all ? 0 : texts.size() - 1; i < texts.size(); ++i) {
      if (option->get_expected_max() == 0)
        words += texts[i] == "false" ? fmt::format(" --{}=false", name) : fmt::format(" --{}", name);
      else
        words += fmt::format(" --{}={}", name, shell_quoted(texts[i]));
    }
  }
  return words;
}

struct Lines {
  std::vector<std::string> parts;
  std::string merge;
};

Lines lines_of(const CLI::App& command, const PartsRequest& request) {
  const RenderCommandRequest& whole = request.whole;
  const RenderPlan& settings = whole.render.settings;
  const std::uint32_t first = settings.first_sample, samples = settings.last_sample - first;
  const std::vector<std::string>& pictures = whole.output.pictures;
  const std::filesystem::path picture = pictures.front();
  const std::string stem = (picture.parent_path() / picture.stem()).string();
  const std::set<std::string> of_files = flags_of_files();
  const std::string settings_words =
      words_of(command, [&](const std::string& name) { return of_files.count(name) == 0; });
  Lines lines;
  lines.merge = "wavepath merge";
  for (std::uint32_t i = 0; i < request.count; ++i) {
    const auto from = [&](std::uint64_t part) {
      return first + static_cast<std::uint32_t>(samples * part / request.count);
    };
    const std::string part = fmt::format("{}-part-{:05}", stem, i);
    const auto file = [&](const char* ending) { return shell_quoted(part + ending); };
    std::string line =
        fmt::format("wavepath render {}{} --samples {}:{} -o {} --checkpoint {} --resume",
                    shell_quoted(whole.scene.path), settings_words, from(i), from(i + 1), file(".exr"), file(".state"));
    if (!whole.output.stats.empty()) line += fmt::format(" --stats {}", file(".json"));
    lines.parts.push_back(std::move(line));
    lines.merge += " " + file(".exr");
  }
  for (const std::string& path : pictures) lines.merge += " -o " + shell_quoted(path);
  lines.merge += words_of(command, [&](const std::string& name) {
    return of_files.count(name) > 0 && name != "samples" && name != "stats" && name != "json" && name != "count" &&
           name != "output";
  });
  return lines;
}

int run_parts(const CLI::App& command, PartsRequest& request) {
  RenderCommandRequest& whole = request.whole;
  refuse_what_no_part_has(command);
  RenderPlan& settings = whole.render.settings;
  if (!is_given(whole.render, "spp"))
    throw UsageError("--spp", "is missing", "say how many samples the whole picture has: --spp 1024");
  if (!is_given(whole.render, "samples")) {
    whole.render.given.emplace_back("samples");
    settings.first_sample = 0, settings.last_sample = settings.sample_total;
  }
  RenderCommandRequest checked = whole; // as each part is where it is rendered
  resolve(checked);
  const std::uint32_t samples = settings.last_sample - settings.first_sample;
  if (request.count > samples)
    throw UsageError("--count", fmt::format("asks for {} parts of {} samples", request.count, samples),
                     fmt::format("give at most {}", samples));
  whole.output.pictures = checked.output.pictures;
  const Lines lines = lines_of(command, request);
  if (whole.output.json) {
    print_out("{}\n", nlohmann::ordered_json{{"parts", lines.parts}, {"merge", lines.merge}}.dump(2));
    return kExitDone;
  }
  for (const std::string& line : lines.parts) print_out("{}\n", line);
  print_out("{}\n", lines.merge);
  return kExitDone;
}

} // namespace

Command add_parts(CLI::App& app) {
  CLI::App* command = add_command(
      app, "parts", "print the commands that render a picture in parts, and the one that joins them",
      "Lines 1 to N render samples of the picture each, on any machine of one kind that sees the same files. A line "
      "that is run again goes on where it ended. The last line joins them to the bits of one render with --mergeable. "
      "docs/farm.md");
  const auto request = std::make_shared<PartsRequest>();
  require(add_flag(*command, "Parts", {"--count", "N", "number of parts"},
                   [=](const FlagValue& value) { request->count = value.whole_number(1, 100000); }));
  add_flags_of_render(*command, request->whole);
  return [command, request] { return run_parts(*command, *request); };
}

} // namespace wavepath
