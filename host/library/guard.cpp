#include "host/library/guard.h"

#include <atomic>
#include <exception>

#include <unistd.h>
#include <wavepath/error.h>

#include "host/base/error.h"
#include "host/base/failure.h"
#include "host/base/worker_threads.h"

namespace wavepath {
namespace {

std::atomic<pid_t> owner{0}; // process that used the library first; 0 = none yet

} // namespace

void enter_library() {
  pid_t none = 0;
  if (owner.compare_exchange_strong(none, getpid())) leave_workers_alone();
  if (was_forked())
    throw wavepath_v0::Error("process", "was forked from one that had used wavepath, whose threads it lacks",
                             "start it anew (in Python: multiprocessing.get_context(\"spawn\")), or fork before the "
                             "first use of wavepath");
}

bool was_forked() {
  const pid_t first = owner;
  return first != 0 && first != getpid();
}

void rethrow_translated() {
  try {
    throw;
  } catch (const wavepath_v0::Error&) {
    throw;
  } catch (const UsageError& error) {
    throw wavepath_v0::UsageError(error.where, error.problem, error.remedy);
  } catch (const Error& error) {
    throw wavepath_v0::Error(error.where, error.problem, error.remedy);
  } catch (const std::exception& error) {
    const std::string text = failure_text(error);
    const std::size_t first = text.find(": "), last = text.rfind("; ");
    if (first == std::string::npos || last == std::string::npos || last < first)
      throw wavepath_v0::Error("wavepath", text, "report this");
    throw wavepath_v0::Error(text.substr(0, first), text.substr(first + 2, last - first - 2), text.substr(last + 2));
  }
}

} // namespace wavepath
