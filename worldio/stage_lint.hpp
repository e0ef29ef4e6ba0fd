#pragma once

#include "worldio/stage_models.hpp"
#include "worldio/stage_values.hpp"

#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace troupe::worldio {

/// Sees to it that nothing in a file is dropped in silence: looks each property up in the table of all
/// properties and warns of what has no effect here. Bodies of macros that nobody uses are not looked at, as
/// in Stage.
class StageLint {
 public:
  StageLint(const StageDocument& document, const StageMacros& macros, StageValues& values)
      : document_(document), macros_(macros), values_(values) {}

  void check_world();
  /// An entity with its macros and all that it holds; the body of a macro is looked at once.
  void check(const StageEntity& entity) { check(entity, 0); }
  /// Writes the warnings that sum up.
  void finish();

 private:
  struct Summary {
    Where first;
    std::vector<std::string> names;
    void add(Where where, std::string name);
  };

  void check(const StageEntity& entity, std::size_t depth);
  void check_property(const StageProperty& property, std::string_view type);

  const StageDocument& document_;
  const StageMacros& macros_;
  StageValues& values_;
  std::unordered_set<const StageEntity*> macros_seen_;
  Summary no_effect_;
  Summary window_only_;
  Summary obsolete_;
};

}  // namespace troupe::worldio
