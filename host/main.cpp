// wavepath: the program, with its window and its server.
#include "host/cli/commands.h"
#include "host/cli/program.h"

int main(int argument_count, char** arguments) {
  constexpr wavepath::OwnCommand kOwn[] = {{"view", wavepath::add_view}, {"serve", wavepath::add_serve}};
  return wavepath::run_program(argument_count, arguments, kOwn);
}
