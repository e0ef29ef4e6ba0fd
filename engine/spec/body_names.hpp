#pragma once

#include "base/ids.hpp"
#include "engine/spec/names.hpp"
#include "engine/spec/world_spec.hpp"

#include <mutex>
#include <string_view>

namespace troupe::engine {

/// Finds the bodies of a spec by their names.
class BodyNames {
 public:
  /// The spec must outlive the object, and its names must not change.
  explicit BodyNames(const WorldSpec& spec) : spec_(spec) {}
  /// Returns the body with this name. If several bodies have the name, returns the one with the highest id.
  /// If no body has the name, returns the body for which the name is an alias (WorldSpec::aliases). If there
  /// is no such body either, the result is not valid(). Unborn and dead bodies are found as well.
  /// Thread-safe.
  BodyId find(std::string_view name) const;

 private:
  const WorldSpec& spec_;
  mutable NameMap names_;  // built by the first find(), because most runs never call it
  mutable std::once_flag names_made_;
};

}  // namespace troupe::engine
