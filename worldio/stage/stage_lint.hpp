#pragma once

#include "worldio/stage/stage_models.hpp"
#include "worldio/stage/stage_values.hpp"

#include <span>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace troupe::worldio {

/// Sees to it that nothing in a file is dropped in silence: looks each property up in the table of all
/// properties and warns of what has no effect here. Bodies of unused macros are not looked at, as
/// in Stage. Where the diagnostics are thorough, each place is told by itself, and so are properties that
/// others beside them overrule.
class StageLint {
 public:
  StageLint(const StageDocument& document, StageMacros& macros, StageValues& values)
      : document_(document), macros_(macros), values_(values) {}

  void check_world();
  /// An entity with its macros and all that it holds; the body of a macro is looked at once.
  void check(const StageEntity& entity) { check(entity, 0); }
  /// Writes the warnings that sum up.
  void finish();

 private:
  /// One kind of thing that is told in one line, or, where thorough, at each of its places.
  struct Summary {
    std::string_view all;   ///< before the names
    std::string_view each;  ///< behind a name
    Where first = {};
    std::vector<std::string> names = {};
  };

  void check(const StageEntity& entity, std::size_t depth);
  /// `type`: of the entity, or the alias that it is called by.
  void check_property(const StageProperty& property, std::string_view type);
  void check_repeated(std::span<const StageProperty> properties);
  void check_overruled(const StageModel& model);
  void add(Summary& summary, Where where, std::string name);

  const StageDocument& document_;
  StageMacros& macros_;
  StageValues& values_;
  std::unordered_set<const StageEntity*> macros_seen_;
  Summary no_effect_{"accepted without effect, docs/stage-worlds.md says why", "no effect here"};
  Summary window_only_{"accepted, but only Stage's window would use it", "for Stage's window only"};
  Summary obsolete_{"obsolete, ignored by Stage too", "obsolete, ignored by Stage too"};
};

}  // namespace troupe::worldio
