#pragma once

#include <string>
#include <string_view>

namespace troupe::live {

/// Returns a host name in lower case and without its port: `example.org` for `Example.org:8443`, and `[::1]`
/// for `[::1]:80`. Any port is accepted, because a client behind a tunnel uses the port of the tunnel. Empty
/// if the text is not a host name, for example because it is empty, has a space or a slash, or has a port
/// that is not a number.
std::string host_name(std::string_view text);

}  // namespace troupe::live
