// Memory that this process may still take from the host.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

namespace wavepath {

// Bytes: the minimum of the kernel's available memory, the rest of the process's control group limit and the rest of
// its address-space limit. The maximum of the type if none of them is known.
std::uint64_t available_memory();

// Throws Error(where, ...) naming both numbers if `bytes` for `what` exceed `available`; `remedy` as in Error.
void require_memory(const std::string& where, const std::string& what, std::uint64_t bytes, const std::string& remedy,
                    std::uint64_t available = available_memory());

// "1.5 GiB".
std::string to_size_text(std::uint64_t bytes);

} // namespace wavepath
