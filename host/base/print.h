// Words for the user. Those on stderr may find nobody, and then cost nothing; a stdout that cannot be written is an
// error, because it carries what was asked for.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "host/base/error.h"

namespace wavepath {

// Whoever read stdout is gone.
struct ReaderGone : Error {
  using Error::Error;
};

// While it lives, the words of the calling thread are kept instead of printed. One at a time in a thread.
class KeptWords {
public:
  KeptWords();
  ~KeptWords();
  KeptWords(KeptWords&&) = delete;

  std::string out, err;
};

// Opens what the process was started without of stdin, stdout and stderr, so that no other file takes their place.
void open_standard_streams();

// On stderr. Never fails: a terminal that was closed, a broken pipe or a full disk must not cost a picture.
void write_err(std::string_view text);
template <class... Arguments>
void print_err(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  write_err(fmt::format(format, std::forward<Arguments>(arguments)...));
}

// On stdout. Throws Error, and ReaderGone for a broken pipe.
void write_out(std::string_view text);
template <class... Arguments>
void print_out(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  write_out(fmt::format(format, std::forward<Arguments>(arguments)...));
}
// Writes the rest of the buffer. Throws likewise, also if an earlier write failed.
void flush_out();

} // namespace wavepath
