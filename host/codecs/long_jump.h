// Calls into C libraries that report errors by not returning: longjmp, fenced in so that no destructor is skipped.
#pragma once

#include <csetjmp>
#include <cstdio>
#include <string>
#include <type_traits>

#include "host/codecs/image.h"

namespace wavepath {

struct LongJump {
  std::jmp_buf buffer;
  char words[200] = ""; // error text of the library

  [[noreturn]] void leave(const char* problem) {
    if (problem != words) std::snprintf(words, sizeof words, "%s", problem);
    std::longjmp(buffer, 1);
  }
};

// Calls step(). Returns true if it returned, false if it left by jump.leave(). In that case objects alive inside are
// not destroyed, so it may hold references and numbers and call C functions only.
template <class Step>
bool completes(LongJump& jump, const Step& step) {
  static_assert(std::is_trivially_destructible_v<Step>);
  if (setjmp(jump.buffer) != 0) return false;
  step();
  return true;
}

// The same, where leaving means that the file is at fault.
template <class Step>
void decode_step(LongJump& jump, const Step& step) {
  if (!completes(jump, step)) throw ImageError("is damaged or cut short (" + std::string(jump.words) + ")");
}

} // namespace wavepath
