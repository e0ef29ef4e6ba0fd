#include "engine/spec/body_names.hpp"

#include <cstddef>
#include <optional>

namespace troupe::engine {

BodyId BodyNames::find(std::string_view name) const {
  const std::optional<Name> wanted = spec_.names.find(name);
  if (!wanted) return {};
  std::call_once(names_made_, [this] {
    names_.reserve(spec_.bodies.size() + spec_.aliases.size());
    for (const NamedBody& alias : spec_.aliases) names_.set(alias.name, alias.body);
    for (std::size_t b = 0; b < spec_.bodies.size(); ++b) names_.set(spec_.bodies[b].name, BodyId(b));
  });
  return names_.find(*wanted);
}

}  // namespace troupe::engine
