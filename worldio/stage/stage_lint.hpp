#pragma once

#include "worldio/stage/stage_models.hpp"
#include "worldio/stage/stage_values.hpp"

#include <span>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace troupe::worldio {

/// Warns of every property of a `.world` file of Stage (an older robot simulator) that Troupe does not know,
/// or that never has an effect, so that nothing is dropped silently. It looks each property up in the table
/// of all properties (stage_rows()). It also warns of models that are devices in Stage but only bodies in
/// Troupe. As in Stage, macros that no model uses are not checked. With thorough diagnostics
/// (Diagnostics::thorough(), used by `troupe lint`), each place is reported separately. In this mode,
/// StageLint also warns of every property that the same entity sets again, that another property of the model
/// overrides, or that has no effect because of the type of the model.
class StageLint {
 public:
  StageLint(const StageDocument& document, StageMacros& macros, StageValues& values)
      : document_(document), macros_(macros), values_(values) {}

  /// Checks the properties at the top level of the file.
  void check_world();
  /// Checks an entity (a model, block, sensor or window), its macros and its children. The body of a macro is
  /// checked only at its first use.
  void check(const StageEntity& entity) { check(entity, 0); }
  /// Reports one warning for each group of properties (Summary) that occur in the file. With thorough
  /// diagnostics it reports nothing, because the other functions have reported each property already. Must be
  /// called last.
  void finish();

 private:
  /// A group of properties that are reported together in one warning, or with thorough diagnostics one by
  /// one.
  struct Summary {
    std::string_view all;                 ///< text of the common warning, before the names of the properties
    std::string_view each;                ///< text of the warning about one property, after its name
    Where first = {};                     ///< place of the common warning: that of the first property
    std::vector<std::string> names = {};  ///< names of the properties, each once
  };

  void check(const StageEntity& entity, std::size_t depth);
  /// `type`: the type of the entity that has the property, or the alias that the file uses for it ("laser").
  void check_property(const StageProperty& property, std::string_view type);
  void check_repeated(std::span<const StageProperty> properties);
  void check_overruled(const StageModel& model);
  void add(Summary& summary, Where where, std::string name);

  const StageDocument& document_;
  StageMacros& macros_;
  StageValues& values_;
  std::unordered_set<const StageEntity*> macros_seen_;
  Summary no_effect_{"properties without effect (docs/stage-worlds.md says why)",
                     "this property has no effect in Troupe"};
  Summary window_only_{"properties without effect on the run, because only Stage's window uses them",
                       "this property affects only Stage's window"};
  Summary obsolete_{"obsolete properties, ignored as in Stage",
                    "this property is obsolete, ignored as in Stage"};
};

}  // namespace troupe::worldio
