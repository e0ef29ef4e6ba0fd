#include "engine/observing/measures.hpp"

#include "base/hash.hpp"
#include "engine/kinds/thrown_text.hpp"
#include "engine/spec/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <set>
#include <stdexcept>
#include <unordered_set>
#include <utility>
#include <variant>

namespace troupe::engine {
namespace {

/// Calls `call`, which runs a function of a measure, and returns its result. Replaces an exception of `call`
/// by a std::runtime_error whose text names the tick and the measure, because the exception of a plug-in does
/// not name its origin. Exceptions of another language (MeasureKind::is_foreign) propagate unchanged: they
/// name the file and the line, and programs in that language catch them. During the call, functions that
/// change the world throw (World::measuring()).
template <class Call>
auto call_measure(World& world, const MeasureKind& kind, const std::string& column, Call&& call) {
  const auto measuring = world.measuring();
  if (kind.is_foreign) return call();
  try {
    return call();
  } catch (...) {
    throw std::runtime_error(fmt::format("tick {}: measure \"{}\" {}", world.tick(), column, thrown_text()));
  }
}

/// Returns a measure that MeasureKind::make has made. Throws std::logic_error if it has returned null.
std::unique_ptr<Measure> make_measure(const MeasureKind& kind, World& world, const Record& params,
                                      const std::vector<BodyId>& robots) {
  std::unique_ptr<Measure> measure = kind.make(world.measured(), params, robots);
  if (!measure) throw std::logic_error("the function `make` of its kind returned no measure");
  return measure;
}

template <class Parts>
void see_all(World& world, const Parts& parts, const std::vector<std::string>& columns,
             std::span<const std::unique_ptr<Measure>> measures) {
  for (std::size_t i = 0; i < parts.size(); ++i)
    call_measure(world, *parts[i].kind, columns[i], [&] { measures[i]->see(world.measured()); });
}

// append() writes a value as text. Different values give different texts, because numbers are written
// exactly, and texts and lists with their lengths.
void append(std::string& text, std::monostate) { text += ' '; }
void append(std::string& text, bool x) { text += x ? "1 " : "0 "; }
void append(std::string& text, std::int64_t x) { text += fmt::format("{} ", x); }
void append(std::string& text, double x) { text += fmt::format("{} ", x); }
void append(std::string& text, const std::string& x) { text += fmt::format("{}:{} ", x.size(), x); }
void append(std::string& text, const Value& value);
template <class T>
void append(std::string& text, const std::vector<T>& list) {
  text += fmt::format("{}:", list.size());
  for (const T& x : list) append(text, x);
}
void append(std::string& text, const Value& value) {
  text += fmt::format("{}=", value.v.index());
  std::visit([&text](const auto& x) { append(text, x); }, value.v);
}

/// Returns a hash of what a measure computes: its kind, its robots and its parameters.
std::uint64_t identity_of(const MeasureSpec& spec) {
  std::string text;
  append(text, spec.kind);
  append(text, spec.of);
  append(text, spec.params);
  return hash_text(text);
}

/// What precedes the memory of each measure in the result of MeasureSet::memory().
struct MemoryHead {
  std::uint64_t identity;
  std::uint64_t bytes;
};

/// Returns the memory of the measure with this identity in a result of MeasureSet::memory(). std::nullopt if
/// there is none.
std::optional<std::span<const std::byte>> find_memory(std::span<const std::byte> all,
                                                      std::uint64_t identity) {
  MemoryHead head{};
  while (all.size() >= sizeof head) {
    std::memcpy(&head, all.data(), sizeof head);
    all = all.subspan(sizeof head);
    if (head.bytes > all.size()) break;
    if (head.identity == identity) return all.first(head.bytes);
    all = all.subspan(head.bytes);
  }
  return std::nullopt;
}

}  // namespace

/// The names of bodies, of their types and of their populations. Collected once for all unknown names of a
/// list of measures, because a search among all bodies takes long for each name.
struct KnownNames {
  explicit KnownNames(const World& world) : known(names_of_robots(world)) {
    const WorldSpec& spec = world.spec();
    for (std::size_t b = 0; b < spec.bodies.size(); ++b) {
      const BodyType& type = world.view().type(BodyId(b));
      std::unordered_set<std::string>& names = type.drive ? of_robots : of_others;
      names.insert(type.name);
      std::string name = spec.name(BodyId(b));
      const std::size_t shortest = std::max<std::size_t>(without_number(name).size(), 1);
      for (; name.size() > shortest; name.pop_back()) names.insert(name);
      names.insert(std::move(name));
    }
  }
  /// The text of an error for a name that is neither in `of_robots` nor that of a type or population without
  /// robots.
  std::string text_of_unknown(std::string_view name) const {
    if (of_others.contains(std::string(name)))
      return fmt::format("\"{}\" has no drive: robots are bodies with a drive", name);
    return unknown_name("type or population of robots", name,
                        std::vector<std::string_view>(known.begin(), known.end()));
  }

