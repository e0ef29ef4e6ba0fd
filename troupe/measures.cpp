#include "troupe/measures.hpp"

#include "base/diagnostics.hpp"
#include "engine/observing/measures.hpp"
#include "troupe/simulation.hpp"
#include "worldio/json/measures_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace troupe {
namespace {

/// Whether to take the measures of the world file.
bool are_of_world(const Simulation& simulation, const std::vector<std::string>& wanted) {
  return wanted.empty() && !simulation.world().spec().measures.empty();
}

/// Returns the measure that the world file lists under this name; null if there is none.
const engine::MeasureSpec* listed(const Simulation& simulation, const std::string& name) {
  const std::vector<engine::MeasureSpec>& specs = simulation.world().spec().measures;
  const auto found =
      std::ranges::find(specs, name, [](const auto& spec) { return engine::measure_name(spec); });
  return found == specs.end() ? nullptr : &*found;
}

/// Returns the error about an unknown measure if its name resembles that of a measure which the world file
/// lists; otherwise an empty text.
std::string misspelled(const Simulation& simulation, const std::string& name) {
  if (name.starts_with('{')) return {};  // not a name
  std::vector<std::string> names;
  for (const engine::MeasureSpec& spec : simulation.world().spec().measures)
    if (!spec.name.empty()) names.push_back(spec.name);
  return worldio::misspelled_measure(name, {names.begin(), names.end()}, simulation.registry());
}

std::vector<engine::MeasureSpec> specs_of(const Simulation& simulation,
                                          const std::vector<std::string>& wanted, Diagnostics& diagnostics) {
  if (are_of_world(simulation, wanted)) return simulation.world().spec().measures;
  std::vector<engine::MeasureSpec> specs;
  if (wanted.empty())
    for (const engine::MeasureKind& kind : simulation.registry().measures)
      if (kind.is_usual())
        specs.push_back({.kind = std::string(kind.name), .params = kind.params.defaults()});
  for (const std::string& text : wanted) {
    const std::string source = "measure " + text;
    if (const engine::MeasureSpec* of_world = listed(simulation, text))
      specs.push_back(*of_world);
    else if (std::string error = misspelled(simulation, text); !error.empty())
      diagnostics.error({diagnostics.files()->add(source), 0}, std::move(error));
    else if (auto spec = worldio::parse_measure(text, source, simulation.registry(), diagnostics))
      specs.push_back(std::move(*spec));
  }
  return specs;
}

}  // namespace

struct Measures::Impl {
  engine::MeasureSet set;
  std::vector<std::string> names;  // names of the columns without their units
};

Measures::Measures(Simulation& simulation, const std::vector<std::string>& wanted) {
  Diagnostics diagnostics(simulation.world().spec().files);
  const std::vector<engine::MeasureSpec> specs = specs_of(simulation, wanted, diagnostics);
  diagnostics.throw_if_errors();
  std::vector<std::string> paths;
  for (std::size_t i = 0; are_of_world(simulation, wanted) && i < specs.size(); ++i)
    paths.push_back(fmt::format("/measures/{}", i));
  const bool are_usual = wanted.empty() && !are_of_world(simulation, wanted);
  // Measures that the user has not chosen, and that this world cannot have.
  std::vector<std::size_t> too_large;
  impl_ =
      std::make_unique<Impl>(Impl{engine::MeasureSet(simulation.world(), simulation.registry(), specs,
                                                     diagnostics, paths, are_usual ? &too_large : nullptr),
                                  {}});
  diagnostics.throw_if_errors();
  for (std::size_t i = 0; i < specs.size(); ++i) {
    if (std::ranges::find(too_large, i) != too_large.end()) continue;
    impl_->names.push_back(engine::measure_name(specs[i]));
  }
}

Measures::~Measures() = default;
Measures::Measures(Measures&&) noexcept = default;
Measures& Measures::operator=(Measures&&) noexcept = default;

void Measures::see() { impl_->set.see(); }

std::span<const std::string> Measures::columns() const { return impl_->set.columns(); }

std::vector<double> Measures::values() { return impl_->set.values(); }

std::optional<std::size_t> Measures::find(std::string_view name) const {
  for (std::size_t i = 0; i < impl_->names.size(); ++i)
    if (name == impl_->names[i] || name == columns()[i]) return i;
  return {};
}

double Measures::value(std::string_view name) {
  if (const std::optional<std::size_t> i = find(name)) return impl_->set.value(*i);
  const std::vector<std::string_view> known(columns().begin(), columns().end());
  throw std::out_of_range(unknown_name("measure", name, known));
}

std::vector<std::byte> Measures::memory() const { return impl_->set.memory(); }

std::vector<std::size_t> Measures::remember(std::span<const std::byte> memory) {
  return impl_->set.remember(memory);
}

bool Measures::has_memory(std::size_t column) const {
  if (column >= columns().size())
    throw std::out_of_range(fmt::format("there is no column {}: the measures have {} columns, counted from 0",
                                        column, columns().size()));
  return impl_->set.has_memory(column);
}

}  // namespace troupe
