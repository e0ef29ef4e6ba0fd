#include "troupe/acts.hpp"

#include "engine/world/world.hpp"
#include "troupe/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace troupe {
namespace {

using Kind = Act::Kind;
using engine::Element;
using engine::StateField;

constexpr double k_most_speed = 1e6;  // m/s and rad/s: larger commands are mistakes

[[noreturn]] void refuse_act(const std::string& reason) { throw ActRefused(reason); }

/// Returns the body that the act names. Throws ActRefused if there is no such body, or if the body is not in
/// the world.
Model body_of(Simulation& simulation, const Act& act) {
  const BodyId id = simulation.world().state().names.find(act.whom);
  if (!id.valid()) refuse_act(fmt::format("there is no body \"{}\"", act.whom));
  Model model = simulation.model(id);
  if (!model.is_alive())
    refuse_act(fmt::format("\"{}\" is not in the world: it is not yet born, or dead", act.whom));
  return model;
}

void check_finite(const Pose& pose) {
  for (const double x : {pose.x, pose.y, pose.z, pose.heading})
    if (!std::isfinite(x))
      refuse_act(
          fmt::format("the pose must have finite x, y, z and heading, found x {}, y {}, z {}, heading {}",
                      pose.x, pose.y, pose.z, pose.heading));
}

void move(Model& model, const Pose& pose) {
  check_finite(pose);
  if (!model.is_free(pose))
    refuse_act(fmt::format(
        "\"{}\" cannot be placed at x {:.6g} m, y {:.6g} m: a wall or another body is there, or the place is "
        "outside the world's bounds",
        model.name(), pose.x, pose.y));
  model.set_pose(pose);
}

/// Whether a value of the field can be a finite number. An integer type stores only integers in its range
/// (64-bit types: from -2^53, or 0 if unsigned, to 2^53 - 1, where doubles are exact), and a bool 0 and 1.
/// f32 rounds numbers that do not exceed the largest float in magnitude.
bool holds(const StateField& field, double x) {
  const auto within = [&](double least, double end) { return x >= least && x < end && std::trunc(x) == x; };
  switch (field.element) {
    case Element::f64: return true;
    case Element::f32: return std::abs(x) <= static_cast<double>(std::numeric_limits<float>::max());
    case Element::i64: return within(-0x1p53, 0x1p53);
    case Element::i32: return within(-0x1p31, 0x1p31);
    case Element::u64: return within(0, 0x1p53);
    case Element::u32: return within(0, 0x1p32);
    case Element::u8: break;
  }
  return within(0, field.is_bool ? 2 : 256);
}

void put(Element element, std::byte* to, double x) {
  engine::visit_element(element, [=](auto value) {
    value = static_cast<decltype(value)>(x);
    std::memcpy(to, &value, sizeof value);
  });
}

void command(Model& model, const Act& act) {
  const Model::Asked asked = model.asked(act.device);
  const auto field_of = [&](const std::string& name) -> const StateField& {
    const StateField* const found = engine::field_named(asked.fields, name);
    if (found == nullptr) {
      std::string known;
      for (const StateField& field : asked.fields) known += (known.empty() ? "" : ", ") + field.name;
      refuse_act(fmt::format("device \"{}\" takes no command \"{}\"; known: {}", act.device, name, known));
    }
    return *found;
  };
  // All values are checked before any is written, so that an impossible act changes nothing.
  for (const auto& [name, numbers] : act.values) {
    const StateField& field = field_of(name);
    if (numbers.size() != field.columns)
      refuse_act(fmt::format("command \"{}\" of device \"{}\" takes {} numbers, found {}", name, act.device,
                             field.columns, numbers.size()));
    for (const double x : numbers)
      if (!std::isfinite(x) || !holds(field, x))
        refuse_act(
            fmt::format("command \"{}\" of device \"{}\" has the type {}, which cannot represent {:.17g}",
                        name, act.device, field.is_bool ? "bool" : engine::element_name(field.element), x));
  }
  for (const auto& [name, numbers] : act.values) {
    const StateField& field = field_of(name);
    for (std::size_t i = 0; i < numbers.size(); ++i)
      put(field.element, asked.bytes.data() + field.offset + i * engine::element_size(field.element),
          numbers[i]);
  }
}

void check_speed(const Act& act) {
  for (const double x : act.speed)
    if (!(std::abs(x) <= k_most_speed))
      refuse_act(fmt::format("a speed is {}: give speeds from -{} to {} (m/s; turn in rad/s)", x,
                             k_most_speed, k_most_speed));
}

void carry_out_checked(Simulation& simulation, const Act& act, Holds& holds) {
  if (static_cast<std::size_t>(act.kind) >= engine::k_acts.size())
    refuse_act(fmt::format("the kind of the act, {}, is no value of Act::Kind", static_cast<int>(act.kind)));
  if (act.kind == Kind::add) {
    check_finite(act.pose);
    if (simulation.unborn(act.whom) == 0)
      refuse_act(fmt::format("the reserve of population \"{}\" is used up: all its bodies have been born",
                             act.whom));
    if (!simulation.spawn(act.whom, act.pose))
      refuse_act(fmt::format(
          "no body of population \"{}\" can be added at x {:.6g} m, y {:.6g} m: a wall or another body is "
          "there, or the place is outside the world's bounds",
          act.whom, act.pose.x, act.pose.y));
    return;
  }
  if (act.kind == Kind::set) return simulation.set(act.whom, act.setting);
  Model model = body_of(simulation, act);
  switch (act.kind) {
    case Kind::move: return move(model, act.pose);
    case Kind::speed: check_speed(act); return model.set_speed(act.speed[0], act.speed[1], act.speed[2]);
    case Kind::hold:
      check_speed(act);
      model.set_speed(act.speed[0], act.speed[1], act.speed[2]);  // throws if it has no drive
      return holds.set(model.id().value, act.speed);
    case Kind::release:
      if (!holds.release(model.id().value))
        refuse_act(
            fmt::format("\"{}\" cannot be released: no act \"hold\" of this robot is in effect", act.whom));
      return;
    case Kind::command: return command(model, act);
    case Kind::remove: return simulation.remove(model);
    case Kind::disable:
      if (!simulation.disable(model)) refuse_act(fmt::format("\"{}\" is already disabled", act.whom));
      return;
    case Kind::enable:
      if (!simulation.enable(model)) refuse_act(fmt::format("\"{}\" is not disabled", act.whom));
      return;
    case Kind::add:
    case Kind::set: break;
  }
}

}  // namespace

