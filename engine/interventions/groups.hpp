#pragma once

#include "base/diagnostics.hpp"
#include "base/ids.hpp"
#include "engine/spec/experiment_spec.hpp"
#include "engine/state/world_state.hpp"

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace troupe::engine {

/// The groups of bodies on which the interventions and faults of a world act. Each list, and each text of an
/// error, is made once, however many interventions and faults refer to the group. The arguments of
/// the constructor must exist as long as this object.
class Groups {
 public:
  using Bodies = std::shared_ptr<const std::vector<BodyId>>;  ///< never null

  explicit Groups(const WorldState& state) : state_(state) {}
  /// Returns the bodies of a group of the world file that are not static, in order of ids, including bodies
  /// that are not in the world. The random selection of the group (GroupSpec::count, GroupSpec::share) is not
  /// made here.
  ///
  /// If there is no such body, the function returns an empty list and reports an error at `where`, a position
  /// in the world file. There is one exception: no error is reported if the group names a population, or a
  /// type of the world whose bodies would not be static, and the world has no body of it.
  Bodies find(const GroupSpec& group, Where where, Diagnostics& diagnostics);
  /// Returns the index in WorldSpec::reserves of the reserve of a population; std::nullopt if there is none.
  std::optional<std::size_t> reserve(std::string_view population);

 private:
  bool is_in(const GroupSpec& group, BodyId body) const;
  std::vector<BodyId> bodies_of(const GroupSpec& group);
  bool may_be_empty(const GroupSpec& group) const;
  bool is_static(const GroupSpec& group) const;
  const std::vector<std::string>& known_names(GroupSpec::By by);
  std::string text_of_unknown(const GroupSpec& group);

  /// Bodies that are not static, in the order of ids: by the names of their types (GroupSpec::By::type), or
  /// by the words of their names (GroupSpec::By::population).
  using Index = std::map<std::string_view, std::vector<BodyId>>;

  const WorldState& state_;
  std::map<GroupSpec::By, Index> indices_;  // built on first use, so that no group searches all bodies
  struct Found {
    Bodies bodies;
    std::string error;  // text_of_unknown() if there must be bodies and there are none; else empty
  };
  std::map<std::pair<GroupSpec::By, std::string>, Found> found_;  // by the members `by` and `name`
  std::unordered_map<std::string_view, std::size_t> reserves_;    // by population; built on first use
  std::map<GroupSpec::By, std::vector<std::string>> known_;       // built on first use
};

}  // namespace troupe::engine
