#pragma once

#include "engine/kinds/kinds.hpp"
#include "worldio/stage/stage_parser.hpp"
#include "worldio/stage/stage_values.hpp"

#include <optional>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace troupe::worldio {

/// An entity (a model, block, sensor or window of a `.world` file of Stage, an older robot simulator) with
/// its macros applied. A file defines a macro with `define NAME BASE (...)`, where BASE is a type or another
/// macro. A StageModel consists of layers: the bodies of the macros and the body of the entity itself. The
/// properties of a later layer override those of earlier layers, and the children of a later layer are added
/// to those of earlier layers.
struct StageModel {
  struct Child {
    const StageEntity* entity;  ///< the child, whose macros are not applied yet
    const StageEntity* layer;   ///< the layer whose body contains it
  };

  /// The type at the end of the chain of macros: the name of one of engine::Registry::models, such as
  /// "position" (a robot) or "ranger" (a distance sensor), or one of the words "block", "sensor" and
  /// "window", which are not in that list.
  std::string_view type;
  /// An older name of the type, if the file uses one: "laser" or "sonar" for a ranger, "wifi" for a radio.
  /// Else empty. A laser or sonar that contains no sensor is its own sensor.
  std::string_view alias;
  std::vector<std::string_view>
      names;  ///< the entity's word in the file, then the bases of the macros, and last the type
  std::vector<const StageEntity*> layers;  ///< the innermost base first, the entity itself last
  Where where;                             ///< place of the entity's first word

  /// Returns the effective property of this name: the last one in the last layer that has a property of this
  /// name. Null if there is none.
  const StageProperty* find(const StageDocument& document, std::string_view key) const;
  /// Returns the children of all layers: those of the innermost base first, in the order of the file.
  std::vector<Child> children(const StageDocument& document) const;
};

/// The macros defined so far in a world file and the files that it includes.
class StageMacros {
 public:
  StageMacros(const StageDocument& document, const engine::Registry& registry, StageValues& values);

  /// Adds a macro: `item` must be a `define`. If a name is defined several times, the first definition is
  /// used, and a later one is ignored with a warning. There is no warning if both definitions are the same
  /// line of a file that is included twice.
  void define(const StageItem& item);
  /// Applies the macros of an entity: follows the chain of their bases, then replaces an older name of a
  /// type, such as "laser", by the present name. Does not apply the macros of the children. If the chain of
  /// bases is a cycle or does not end at a type, or if all calls together have followed more than 20 million
  /// bases, reports an error and returns nothing.
  std::optional<StageModel> resolve(const StageEntity& entity);
  /// Whether a model of this type is a device that the registry has: a ranger, a gripper, ...
  bool is_device(std::string_view type) const;
  /// Whether a model of this type is a device in Stage, but the registry does not have such a device.
  bool is_only_a_body(std::string_view type) const;
  /// Warns of macros of the world file itself that resolve() never used, and of included files that define
  /// only unused macros. A single unused macro of an included file is no mistake, because such a file is a
  /// library.
  void report_unused();

 private:
  struct Macro {
    const StageEntity* body;
    std::string_view base;
    bool is_used = false;
  };

  const StageDocument& document_;
  const engine::Registry& registry_;
  StageValues& values_;
  std::unordered_map<std::string_view, Macro> macros_;
  std::size_t steps_ = 0;
};

}  // namespace troupe::worldio