void Holds::apply(Simulation& simulation) {
  std::erase_if(speeds_, [&](const auto& hold) {
    Model model = simulation.model(BodyId(hold.first));
    if (!model.is_alive()) return true;
    const auto& [forward, left, turn] = hold.second;
    model.set_speed(forward, left, turn);
    return false;
  });
}

std::vector<std::byte> Holds::memory() const {
  std::vector<std::byte> memory;
  const auto add = [&](const auto& value) {
    const auto* bytes = reinterpret_cast<const std::byte*>(&value);
    memory.insert(memory.end(), bytes, bytes + sizeof value);
  };
  for (const auto& [body, speed] : speeds_) {
    add(body);
    for (const double x : speed) add(x);
  }
  return memory;
}

bool Holds::remember(std::span<const std::byte> memory, std::size_t bodies) {
  constexpr std::size_t k_entry = sizeof(std::uint32_t) + 3 * sizeof(double);
  speeds_.clear();
  if (memory.size() % k_entry != 0) return false;
  for (; !memory.empty(); memory = memory.subspan(k_entry)) {
    std::uint32_t body = 0;
    std::array<double, 3> speed{};
    std::memcpy(&body, memory.data(), sizeof body);
    std::memcpy(speed.data(), memory.data() + sizeof body, sizeof speed);
    if (body >= bodies || !std::ranges::all_of(speed, [](double x) { return std::isfinite(x); })) {
      speeds_.clear();
      return false;
    }
    speeds_[body] = speed;
  }
  return true;
}

void carry_out(Simulation& simulation, const Act& act, Holds& holds) {
  try {
    carry_out_checked(simulation, act, holds);
  } catch (const ActRefused&) {
    throw;
  } catch (const std::logic_error& error) {  // thrown by the functions of Simulation
    throw ActRefused(error.what());
  }
}

}  // namespace troupe
