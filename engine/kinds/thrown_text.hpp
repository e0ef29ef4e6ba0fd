#pragma once

#include <string>

namespace troupe::engine {

/// Returns a text about the exception that the calling catch block handles: `threw: TEXT`, where TEXT is
/// what() of a std::exception, or `threw an exception that is not a std::exception`. Outside a catch block
/// the call ends the program (std::terminate()).
std::string thrown_text();

}  // namespace troupe::engine
