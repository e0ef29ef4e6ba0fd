#pragma once

#include "engine/kinds/registry.hpp"
#include "worldio/stage/stage_parser.hpp"
#include "worldio/stage/stage_values.hpp"

#include <optional>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace troupe::worldio {

/// An entity with its macros applied. An entity is a model, block, sensor or window in a `.world` file of
/// Stage, an older robot simulator. A file defines a macro with `define NAME BASE (...)`, where BASE is a
/// type or another macro.
///
/// A StageModel consists of layers: the bodies of the macros, and last the body of the entity itself. The
/// body is the part in parentheses. A property of a later layer overrides the property of this name in
/// earlier layers. The StageModel has the children of all layers.
struct StageModel {
  struct Child {
    const StageEntity* entity;  ///< the child, whose macros are not applied yet
    const StageEntity* layer;   ///< the layer whose body contains it
  };

  /// The type at the end of the chain of macros. It is "block", "sensor", "window", or the name of one of
  /// engine::Registry::models, such as "position" (a robot) or "ranger" (a distance sensor).
  std::string_view type;
  /// The older name of the type, if the file uses one: "laser" or "sonar" for a ranger, "wifi" for a radio.
  /// Otherwise empty. A laser or sonar without `sensor` children is its own sensor.
  std::string_view alias;
  /// The word before the entity's parentheses, then the base of each macro; the last is the type.
  std::vector<std::string_view> names;
  std::vector<const StageEntity*> layers;  ///< first the macro that is based on a type, last the entity
  Where where;                             ///< place of the entity's first word

  /// Returns the effective property of this name. If several layers have the property, the last of these
  /// layers counts. If this layer has the property several times, the last time counts. Returns null if no
  /// layer has it.
  const StageProperty* find(const StageDocument& document, std::string_view key) const;
  /// Returns the children of all layers, in the order of `layers`. The children of one layer are in the order
  /// of the file.
  std::vector<Child> children(const StageDocument& document) const;
};

/// The macros that are defined so far in a world file and in the files that it includes.
class StageMacros {
 public:
  StageMacros(const StageDocument& document, const engine::Registry& registry, StageValues& values);

  /// Adds a macro. `item` must be a `define`. If a name is defined several times, the first definition is
  /// used. Each later definition is ignored with a warning. There is no warning if both definitions are the
  /// same line of a file that is included twice.
  void define(const StageItem& item);
  /// Applies the macros of an entity, but not those of its children. Replaces an older name of a type, such
  /// as "laser", by the present name. Reports an error and returns std::nullopt if
  /// - a macro is based on itself, directly or through other macros,
  /// - the last macro is not based on a known type (the error is at the base of this macro), or
  /// - all calls together have followed more than 20 million steps from a macro to its base.
  std::optional<StageModel> resolve(const StageEntity& entity);
  /// Whether models of this type are devices that the registry has: rangers, grippers, ...
  bool is_device(std::string_view type) const;
  /// Whether models of this type are devices in Stage, but the registry does not have such devices.
  bool is_only_a_body(std::string_view type) const;
  /// Warns of each macro of the world file itself that resolve() never used. Also warns of each included file
  /// of which nothing is used. A single unused macro of an included file is allowed, because such a file can
  /// be a library for several worlds.
  void report_unused();

 private:
  struct Macro {
    const StageEntity* body;
    StageToken base;
    bool is_used = false;
  };

  void report_unknown_type(std::string_view type, Where where);

  const StageDocument& document_;
  const engine::Registry& registry_;
  StageValues& values_;
  std::unordered_map<std::string_view, Macro> macros_;
  std::unordered_set<const char*> reported_;  // the unknown types of which resolve() has reported an error
  std::size_t steps_ = 0;
};

}  // namespace troupe::worldio
