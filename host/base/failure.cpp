#include "host/base/failure.h"

#include <new>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/base/print.h"

namespace wavepath {

std::string failure_text(const std::exception& failure) {
  if (dynamic_cast<const Error*>(&failure)) return failure.what();
  if (dynamic_cast<const std::bad_alloc*>(&failure))
    return "memory: ran out; use a smaller size or scene, or close other programs";
  if (const auto* system = dynamic_cast<const std::system_error*>(&failure))
    if (system->code() == std::errc::resource_unavailable_try_again)
      return "threads: no more can be started; allow more processes or memory (ulimit -u, ulimit -v), or close other "
             "programs";
  return fmt::format("wavepath: unexpected error ({}); report this", failure.what());
}

// A closed stdout is no failure worth a line.
void Attempts::note(const std::exception& failure) {
  const bool reader_gone = dynamic_cast<const ReaderGone*>(&failure) != nullptr;
  if (!first_ || only_reader_gone_)
    first_ = std::current_exception(), only_reader_gone_ = reader_gone;
  else if (!reader_gone)
    others_ += fmt::format("wavepath: warning: {}\n", failure_text(failure));
}

void Attempts::finish() {
  write_err(others_);
  others_.clear();
  if (first_) std::rethrow_exception(std::exchange(first_, nullptr));
}

} // namespace wavepath