  std::vector<std::string> known;  // for errors
  // Of robots and of other bodies: names of bodies, of types and of populations ("r21", "r2", "r" for
  // "r217").
  std::unordered_set<std::string> of_robots;
  std::unordered_set<std::string> of_others;
};

std::string measure_name(const MeasureSpec& spec, std::string_view unit) {
  if (!spec.name.empty()) return fmt::format("{}{}", spec.name, unit);
  return fmt::format("{}{}{}{}", spec.kind, unit, spec.of.empty() ? "" : ":", spec.of);
}

MeasureSet::MeasureSet(World& world, const Registry& registry, std::span<const MeasureSpec> specs,
                       Diagnostics& diagnostics, std::span<const std::string> paths,
                       std::vector<std::size_t>* too_large)
    : world_(world) {
  world.require_whole();
  world.require_between_steps("making measures");
  world.gather_distributed();
  std::unique_ptr<const KnownNames> names;
  for (std::size_t i = 0; i < specs.size(); ++i) {
    const auto error = [&](const std::string& message) {
      diagnostics.error(specs[i].where,
                        i < paths.size() ? fmt::format("{}: {}", paths[i], message) : message);
    };
    try {
      if (const Result<> added = add(specs[i], registry, names); !added) error(added.error().text);
    } catch (const std::length_error& thrown) {
      if (too_large != nullptr)
        too_large->push_back(i);
      else
        error(fmt::format("{}: {}", specs[i].kind, thrown.what()));
    }
  }
  note_present();
  see_all(world_, parts_, columns_, measures_);
}

Result<> MeasureSet::add(const MeasureSpec& spec, const Registry& registry,
                         std::unique_ptr<const KnownNames>& names) {
  const auto found = registry.find_measure(spec.kind);
  if (!found) return found.error();
  const MeasureKind* kind = *found;
  if (names && !spec.of.empty() && !names->of_robots.contains(spec.of) &&
      !world_.state().names.find(spec.of).valid() && !is_name_of_no_robots(world_, spec.of))
    return Error{names->text_of_unknown(spec.of)};
  std::vector<BodyId> robots = robots_of(world_, spec.of);
  if (robots.empty() && !spec.of.empty() && !is_name_of_no_robots(world_, spec.of)) {
    if (!names) names = std::make_unique<KnownNames>(world_);
    return Error{names->text_of_unknown(spec.of)};
  }
  std::string column = measure_name(spec, unit_suffixes(kind->unit).front().suffix);
  if (column == "tick" || column == "time_s")  // the first columns of every table of measures
    return Error{
        fmt::format("a measure cannot have the column \"{}\", which contains the time in tables of "
                    "measures: give the measure another \"name\"",
                    column)};
  if (std::ranges::find(columns_, column) != columns_.end())
    return Error{
        fmt::format("two measures have the column \"{}\": give one of them another \"name\"", column)};
  std::size_t memory_bytes = 0;
  try {
    std::unique_ptr<Measure> measure = make_measure(*kind, world_, spec.params, robots);
    memory_bytes = measure->memory().size();
    measures_.push_back(std::move(measure));
  } catch (const std::length_error&) {
    throw;
  } catch (const std::logic_error& thrown) {
    return Error{fmt::format("{}: {}", spec.kind, thrown.what())};
  } catch (...) {
    if (kind->is_foreign) throw;
    return Error{fmt::format("measure \"{}\" {}", spec.kind, thrown_text())};
  }
  parts_.push_back({kind, spec.params, std::move(robots), memory_bytes, identity_of(spec)});
  columns_.push_back(std::move(column));
  return {};
}

void MeasureSet::note_present() {
  seen_ = world_.tick();
  seen_seed_ = world_.spec().seed;
}

void MeasureSet::begin() {
  for (std::size_t i = 0; i < parts_.size(); ++i)
    call_measure(world_, *parts_[i].kind, columns_[i], [&] {
      measures_[i] = make_measure(*parts_[i].kind, world_, parts_[i].params, parts_[i].robots);
    });
}

void MeasureSet::see() {
  world_.require_whole();
  world_.require_between_steps("see()");
  const bool is_same_run = world_.spec().seed == seen_seed_;
  // At tick 0 the measures begin again, even if they have seen that tick: a reset may have undone changes
  // that the program made before the first step.
  if (is_same_run && world_.tick() == seen_ && seen_ > 0) return;
  world_.gather_distributed();
  if (!is_same_run || world_.tick() != seen_ + 1) begin();
  note_present();
  see_all(world_, parts_, columns_, measures_);
}

double MeasureSet::value(std::size_t column) {
  world_.require_whole();
  world_.require_between_steps("value()");
  return call_measure(world_, *parts_[column].kind, columns_[column],
                      [&] { return measures_[column]->value(world_.measured()); });
}

std::vector<double> MeasureSet::values() {
  world_.require_whole();
  std::vector<double> values;
  for (std::size_t i = 0; i < parts_.size(); ++i) values.push_back(value(i));
  return values;
}

std::vector<std::byte> MeasureSet::memory() const {
  std::vector<std::byte> all;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const std::span<const std::byte> own =
        call_measure(world_, *parts_[i].kind, columns_[i], [&] { return measures_[i]->memory(); });
    if (own.size() != parts_[i].memory_bytes)
      throw std::runtime_error(fmt::format(
          "the memory of the measure \"{}\" has {} bytes, but had {} when the measure was made, so "
          "no checkpoint with it can be resumed: Measure::memory() must return the same number of "
          "bytes in every call",
          columns_[i], own.size(), parts_[i].memory_bytes));
    const MemoryHead head{parts_[i].identity, own.size()};
    const std::span<const std::byte> bytes = std::as_bytes(std::span(&head, 1));
    all.insert(all.end(), bytes.begin(), bytes.end());
    all.insert(all.end(), own.begin(), own.end());
  }
  return all;
}

