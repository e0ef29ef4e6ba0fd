#pragma once

#include "engine/fields/description.hpp"
#include "engine/kinds/controller_kind.hpp"

#include <any>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <span>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

/// Lists the members of a struct that belongs to the state of a world, such as a controller's Memory (the
/// data that the controller keeps for each robot). Example: `TROUPE_FIELDS(heading, steps)` in the body of
/// the struct. The state is hashed, compared, saved and recorded field by field, in the order of the list.
///
/// The list must have each member of the struct once. Each member must be a number, a bool or a std::array of
/// these. Numbers are double, float, std::uint8_t and integers of 32 or 64 bits. If a Memory breaks these
/// rules, the code does not compile.
///
/// The macro is the short form of a function `describe` (engine/fields/description.hpp). `describe` also
/// gives each member a unit and a text.
#define TROUPE_FIELDS(...)                                         \
  constexpr auto troupe_fields() { return std::tie(__VA_ARGS__); } \
  static constexpr std::string_view troupe_field_names() { return #__VA_ARGS__; }

namespace troupe::engine {
namespace detail {

/// Returns true if the macro TROUPE_FIELDS of the struct Memory lists no member twice. Does not check that
/// the list has all members.
template <class Memory>
constexpr bool lists_distinct_members() {
  Memory example{};
  return std::apply(
      [](auto&... members) {
        const void* const places[] = {nullptr, &members...};
        for (std::size_t i = 0; i < std::size(places); ++i)
          for (std::size_t j = 0; j < i; ++j)
            if (places[i] == places[j]) return false;
        return true;
      },
      example.troupe_fields());
}

template <class T>
struct Shape {
  using element = T;
  static constexpr std::uint32_t columns = 1;
};
template <class T, std::size_t N>
struct Shape<std::array<T, N>> {
  using element = T;
  static constexpr std::uint32_t columns = N;
};

struct NoMemory {
  constexpr auto troupe_fields() { return std::tuple<>{}; }
  static constexpr std::string_view troupe_field_names() { return ""; }
};

template <class C>
struct MemoryOf {
  using type = NoMemory;
};
template <class C>
requires requires { typename C::Memory; }
struct MemoryOf<C> {
  using type = typename C::Memory;
};

template <class C>
C make(const Record& record) {
  if constexpr (requires { typename C::Params; }) {
    const auto params = from_record<typename C::Params>(record);
    if constexpr (requires { &C::make; })
      return C::make(params);
    else
      return C{params};
  } else {
    static_cast<void>(record);
    if constexpr (requires { &C::make; })
      return C::make();
    else
      return C{};
  }
}

/// Returns the indices of devices of the given kinds, in this order, each device at most once. Returns an
/// error if there are too few devices of a kind.
Result<std::vector<std::size_t>> devices_of(std::span<const std::string_view> kinds,
                                            std::span<const DeviceInfo> devices);
/// Returns the indices of all devices.
std::vector<std::size_t> all_devices(std::span<const DeviceInfo> devices);

template <class C>
Result<std::vector<std::size_t>> choose(C& controller, std::span<const DeviceInfo> devices,
                                        std::vector<bool>& claimed) {
  if constexpr (requires { controller.choose(devices, claimed); }) {
    return controller.choose(devices, claimed);
  } else {
    static_assert(
        !requires { &C::choose; },
        "choose() must take (std::span<const DeviceInfo>, std::vector<bool>& claimed)");
    if constexpr (requires { C::k_uses; }) {
      const std::vector<std::string_view> kinds(std::begin(C::k_uses), std::end(C::k_uses));
      return devices_of(kinds, devices);
    } else {
      return all_devices(devices);
    }
  }
}

/// Throws the exception that is being handled, as a DecisionError of the robot in this row.
[[noreturn]] void throw_decision_error(Row row);

template <class Memory, class C>
void decide_one_by_one(const C& controller, const DecideBatch& batch) {
  std::array<Readings, k_most_devices_read> readings;
  std::array<std::span<std::byte>, k_most_devices_read> devices;
  Percept percept{.tick = batch.tick,
                  .time_s = batch.time_s,
                  .tick_s = batch.tick_s,
                  .period_s = batch.period_s,
                  .devices = {readings.data(), batch.devices}};
  std::size_t i = 0;
  try {
    for (; i < batch.size(); ++i) {
      percept.body = batch.body(i);
      for (std::size_t s = 0; s < batch.devices; ++s) {
        readings[s] = batch.readings(s, i);
        devices[s] = {batch.device_command(s, i), batch.device_commands[s].row_bytes};
      }
      percept.estimate = batch.estimate(i);
      percept.stalled = batch.stalled(i);
      percept.blocked_by = batch.blocked_by(i);
      Random random = batch.random(i);
      Actions actions{
          batch.command(i), {devices.data(), batch.devices}, {batch.switches.data(), batch.devices}};
      if constexpr (std::is_same_v<Memory, NoMemory>)
        controller(percept, random, actions);
      else
        controller(*reinterpret_cast<Memory*>(batch.memory(i)), percept, random, actions);
    }
  } catch (...) {
    throw_decision_error(batch.rows[i]);
  }
}

/// A member of a struct with TROUPE_FIELDS.
struct ListedMember {
  Element element;
  bool is_bool;
  std::uint32_t columns;
  std::uint32_t offset;  ///< offset in the struct, bytes
};
/// Returns the state fields of a struct with TROUPE_FIELDS. `names` are the names of its members, separated
/// by commas.
std::vector<StateField> listed_fields(std::string_view names, std::span<const ListedMember> members);

template <class T>
ListedMember listed_member(const T& member, const void* object) {
  using Element = typename Shape<T>::element;
  return {
      element_of<Element>(), std::is_same_v<Element, bool>, Shape<T>::columns,
      static_cast<std::uint32_t>(reinterpret_cast<const char*>(&member) - static_cast<const char*>(object))};
}

template <class Memory>
std::vector<StateField> listed_fields() {
  Memory example{};
  constexpr std::size_t count = std::tuple_size_v<decltype(example.troupe_fields())>;
  static_assert(std::is_aggregate_v<Memory>,
                "the memory struct must have no constructors: give its members initial values");
  static_assert(std::is_empty_v<Memory> || detail::has_members<Memory, count>(),
                "TROUPE_FIELDS must list every member of the memory struct");
  static_assert(detail::lists_distinct_members<Memory>(),
                "TROUPE_FIELDS must list every member of the memory struct once");
  return std::apply(
      [&example](const auto&... members) {
        const std::array<ListedMember, count> list{listed_member(members, &example)...};
        return listed_fields(Memory::troupe_field_names(), list);
      },
      example.troupe_fields());
}

/// Makes a controller kind without hooks. `params` returns the table of its parameters (null: it has none),
/// and `memory` the fields of its memory struct, which has `memory_bytes` bytes.
ControllerKind controller_kind(std::string_view name, std::string_view text, const FieldTable& (*params)(),
                               std::vector<StateField> (*memory)(), std::size_t memory_bytes);
/// Returns the result of ControllerKind::prepare for a controller that has chosen its devices.
Result<ControllerKind::Prepared> prepared_controller(std::any controller,
                                                     Result<std::vector<std::size_t>> devices);

}  // namespace detail

/// Returns the fields of a struct that belongs to the state, such as a controller's Memory: one StateField
/// (name, type, unit, text and offset in the struct) for each member. The result is empty for a struct
/// without members.
///
/// The struct must have a function `describe` or the macro TROUPE_FIELDS. If it has both, `describe` is used.
/// The fields have the order in which `describe` or TROUPE_FIELDS names them. The struct must be trivially
/// copyable, must have no constructors, and must not need an alignment of more than 16 bytes. If it breaks
/// one of these rules, the code does not compile.
template <class Memory>
std::vector<StateField> memory_fields() {
  static_assert(std::is_trivially_copyable_v<Memory>,
                "the memory struct must be trivially copyable, because it is saved and hashed as bytes");
  static_assert(alignof(Memory) <= alignof(std::max_align_t),
                "the memory struct must not need an alignment of more than 16 bytes");
  if constexpr (detail::Described<Memory>) {
    static_assert(detail::described_members<Memory>().is_state(),
                  "the members of a memory or state struct must be numbers, bools or arrays of these");
    return state_fields(described<Memory>());
  } else {
    return detail::listed_fields<Memory>();
  }
}

/// Makes a controller kind from a class C. A controller kind is a table of functions that implements one sort
/// of controller (ControllerKind in engine/kinds/device_kind.hpp). `name` and `text` must live as long as the
/// kind.
///
/// C must be copyable. One object of C serves all robots of a body type. Several threads call this object at
/// once, each for different robots, so operator() must not change the object. The data that a robot keeps
/// from one decision to the next belong in Memory. If operator() for one robot throws, the error message of
/// the step names that robot.
///
/// C must have one of these functions. A batch is a list of robots that decide in the same tick (time step).
///
///     void operator()([Memory&,] const Percept&, Random&, Actions&) const;  // for one robot
///     void operator()(const DecideBatch&) const;                            // for a batch of robots
///
/// C may have these members:
///
///     struct Params { ...; describe };            // its parameters; default: none
///     struct Memory { ...; TROUPE_FIELDS(...) };  // memory of each robot; may have `describe` instead
///     static constexpr bool needs_drive = false;  // default: true, the robot must have a drive
///     static constexpr bool switches = true;      // default: false; true: it switches devices on and off
///     static constexpr bool reads_contacts = true;  // default: false; true: it reads Percept::blocked_by
///     static C make(const Params&);               // makes the object; default: C{params}
///         // If C has no Params: static C make(); default: C{}
///     Result<std::vector<std::size_t>> choose(std::span<const DeviceInfo>, std::vector<bool>& claimed);
///         // Chooses the devices that the controller uses, at most k_most_devices_read (16), and returns
///         // their indices in the first argument. That argument lists the devices on the part of the body
///         // to which the controller belongs, and on the parts mounted on that part. Devices that move a
///         // part (DeviceKind::drives) are not listed. claimed[d] is true if an earlier controller has
///         // reserved device d for itself. The function may set claimed[d] to reserve the device.
///         // Default: uses all listed devices, including reserved ones, and reserves none.
///     static constexpr std::array k_uses{std::string_view("ranger")};
///         // Instead of choose: the kinds of the devices that the controller uses, in this order. A kind
///         // that is listed twice stands for two devices. It is an error if the robot has too few devices
///         // of a kind. The controller may use reserved devices, and reserves none.
///     Result<> bind_world(const WorldSpec&, const TypeSpec&, std::uint32_t part);
///         // Completes the object from the world: ControllerKind::bind_world.
///     void lint(const LintView&) const;  // finds probable mistakes in a world: ControllerKind::lint
///     static constexpr std::array<std::string_view, N> brings;
///         // Kinds of devices that the loader of Stage worlds adds to each model with this controller:
///         // ControllerKind::brings.
template <class C>
ControllerKind make_controller_kind(std::string_view name, std::string_view text) {
  using Memory = typename detail::MemoryOf<C>::type;
  const FieldTable& (*params)() = nullptr;
  if constexpr (requires { typename C::Params; }) params = described<typename C::Params>;
  ControllerKind kind = detail::controller_kind(name, text, params, memory_fields<Memory>, sizeof(Memory));
  if constexpr (requires { C::needs_drive; }) kind.needs_drive = C::needs_drive;
  if constexpr (requires { C::switches; }) kind.switches = C::switches;
  if constexpr (requires { C::reads_contacts; }) kind.reads_contacts = C::reads_contacts;
  kind.start = [](std::byte* memory) { std::construct_at(reinterpret_cast<Memory*>(memory)); };
  kind.prepare = [](const Record& record, std::span<const DeviceInfo> devices,
                    std::vector<bool>& claimed) -> Result<ControllerKind::Prepared> {
    C controller = detail::make<C>(record);
    Result<std::vector<std::size_t>> chosen = detail::choose(controller, devices, claimed);
    return detail::prepared_controller(std::move(controller), std::move(chosen));
  };
  if constexpr (requires { C::brings; }) kind.brings.assign(std::begin(C::brings), std::end(C::brings));
  if constexpr (requires(C & c, const WorldSpec& world, const TypeSpec& type) {
                  c.bind_world(world, type, 0u);
                })
    kind.bind_world = [](std::any& data, const WorldSpec& world, const TypeSpec& type,
                         std::uint32_t part) -> Result<> {
      return std::any_cast<C>(&data)->bind_world(world, type, part);
    };
  kind.decide = [](const std::any& data, const DecideBatch& batch) {
    const C& controller = *std::any_cast<C>(&data);
    if constexpr (requires { controller(batch); })
      controller(batch);
    else
      detail::decide_one_by_one<Memory>(controller, batch);
  };
  if constexpr (requires { &C::lint; })
    kind.lint = [](const std::any& data, const LintView& view) { std::any_cast<C>(&data)->lint(view); };
  return kind;
}

}  // namespace troupe::engine
