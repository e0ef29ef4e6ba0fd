#pragma once

#include "worldio/stage/stage_models.hpp"
#include "worldio/stage/stage_values.hpp"

#include <span>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace troupe::worldio {

/// Warns of properties and models in a `.world` file of Stage (an older robot simulator) that Troupe ignores.
/// An entity is a model, block, sensor or window in such a file. The warnings are about
/// - properties that Troupe does not know, because they are not in stage_rows(),
/// - properties that never have an effect, and
/// - models that are devices in Stage but only bodies in Troupe.
///
/// With thorough diagnostics (Diagnostics::thorough(), used by `troupe lint`), each place has a warning of
/// its own. There are then also warnings about
/// - properties that the same entity sets again later,
/// - properties that another property of the same entity overrides, and
/// - properties that have no effect because of the type of the entity.
///
/// Macros that no model uses are not checked, as in Stage.
class StageLint {
 public:
  StageLint(const StageDocument& document, StageMacros& macros, StageValues& values)
      : document_(document), macros_(macros), values_(values) {}

  /// Checks the properties at the top level of the file.
  void check_world();
  /// Checks an entity, the macros that it uses, and its children. Each macro is checked only once.
  void check(const StageEntity& entity) { check(entity, 0); }
  /// Reports one warning for each group of properties (Summary) that occurs in the file. Must be called last.
  /// With thorough diagnostics, it reports nothing, because the other functions have reported each property
  /// already.
  void finish();

 private:
  /// A group of properties without effect that one warning lists together. With thorough diagnostics, there
  /// is one warning for each property instead.
  struct Summary {
    std::string_view all;                 ///< text of the common warning; the names of the properties follow
    std::string_view each;                ///< text of the warning about one property; follows its name
    Where first = {};                     ///< place of the common warning: that of the first property
    std::vector<std::string> names = {};  ///< names of the properties, each once
  };

  void check(const StageEntity& entity, std::size_t depth);
  /// Warns of a property that is unknown or never has an effect. `type` is the type of the entity that has
  /// the property, or the older name of this type if the file uses it ("laser").
  void check_property(const StageProperty& property, std::string_view type);
  void check_old(std::span<const StageProperty> properties, std::string_view type);
  std::string sensor_of(std::span<const StageProperty> properties) const;
  void check_repeated(std::span<const StageProperty> properties);
  void check_overruled(const StageModel& model, bool is_top_level);
  void add(Summary& summary, Where where, std::string name);

  const StageDocument& document_;
  StageMacros& macros_;
  StageValues& values_;
  std::unordered_set<const StageEntity*> macros_seen_;
  Summary no_effect_{"properties without effect (docs/stage-worlds.md says why)",
                     "this property has no effect in Troupe"};
  Summary window_only_{"properties without effect on the run, because only Stage's window uses them",
                       "this property affects only Stage's window"};
  Summary obsolete_{"obsolete properties, ignored as in Stage: remove them",
                    "this property is obsolete, ignored as in Stage: remove it"};
};

}  // namespace troupe::worldio
