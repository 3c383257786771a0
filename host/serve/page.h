// The page that browsers show: the files of host/serve/page as one, made when the program is built.
#pragma once

#include <string>

namespace wavepath {

extern const char* const kServedPage;
// SHA-256 of its style and its script, in hexadecimal digits.
extern const char* const kServedStyleHash;
extern const char* const kServedScriptHash;

// Its header Content-Security-Policy: nothing runs or loads but what the page itself holds.
std::string served_page_policy();

} // namespace wavepath
