#pragma once

#include "engine/fields/description.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/kinds/device_kind.hpp"

#include <any>
#include <cstddef>
#include <iterator>
#include <string_view>
#include <vector>

namespace troupe::engine {
namespace detail {

template <class C>
DeviceKind::Prepared prepare_device(const Record& record, const Pose& pose_body_device) {
  if constexpr (requires { typename C::Params; }) {
    const auto params = from_record<typename C::Params>(record);
    if constexpr (requires { &C::prepare; })
      return C::prepare(params, pose_body_device);
    else if constexpr (requires { &C::make; })
      return {.data = C::make(params, pose_body_device)};
    else
      return {.data = C{params}};
  } else if constexpr (requires { &C::prepare; }) {
    return C::prepare(pose_body_device);
  } else {
    return {.data = C{}};
  }
}

/// The state or command struct of a device class: a function that returns its fields (null: the class has no
/// such struct), and its size, bytes.
struct DeviceStruct {
  std::vector<StateField> (*fields)() = nullptr;
  std::size_t bytes = 0;
};
/// Completes the result of DeviceKind::prepare for a device class: sets empty lists of fields. Throws
/// std::logic_error if holds_class, which says whether `data` holds the device class, is false.
void complete(DeviceKind::Prepared& prepared, bool holds_class, const DeviceStruct& state,
              const DeviceStruct& command);
/// Converts the context of an effect to the view that a function takes as an argument.
struct AnyEffectView {
  const EffectContext& context;

