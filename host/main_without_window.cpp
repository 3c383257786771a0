// wavepath, whose window is a program of its own (WAVEPATH_SEPARATE_VIEW): `wavepath view` becomes wavepath-view, which
// lies beside it or on the PATH. So an installation without the window needs none of its libraries.
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

#include <unistd.h>

#include <CLI/CLI.hpp>

#include "host/base/error.h"
#include "host/cli/commands.h"
#include "host/cli/flags.h"
#include "host/cli/program.h"

namespace wavepath {
namespace {

// Returns if there is no such program.
void become_window(char** arguments) {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::canonical("/proc/self/exe", error);
  if (!error) execv((self.parent_path() / "wavepath-view").c_str(), arguments);
  execvp("wavepath-view", arguments);
}

Command add_missing_view(CLI::App& app, const std::string&) {
  CLI::App* command = add_command(app, "view", "render a scene in a window");
  command->allow_extras(); // whatever its flags are, what is said is that it is missing
  add_flag(
      *command, "Scene", {"SCENE", "FILE", "glTF 2.0 file, .gltf or .glb"}, [](const FlagValue&) {}, true);
  return
      []() -> int { throw Error("view", "the program wavepath-view is missing", "install the package wavepath-view"); };
}

} // namespace
} // namespace wavepath

int main(int argument_count, char** arguments) {
  if (argument_count > 1 && std::string_view(arguments[1]) == "view") wavepath::become_window(arguments);
  constexpr wavepath::OwnCommand kOwn[] = {{"view", wavepath::add_missing_view}, {"serve", wavepath::add_serve}};
  return wavepath::run_program(argument_count, arguments, kOwn);
}
