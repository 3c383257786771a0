// How much memory this process may still take from the host.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

namespace wavepath {

// Bytes: the least of what the kernel calls available and what the process's control group and address-space limit
// still allow. The maximum of the type where the system does not say.
std::uint64_t available_memory();

// Throws Error(where, ...) naming both numbers if `bytes` for `what` exceed available_memory(); `remedy` as in Error.
void require_memory(const std::string& where, const std::string& what, std::uint64_t bytes, const std::string& remedy);

// "1.5 GiB".
std::string to_size_text(std::uint64_t bytes);

} // namespace wavepath
