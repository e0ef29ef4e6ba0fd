#pragma once

#include "worldio/stage/stage_models.hpp"
#include "worldio/stage/stage_values.hpp"

#include <span>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace troupe::worldio {

/// Warns of every property that has no effect, so that nothing in a file is dropped silently: looks each one
/// up in the table of all properties. As in Stage, the bodies of unused macros are not checked. Thorough
/// diagnostics report each place separately, and properties that other properties of the model override.
class StageLint {
 public:
  StageLint(const StageDocument& document, StageMacros& macros, StageValues& values)
      : document_(document), macros_(macros), values_(values) {}

  void check_world();
  /// Checks an entity, its macros and its children. The body of a macro is checked once.
  void check(const StageEntity& entity) { check(entity, 0); }
  /// Writes the summary warnings.
  void finish();

 private:
  /// A group of properties that share one warning; thorough diagnostics report each place instead.
  struct Summary {
    std::string_view all;   ///< text before the names
    std::string_view each;  ///< text after a name
    Where first = {};
    std::vector<std::string> names = {};
  };

  void check(const StageEntity& entity, std::size_t depth);
  /// `type` is that of the entity, or the alias that the file has for it.
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
