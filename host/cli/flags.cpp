// Declares flags with the parser.
#include "host/cli/flags.h"

#include <CLI/CLI.hpp>

namespace wavepath {
namespace {

CLI::Option* show(const CLI::App& app, const char* group, const Flag& flag, CLI::Option* option) {
  if (flag.advanced) leave_out_of_help(app, option);
  return option->group(group)->default_str(flag.initial);
}

} // namespace

CLI::App* add_command(CLI::App& app, const char* name, const char* meaning, const char* footer) {
  CLI::App* command = app.add_subcommand(name, meaning);
  command->set_help_flag("-h,--help", "show this help, and exit")->group(kHelpGroup);
  command->set_help_all_flag("--help-all", "show the flags for experts too, and exit")->group(kHelpGroup);
  if (footer) command->footer(footer);
  return command;
}

CLI::Option* add_flag(CLI::App& app, const char* group, const Flag& flag, std::function<void(const FlagValue&)> read,
                      bool repeatable) {
  const std::string& names = flag.names;
  const std::string shown = names.substr(names.find_last_of(',') + 1);
  const auto read_all = [shown, read](const CLI::results_t& texts) {
    for (const std::string& text : texts) read({shown, text});
    return true;
  };
  CLI::Option* option = app.add_option(names, read_all, flag.meaning);
  show(app, group, flag, option)->type_name(flag.placeholder)->expected(1);
  option->multi_option_policy(repeatable ? CLI::MultiOptionPolicy::TakeAll : CLI::MultiOptionPolicy::TakeLast);
  if (repeatable && shown.front() != '-') option->allow_extra_args();
  return option;
}

void require(CLI::Option* option) { option->required(); }

CLI::Option* add_switch(CLI::App& app, const char* group, const Flag& flag, bool& value) {
  return show(app, group, flag, app.add_flag(flag.names, value, flag.meaning));
}

void add_switch(CLI::App& app, const char* group, const Flag& flag, std::function<void(bool)> read) {
  const auto read_count = [read](std::int64_t count) { read(count > 0); }; // --name=false counts -1
  show(app, group, flag, app.add_flag_function(flag.names, read_count, flag.meaning));
}

} // namespace wavepath
