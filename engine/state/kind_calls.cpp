#include "engine/state/kind_calls.hpp"

#include "engine/kinds/step_error.hpp"
#include "engine/kinds/thrown_text.hpp"

#include <fmt/format.h>

#include <exception>
#include <stdexcept>

namespace troupe::engine {
namespace {

[[noreturn]] void throw_named(const CommittedView& world, std::span<const Row> rows,
                              const std::string& what) {
  const auto error = [&](Row row, std::size_t others) {
    const std::string robot =
        row.valid() ? fmt::format(" of \"{}\"", world.spec().name(world.body(row))) : std::string();
    const std::string batch =
        others > 0 ? fmt::format(", the first of a batch of {} robots,", others + 1) : "";
    return StepError(fmt::format("tick {}: {}{}{} {}", world.tick(), what, robot, batch, thrown_text()));
  };
  try {
    throw;
  } catch (const StepError&) {
    throw;
  } catch (const DecisionError& decision) {
    try {
      std::rethrow_exception(decision.thrown);
    } catch (...) {
      std::throw_with_nested(error(decision.row, 0));
    }
  } catch (...) {
    std::throw_with_nested(error(rows.empty() ? Row() : rows.front(), rows.empty() ? 0 : rows.size() - 1));
  }
}

}  // namespace

void throw_step_error(const CommittedView& world, std::span<const Row> rows,
                      const BodyType::Controller& what) {
  throw_named(world, rows, fmt::format("controller \"{}\"", what.kind->name));
}

void throw_step_error(const CommittedView& world, std::span<const Row> rows, const BodyType::Device& what) {
  throw_named(world, rows, fmt::format("device \"{}\" ({})", what.name, what.kind->name));
}

void throw_step_error(const CommittedView& world, std::span<const Row> rows, const BodyType::Drive& what) {
  throw_named(world, rows, fmt::format("drive \"{}\"", what.kind->name));
}

void throw_hook_error(const CommittedView& world, Row row, const BodyType::Device& what) {
  std::throw_with_nested(
      std::runtime_error(fmt::format("tick {}: device \"{}\" ({}) of \"{}\" {}", world.tick(), what.name,
                                     what.kind->name, world.spec().name(world.body(row)), thrown_text())));
}

Energy energy_of(const CommittedView& world, Row row, const BodyType::Device& device) {
  return call_hook(world, row, device,
                   [&] { return device.kind->energy(world.percepts(device), world.slot(row)); });
}

}  // namespace troupe::engine