  template <class View>
  operator View() const {  // NOLINT(google-explicit-constructor): the conversion is the purpose
    return View(context);
  }
};

/// Makes a device kind without hooks. `params` returns the table of its parameters (null: it has none).
DeviceKind device_kind(std::string_view name, std::string_view text, const FieldTable& (*params)());

}  // namespace detail

/// Makes a device kind from a class C. A *kind* of sensor or other device is a table of functions, its
/// *hooks* (DeviceKind in engine/kinds/device_kind.hpp, which says when the engine calls each hook and what
/// the hook must do). The hooks of the result call the members of C with the same names. `name` and `text`
/// must live as long as the kind.
///
/// C must be copyable. All bodies of a body type have the same devices. For each device of a type there is
/// one object of C. It serves all bodies of the type, and several threads call it at once.
///
/// C may have these members to define the data of a device:
///
///     struct Params { ...; describe };            // its parameters; default: none
///     struct State { ...; describe };             // its state, such as readings (percepts), one per body
///     struct Command { ...; describe };           // its commands from controllers, one struct per body
///         // `describe` is a function that lists the members of the struct with units and texts
///         // (engine/fields/description.hpp). State and Command may have the macro TROUPE_FIELDS instead.
///     static C make(const Params&, const Pose& pose_body_device);
///         // Makes the object from the parameters. Only if C has Params.
///         // Default: C{params}, or C{} if C has no Params.
///     static DeviceKind::Prepared prepare(const Params&, const Pose& pose_body_device);
///         // Instead of make, to set further members of DeviceKind::Prepared. The hook
///         // DeviceKind::prepare completes the result: it sets an empty list `percepts` to the fields of
///         // State, and an empty list `commands` to the fields of Command. The hook throws
///         // std::logic_error if the member `data` of the result does not hold a C.
///         // If C has no Params, the pose is the only argument.
///
/// C may have the following functions. Each implements the hook of DeviceKind with the same name. The
/// argument `data` of the hook is omitted, because the function is called for the object of C that `data`
/// contains. If C lacks a function, the hook is null.
///
/// The functions marked "row" take the state of one body as a StateTable and a slot (the index of the body's
/// row in this table). If C has a State, they may take a reference to the State of the body instead of these
/// two arguments.
///
///     std::uint64_t sense(const SenseBatch&) const;                      // or a const DeviceBatch&
///     void act(const DeviceBatch&) const;
///     void joints_moved(const DeviceBatch&) const;
///     void collide(const DeviceBatch&, const Collision&) const;
///     void start(StateTable&, std::size_t slot) const;                   // row
///     static void halt(StateTable&, std::size_t slot);                   // row
///     bool is_spent(const StateTable&, std::size_t slot) const;          // row
///     static Energy energy(const StateTable&, std::size_t slot);         // row
///     static HeldFlags flags(const StateTable&, std::size_t slot);       // row
///     void apply(OwnDevice, const Effect&) const;     // or another view of engine/links/effect_views.hpp
///     void born(OwnDevice, const Effect&, const Birth&) const;
///     void draw(const DeviceView&, Frame&) const;
///     void lint(const LintView&) const;
///     Result<> bind_part(const TypeSpec&, std::uint32_t part);
///     Result<> bind_world(const WorldSpec&);
///     double reach_m() const;
///     static std::vector<DeviceKind::Fixture> body(const Params&);       // only if C has Params
///
/// C may have the following constants. They set the members of DeviceKind with the same names. If C lacks a
/// constant, the member has its default.
///
///     static constexpr std::array<std::string_view, N> joints;
///     static constexpr std::array<std::string_view, N> reads;
///     static constexpr ApplyScope scope;
///     static constexpr bool carries, drives, needs_supply, shows_color;
///     static constexpr FrameLayer layer;
template <class C>
DeviceKind make_device_kind(std::string_view name, std::string_view text) {
  const FieldTable& (*params)() = nullptr;
  if constexpr (requires { typename C::Params; }) params = described<typename C::Params>;
  DeviceKind kind = detail::device_kind(name, text, params);
  if constexpr (requires { C::joints; }) kind.joints.assign(std::begin(C::joints), std::end(C::joints));
  if constexpr (requires { C::reads; }) kind.reads.assign(std::begin(C::reads), std::end(C::reads));
  if constexpr (requires { C::scope; }) kind.scope = C::scope;
  if constexpr (requires { C::carries; }) kind.carries = C::carries;
  if constexpr (requires { C::drives; }) kind.drives = C::drives;
  if constexpr (requires { C::needs_supply; }) kind.needs_supply = C::needs_supply;
  if constexpr (requires { C::shows_color; }) kind.shows_color = C::shows_color;
  if constexpr (requires { C::layer; }) kind.layer = C::layer;
  if constexpr (requires { &C::body; })
    kind.body = [](const Record& record) { return C::body(from_record<typename C::Params>(record)); };
  kind.prepare = [](const Record& record, const Pose& pose_body_device) {
    DeviceKind::Prepared prepared = detail::prepare_device<C>(record, pose_body_device);
    detail::DeviceStruct state;
    if constexpr (requires { typename C::State; })
      state = {memory_fields<typename C::State>, sizeof(typename C::State)};
    detail::DeviceStruct command;
    if constexpr (requires { typename C::Command; })
      command = {memory_fields<typename C::Command>, sizeof(typename C::Command)};
    detail::complete(prepared, std::any_cast<C>(&prepared.data) != nullptr, state, command);
    return prepared;
  };
  if constexpr (requires { &C::bind_part; })
    kind.bind_part = [](std::any& data, const TypeSpec& type, std::uint32_t part) -> Result<> {
      return std::any_cast<C>(&data)->bind_part(type, part);
    };
  if constexpr (requires { &C::bind_world; })
    kind.bind_world = [](std::any& data, const WorldSpec& world) -> Result<> {
      return std::any_cast<C>(&data)->bind_world(world);
    };
  if constexpr (requires { &C::reach_m; })
    kind.reach_m = [](const std::any& data) { return std::any_cast<C>(&data)->reach_m(); };
  if constexpr (requires { &C::start; })
    kind.start = [](const std::any& data, StateTable& state, std::size_t slot) {
      const C& device = *std::any_cast<C>(&data);
      if constexpr (requires { device.start(state, slot); })
        device.start(state, slot);
      else
        device.start(state.as<typename C::State>(slot));
    };
  if constexpr (requires { &C::halt; })
    kind.halt = [](StateTable& state, std::size_t slot) {
      if constexpr (requires { C::halt(state, slot); })
        C::halt(state, slot);
      else
        C::halt(state.as<typename C::State>(slot));
    };
  if constexpr (requires { &C::sense; })
    kind.sense = [](const SenseBatch& batch) -> std::uint64_t {
      return std::any_cast<C>(&batch.data)->sense(batch);
    };
  if constexpr (requires { &C::act; })
    kind.act = [](const DeviceBatch& batch) { std::any_cast<C>(&batch.data)->act(batch); };
  if constexpr (requires { &C::joints_moved; })
    kind.joints_moved = [](const DeviceBatch& batch) { std::any_cast<C>(&batch.data)->joints_moved(batch); };
  if constexpr (requires { &C::collide; })
    kind.collide = [](const DeviceBatch& batch, const Collision& collision) {
      std::any_cast<C>(&batch.data)->collide(batch, collision);
    };
  if constexpr (requires { &C::apply; })
    kind.apply = [](const EffectContext& context, const std::any& data, const Effect& effect) {
      std::any_cast<C>(&data)->apply(detail::AnyEffectView{context}, effect);
    };
  if constexpr (requires { &C::born; })
    kind.born = [](const EffectContext& context, const std::any& data, const Effect& effect,
                   const Birth& birth) {
      std::any_cast<C>(&data)->born(detail::AnyEffectView{context}, effect, birth);
    };
  if constexpr (requires { &C::is_spent; })
    kind.is_spent = [](const std::any& data, const StateTable& state, std::size_t slot) -> bool {
      const C& device = *std::any_cast<C>(&data);
      if constexpr (requires { device.is_spent(state, slot); })
        return device.is_spent(state, slot);
      else
        return device.is_spent(state.as<typename C::State>(slot));
    };
  if constexpr (requires { &C::energy; })
    kind.energy = [](const StateTable& state, std::size_t slot) -> Energy {
      if constexpr (requires { C::energy(state, slot); })
        return C::energy(state, slot);
      else
        return C::energy(state.as<typename C::State>(slot));
    };
  if constexpr (requires { &C::flags; })
    kind.flags = [](const StateTable& state, std::size_t slot) -> HeldFlags {
      if constexpr (requires { C::flags(state, slot); })
        return C::flags(state, slot);
      else
        return C::flags(state.as<typename C::State>(slot));
    };
  if constexpr (requires { &C::draw; })
    kind.draw = [](const DeviceView& view, Frame& frame) { std::any_cast<C>(&view.data)->draw(view, frame); };
  if constexpr (requires { &C::lint; })
    kind.lint = [](const std::any& data, const LintView& view) { std::any_cast<C>(&data)->lint(view); };
  return kind;
}

}  // namespace troupe::engine
