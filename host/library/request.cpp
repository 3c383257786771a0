#include "host/library/request.h"

#include <algorithm>
#include <variant>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "host/base/error.h"
#include "host/base/shell_quote.h"
#include "host/render/settings/flag_value.h"
#include "host/render/settings/settings_table.h"

namespace wavepath {
namespace {

using wavepath_v0::Settings;
using wavepath_v0::Value;

std::vector<std::string> names_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

[[noreturn]] void refuse_unknown(const std::string& flag, const CLI::App& app) {
  const std::vector<std::string> names = names_of(app);
  throw UsageError(flag, "no such flag of 'wavepath render'",
                   nearest_name(flag, names).empty() ? "see 'wavepath render --help-all'" : suggestion(flag, names));
}

// Flags that print, or that stand for many pictures.
void refuse_what_is_no_picture(const std::string& name) {
  const auto refuse = [&](const char* problem, const char* remedy) { throw UsageError("--" + name, problem, remedy); };
  if (name == "help" || name == "help-all") refuse("is for the command line", "read docs/library.md");
  for (const char* replay : {"pixel", "sample", "net"})
    if (name == replay) refuse("replays one path and renders no picture", "use the command line");
  for (const char* film : {"frames", "fps", "turntable", "overwrite", "seed-per-frame"})
    if (name == film) refuse("makes a sequence of files", "use the command line, or render each moment (at, eye)");
  if (name == "tev") refuse("sends the picture to another program", "show it by a callback for pictures so far");
  if (name == "save-every") refuse("writes files of the render so far", "save the pictures that a callback gets");
}

// Between the parts of a list.
char separator_of(const std::string& name) {
  if (name == "size") return 'x';
  return name == "samples" ? ':' : ',';
}

// Word of a value that is on or off, for flags that take words.
std::string switch_word(const std::string& flag, bool on) {
  const std::string name = flag.substr(2);
  const std::string_view word = on ? "on" : "off";
  for (const Setting& row : settings_table()) {
    if (row.name != name) continue;
    if (std::holds_alternative<OnOffValue>(row.value)) return std::string(word);
    const auto* kind = std::get_if<ChoiceValue>(&row.value);
    if (kind && on && !kind->bare.empty()) return std::string(kind->bare);
    if (kind && std::ranges::count(kind->names, word) > 0) return std::string(word);
  }
  throw UsageError(flag, fmt::format("takes a value, and '{}' is none", on), "see 'wavepath render --help-all'");
}

bool is_switch(const CLI::Option& option) { return option.get_expected_max() == 0; }

// The words of a command line that say the same.
void append_words(const CLI::App& app, const std::string& name, const Value& value, std::vector<std::string>& words) {
  refuse_what_is_no_picture(name);
  const std::string flag = "--" + name;
  const CLI::Option* option = app.get_option_no_throw(flag);
  if (!option) refuse_unknown(flag, app);
  if (is_switch(*option)) {
    if (value.kind == Value::Kind::list) throw UsageError(flag, "is on or off, and no list", "give true or false");
    const std::string& text = value.texts.front();
    words.push_back(fmt::format("{}={}", flag, text == "on" ? "true" : text == "off" ? "false" : text));
    return;
  }
  if (value.kind == Value::Kind::on_off) {
    words.push_back(fmt::format("{}={}", flag, switch_word(flag, value.texts.front() == "on")));
  } else if (option->get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll) {
    for (const std::string& text : value.texts) words.push_back(fmt::format("{}={}", flag, text));
  } else {
    words.push_back(fmt::format("{}={}", flag, fmt::join(value.texts, std::string(1, separator_of(name)))));
  }
}

// Parses words as the command line does.
void parse(CLI::App& app, std::vector<std::string> words) {
  words = spelled_out(std::move(words));
  std::ranges::reverse(words); // as CLI11 wants them
  try {
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    throw UsageError("settings", error.what(), "see 'wavepath render --help-all'");
  }
}

} // namespace

LibraryRequest read_request(const wavepath_v0::Scene& scene, const Settings& settings) {
  if (scene.file.empty()) throw UsageError("scene", "names no file", "give a .gltf or .glb");
  LibraryRequest request;
  RenderCommandRequest& command = request.command;
  CLI::App app;
  app.set_help_flag();
  add_flags_of_render(app, command);
  command.stays_in_memory = true;
  std::vector<std::string> words;
  Settings all = scene.settings;
  all.add(settings);
  for (const wavepath_v0::Setting& setting : all.all()) append_words(app, setting.name, setting.value, words);
  command.command_line = "wavepath render " + shell_quoted(scene.file);
  for (const std::string& word : words) command.command_line += " " + shell_quoted(word);
  words.emplace_back("SCENE"); // in place of the file, whose name may look like a flag
  parse(app, std::move(words));
  command.scene.path = scene.file;
  check_motion(command.motion, command.render.settings, command.scene.load.animation, false);
  request.reference = resolve(command);
  require_writers(command.output);
  return request;
}

WriteOptions read_write_options(const std::string& file, const Settings& settings) {
  OutputRequest output;
  CLI::App app;
  app.set_help_flag();
  add_picture_output_flags(app, output, "", false);
  std::vector<std::string> words;
  for (const wavepath_v0::Setting& setting : settings.all()) append_words(app, setting.name, setting.value, words);
  parse(app, std::move(words));
  output.pictures = {file};
  check_write_options(output);
  return output.write;
}

} // namespace wavepath
