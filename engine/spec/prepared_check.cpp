#include "engine/spec/prepared_check.hpp"

#include "base/sort.hpp"
#include "engine/kinds/finite.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

namespace troupe::engine {
namespace {

// A plug-in may give a number that is not one: see DeviceKind::Prepared::most_effects. The engine allocates
// all effects of a tick when it builds the world.
constexpr std::size_t k_most_effects = 1'000'000;

/// Checks the fields of a table. bytes: size of the struct with these fields; 0: they are no struct. what:
/// "percept", "command" or "memory field".
Result<> check_fields(std::span<const StateField> fields, std::size_t bytes, std::string_view what) {
  std::vector<std::uint64_t> offsets;
  for (const StateField& field : fields) {
    if (field.name.empty() || field.name.find('/') != std::string::npos)
      return Error{fmt::format("has a {} with the name \"{}\": a name must not be empty or contain \"/\"",
                               what, field.name)};
    if (std::ranges::count(fields, field.name, &StateField::name) > 1)
      return Error{fmt::format("has two {}s with the name \"{}\"", what, field.name)};
    if (field.element > Element::u8)
      return Error{fmt::format("has the {} \"{}\" of an unknown type (Element): {}", what, field.name,
                               static_cast<unsigned>(field.element))};
    offsets.push_back(field.offset);
  }
  if (bytes == 0) return {};
  constexpr std::string_view k_advice = "use the fields that memory_fields() returns for the struct";
  std::size_t end = 0;
  for (const std::size_t f : sorted_order(offsets)) {
    const StateField* field = &fields[f];
    if (field->offset % element_size(field->element) != 0)
      return Error{fmt::format("has the {} \"{}\" at the offset {}, which is no multiple of its size: {}",
                               what, field->name, field->offset, k_advice)};
    if (field->offset < end)
      return Error{
          fmt::format("has the {} \"{}\", which overlaps another {}: {}", what, field->name, what, k_advice)};
    end = field->offset + field->bytes();
    if (end > bytes)
      return Error{fmt::format("has the {} \"{}\", which ends at byte {} of a struct of {} bytes: {}", what,
                               field->name, end, bytes, k_advice)};
  }
  return {};
}

Result<> check_numbers(const DeviceKind& kind, const DeviceKind::Prepared& prepared) {
  if (!(prepared.reach_m >= 0))
    return Error{
        fmt::format("has the reach {} m (reach_m): it must not be negative or NaN", prepared.reach_m)};
  if (const double hint = prepared.cell_hint_m.value_or(0); !(hint >= 0 && std::isfinite(hint)))
    return Error{
        fmt::format("gives {} m as the hint for the width of the cells of the spatial index (cell_hint_m): "
                    "this must be a finite number of at least 0",
                    hint)};
  if (!(prepared.watts >= 0 && std::isfinite(prepared.watts)))
    return Error{
        fmt::format("draws {} W (watts): this must be a finite number of at least 0", prepared.watts)};
  if (prepared.most_effects > k_most_effects)
    return Error{fmt::format("declares up to {} effects in a tick (most_effects): at most {} are allowed",
                             prepared.most_effects, k_most_effects)};
  if (!prepared.joints.empty() && prepared.joints.size() != kind.joints.size())
    return Error{fmt::format("has {} poses of joints (Prepared::joints), but {} joints (DeviceKind::joints)",
                             prepared.joints.size(), kind.joints.size())};
  if (!std::ranges::all_of(prepared.joints, [](const Pose& pose) { return is_finite(pose); }))
    return Error{"has a pose of a joint that is not finite (Prepared::joints)"};
  return {};
}

Result<> check_ranger(const DeviceKind::Prepared& prepared) {
  const std::size_t readings = prepared.bearings.size();
  if (readings == 0) return {};
  if (prepared.percepts.empty() || prepared.percepts[0].element != Element::f32 ||
      prepared.percepts[0].columns != readings)
    return Error{
        fmt::format("has {} bearings, so its first percept must have {} columns of type f32, the ranges",
                    readings, readings)};
  for (const Transducer& fan : prepared.transducers)
    if (fan.first > readings || fan.samples > readings - fan.first)
      return Error{
          fmt::format("has a fan of {} readings that begins with reading {} (Prepared::transducers), but "
                      "only {} bearings",
                      fan.samples, fan.first, readings)};
  return {};
}

/// Checks what a drive device must have: see DeviceKind::drives.
Result<> check_drive(const DeviceKind& kind, const DeviceKind::Prepared& prepared) {
  if (!kind.drives) return {};
  if (prepared.command_bytes != sizeof(Command) || !same_fields(prepared.commands, command_fields()))
    return Error{
        "is a drive device (DeviceKind::drives), so its command struct must be a Command: use the fields "
        "that command_fields() returns"};
  std::size_t bytes = 0;
  for (const StateField& field : prepared.percepts) bytes += field.bytes();
  if (bytes < sizeof(Pose))
    return Error{"is a drive device (DeviceKind::drives), so its state must begin with a Pose"};
  return {};
}

}  // namespace

Result<> check_prepared(const DeviceKind& kind, const DeviceKind::Prepared& prepared) {
  if (Result<> fields = check_fields(prepared.percepts, prepared.percept_bytes, "percept"); !fields)
    return fields;
  if (Result<> fields = check_fields(prepared.commands, prepared.command_bytes, "command"); !fields)
    return fields;
  if (Result<> numbers = check_numbers(kind, prepared); !numbers) return numbers;
  if (Result<> ranger = check_ranger(prepared); !ranger) return ranger;
  if (Result<> drive = check_drive(kind, prepared); !drive) return drive;
  if ((prepared.most_effects > 0 || prepared.ends_lives) && kind.act == nullptr)
    return Error{
        "declares effects (most_effects or ends_lives), which only the hook \"act\" may emit, but has no "
        "such hook"};
  return {};
}

Result<> check_memory(const ControllerKind& kind) {
  if (!kind.memory.empty() && kind.memory_bytes == 0)
    return Error{
        "has a memory (ControllerKind::memory), but does not give the size of its struct: set memory_bytes"};
  return check_fields(kind.memory, kind.memory_bytes, "memory field");
}

}  // namespace troupe::engine
