// wavepath: the program, with its window.
#include "host/cli/program.h"

int main(int argument_count, char** arguments) {
  return wavepath::run_program(argument_count, arguments, wavepath::add_view);
}
