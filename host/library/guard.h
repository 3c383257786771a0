// The door of the library: what is thrown inside becomes what the interface throws, and a forked process is refused.
#pragma once

#include <functional>
#include <memory>
#include <string>

namespace wavepath {

// Throws the interface's Error if this process was forked from one that had used a device: drivers and pools have
// threads, which fork() does not copy, and work that waits for them never ends. Also tells the host to leave the
// driver's threads alone.
void enter_library();

// True in a process that was forked as above: what has threads must not be released there.
bool was_forked();

// Throws the exception that is handled now as an Error of the interface.
[[noreturn]] void rethrow_translated();

template <class Function>
auto guarded(const Function& function) -> decltype(function()) {
  try {
    enter_library();
    return function();
  } catch (...) {
    rethrow_translated();
  }
}

// As std::make_shared(), but leaves the object alone in a forked process.
template <class T, class... Arguments>
std::shared_ptr<T> make_kept_over_fork(Arguments&&... arguments) {
  return std::shared_ptr<T>(new T(std::forward<Arguments>(arguments)...), [](T* object) {
    if (!was_forked()) delete object;
  });
}

} // namespace wavepath
