// Parses the command line and runs the command.
#include <algorithm>
#include <map>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "host/base/error.h"
#include "host/base/print.h"
#include "host/base/shell_quote.h"
#include "host/cli/commands.h"
#include "host/cli/flags.h"
#include "host/cli/render_flags.h"

namespace wavepath {
namespace {

// The command line as a shell would take it again.
std::string quote(int count, const char* const* arguments) {
  std::string line;
  for (int i = 0; i < count; ++i) line += (i == 0 ? "" : " ") + shell_quoted(arguments[i]);
  return line;
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

std::vector<std::string> flag_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

bool is_flag_of(const CLI::App& app, const std::string& name) { return std::ranges::count(flag_names(app), name) > 0; }

// Throws UsageError for unknown flags and commands, with the nearest known name.
void refuse_leftovers(const CLI::App& app, const CLI::App* chosen) {
  const CLI::App& command = chosen ? *chosen : app;
  const std::string title = chosen ? "wavepath " + command.get_name() : "wavepath", help = "see " + title + " --help";
  for (const std::string& word : app.remaining())
    if (chosen && word != "--")
      throw UsageError(word, "stands before the command", "write " + title + " first, then its flags");
  const std::vector<std::string> words = command.remaining();
  for (const std::string& word : words) {
    if (word.size() < 2 || word[0] != '-' || word == "--") continue;
    const std::string name = word.substr(0, word.find('='));
    const std::vector<std::string> flags = flag_names(command);
    if (const CLI::App* render = app.get_subcommand("render"); chosen && is_flag_of(*render, name))
      throw UsageError(name, "is a flag of 'wavepath render', not of '" + title + "'", "leave it out; " + help);
    throw UsageError(name, "no such flag of '" + title + "'",
                     nearest_name(name, flags).empty() ? help : suggestion(name, flags));
  }
  for (const std::string& word : words) {
    if (word == "--") continue;
    if (!chosen) throw UsageError(word, "no such command", suggestion(word, command_names(app)));
    throw UsageError(word, "is one argument too many for '" + title + "'", help);
  }
}

} // namespace

int run(int argument_count, const char* const* arguments, std::span<const OwnCommand> own) {
  CLI::App app("path-traced reference images of glTF scenes, in Vulkan compute", "wavepath");
  set_help_layout(app);
  app.set_help_flag("-h,--help", "show this and exit")->group(kHelpGroup);
  app.set_version_flag("--version", "wavepath " WAVEPATH_VERSION, "show the version and exit")->group(kHelpGroup);
  app.footer(
      "'wavepath COMMAND --help' shows the flags of a command that most users need, --help-all shows all flags. Exit "
      "codes: 0 success, 1 failure of the input or the machine, 2 wrong usage, 3 --target-error not reached, 130 "
      "interrupted (the result so far was saved), 141 stdout was closed (files were written). Compiled kernels are "
      "kept in $XDG_CACHE_HOME/wavepath or ~/.cache/wavepath. WAVEPATH_CACHE=FOLDER selects another folder, "
      "WAVEPATH_CACHE=off keeps none.");
  const std::string line = quote(argument_count, arguments);
  std::map<std::string, Command> commands;
  commands["render"] = add_render(app, line);
  for (const OwnCommand& command : own) commands[command.name] = command.add(app, line);
  commands["info"] = add_info(app);
  commands["compare"] = add_compare(app);
  commands["bench"] = add_bench(app);
  commands["merge"] = add_merge(app);
  commands["relight"] = add_relight(app);
  commands["parts"] = add_parts(app);
  commands["convert"] = add_convert(app);
  commands["selftest"] = add_selftest(app);
  commands["study"] = add_study(app, line);

  try {
    std::vector<std::string> words = spelled_out({arguments, arguments + argument_count});
    std::reverse(words.begin(), words.end()); // as CLI11 wants them
    words.pop_back();                         // the program
    app.parse(words);
  } catch (const CLI::CallForHelp&) {
    print_out("{}", app.help());
    return kExitDone;
  } catch (const CLI::CallForAllHelp&) {
    print_out("{}", app.help("", CLI::AppFormatMode::All));
    return kExitDone;
  } catch (const CLI::CallForVersion& version) {
    print_out("{}\n", version.what());
    return kExitDone;
  } catch (const CLI::ParseError& error) {
    refuse_leftovers(app, app.get_subcommands().empty() ? nullptr : app.get_subcommands().front());
    throw UsageError("command line", error.what(), "see wavepath --help");
  }
  if (app.get_subcommands().empty())
    throw UsageError("command line", "no command is given",
                     fmt::format("choose from {}; see wavepath --help", fmt::join(command_names(app), ", ")));
  return commands.at(app.get_subcommands().front()->get_name())();
}

void print_warnings(const Warnings& warnings) {
  for (const auto& [text, count] : warnings.counts()) {
    const std::string times = count > 1 ? fmt::format(" ({} times)", count) : "";
    print_err("wavepath: warning: {}{}\n", text, times);
  }
}

} // namespace wavepath