std::vector<std::size_t> MeasureSet::remember(std::span<const std::byte> memory) {
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const auto present = [&] {
      return call_measure(world_, *parts_[i].kind, columns_[i], [&] { return measures_[i]->memory(); });
    };
    const std::span<std::byte> own = present();
    const auto saved = find_memory(memory, parts_[i].identity);
    if (!saved || saved->size() != own.size()) {
      missing.push_back(i);
      continue;
    }
    const std::vector<std::byte> before(own.begin(), own.end());
    std::ranges::copy(*saved, own.begin());
    if (std::ranges::equal(present(), *saved)) continue;
    std::ranges::copy(before, own.begin());  // it does not fit this world: see Measure::memory()
    missing.push_back(i);
  }
  return missing;
}

std::vector<BodyId> robots_of(const World& world, std::string_view of) {
  const WorldSpec& spec = world.spec();
  const auto is_robot = [&](BodyId body) { return world.view().type(body).drive.has_value(); };
  // If "r1" is a robot (of population "r"), the name does not also stand for the robots r10 to r19.
  const BodyId named = of.empty() ? BodyId() : world.state().names.find(of);
  const bool is_one = named.valid() && is_robot(named);
  std::vector<BodyId> robots;
  for (std::size_t b = 0; b < spec.bodies.size(); ++b) {
    const BodyId body(b);
    if (!is_robot(body)) continue;
    const bool is_meant = of.empty() || world.view().type(body).name == of ||
                          (is_one ? body == named : is_of_population(spec.names, spec.bodies[b].name, of));
    if (is_meant) robots.push_back(body);
  }
  return robots;
}

bool is_name_of_no_robots(const World& world, std::string_view name) {
  const std::span<const BodyType> types = world.view().types();
  return std::ranges::any_of(types, [&](const BodyType& type) { return type.drive && type.name == name; }) ||
         std::ranges::any_of(world.spec().empty_populations, [&](const EmptyPopulation& population) {
           return types[population.type.index()].drive && population.name == name;
         });
}

std::vector<std::string> names_of_robots(const World& world) {
  std::set<std::string> names;
  const WorldSpec& spec = world.spec();
  for (const EmptyPopulation& population : spec.empty_populations)
    if (world.view().types()[population.type.index()].drive) names.insert(population.name);
  for (std::size_t b = 0; b < spec.bodies.size(); ++b) {
    const BodyType& type = world.view().type(BodyId(b));
    if (!type.drive) continue;
    names.insert(type.name);
    const std::string name = spec.name(BodyId(b));
    if (const std::string_view population = without_number(name); !population.empty())
      names.emplace(population);
  }
  return {names.begin(), names.end()};
}

std::string unknown_robots(const World& world, std::string_view name) {
  return KnownNames(world).text_of_unknown(name);
}

}  // namespace troupe::engine
