// Who may look: the token of a server, and the hosts and pages that it answers.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace wavepath {

// 256 bits of the system's, as 64 hexadecimal digits. Throws Error.
std::string make_token();

// Takes the same time wherever they differ.
bool same_secret(std::string_view given, std::string_view secret);

// The name in a header `Host`, without its port: lower case, an IPv6 address in brackets. Empty if it is none.
std::string host_name(std::string_view host);
// True for a name of this machine alone.
bool is_loopback(std::string_view name);

// Whether requests to this header `Host` are answered: names of this machine and `others`, whatever the port, which a
// tunnel changes. Another name may be that of a foreign page whose author has let it point here (DNS rebinding).
bool is_allowed_host(std::string_view host, std::span<const std::string> others);
// The same for a header `Origin`: pages of the same hosts.
bool is_allowed_origin(std::string_view origin, std::span<const std::string> others);

} // namespace wavepath
