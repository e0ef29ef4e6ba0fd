#include "engine/kinds/thrown_text.hpp"

#include <fmt/format.h>

#include <exception>

namespace troupe::engine {

std::string thrown_text() {
  try {
    throw;
  } catch (const std::exception& error) {
    return fmt::format("threw: {}", error.what());
  } catch (...) {
    return "threw an exception that is not a std::exception";
  }
}

}  // namespace troupe::engine
