#pragma once

#include "engine/kinds.hpp"
#include "worldio/stage/stage_parser.hpp"
#include "worldio/stage/stage_values.hpp"

#include <optional>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace troupe::worldio {

/// An entity with its macros applied. What stands in a later layer overrides the properties of the earlier
/// ones and adds to their children.
struct StageModel {
  struct Child {
    const StageEntity* entity;
    const StageEntity* layer;  ///< whose body it stands in
  };

  std::string_view type;  ///< a model type, "block", "sensor" or "window"
  /// Of a ranger, "laser" or "sonar" where it is called so: then it is a sensor itself unless it holds any.
  std::string_view alias;
  std::vector<std::string_view> names;     ///< as written, then the bases of the macros, the type last
  std::vector<const StageEntity*> layers;  ///< the innermost base first, the entity itself last
  Where where;

  /// The last property of this name; null when there is none.
  const StageProperty* find(const StageDocument& document, std::string_view key) const;
  std::vector<Child> children(const StageDocument& document) const;
};

/// The macros of a file, as far as it has been read.
class StageMacros {
 public:
  StageMacros(const StageDocument& document, const engine::Registry& registry, StageValues& values);

  /// The first definition of a name holds; another is a warning.
  void define(const StageItem& item);
  /// Follows the chain of bases, and then the aliases of older files; empty, with an error, where it ends at
  /// no type or in a circle.
  std::optional<StageModel> resolve(const StageEntity& entity);
  /// Whether models of this type are a device: a ranger, a gripper, ...
  bool is_device(std::string_view type) const;
  /// Whether models of this type should be one, but the registry does not have it.
  bool is_only_a_body(std::string_view type) const;
  /// Warns of macros of the world's own file that resolve() never came by, and of files with no macro that it
  /// did: a file that is included is there to be chosen from.
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
