#pragma once

#include "engine/fields/description.hpp"
#include "engine/kinds/kinds.hpp"

#include <any>
#include <string_view>

namespace troupe::engine {

/// Makes the kind of a drive from a class D. A kind is a table of functions, its hooks; DriveKind in
/// engine/kinds/kinds.hpp says when the engine calls each hook and what it must do. One object of D serves
/// all robots of a body type, and several threads call this object at once. D must be copyable. `name` and
/// `text` must live as long as the kind. D has
///
///     struct Params { ...; describe };         // its parameters (engine/fields/description.hpp)
///     void drive(const DriveBatch&) const;     // computes the velocities of several robots
///
/// `describe` is a function that lists the members of Params with units, limits and texts. D may have the
/// following members for the other hooks of DriveKind. If D lacks start, localization, pushes or top_speed,
/// the hook of that name is null.
///
///     static D make(const Params&);            // makes the object; default: D{params}
///     static Result<> check(const Params&);    // finds inconsistent parameters; default: no error
///     Velocity start() const;                  // velocity until the drive runs for the first time
///     static Result<Localization> localization(const Params&);  // how robots estimate their poses
///     static std::int64_t pushes(const Params&);  // number of bodies that a robot can push at once
///     static double top_speed(const Params&);     // highest speed, m/s
template <class D>
DriveKind make_drive_kind(std::string_view name, std::string_view text) {
  using Params = typename D::Params;
  DriveKind kind{.name = name, .text = text, .params = described<Params>()};
  kind.prepare = [](const Record& record) -> std::any {
    const auto params = from_record<Params>(record);
    if constexpr (requires { &D::make; })
      return D::make(params);
    else
      return D{params};
  };
  kind.check = [](const Record& record) -> Result<> {
    if constexpr (requires { &D::check; })
      return D::check(from_record<Params>(record));
    else
      return {};
  };
  kind.drive = [](const std::any& data, const DriveBatch& batch) { std::any_cast<D>(&data)->drive(batch); };
  if constexpr (requires { &D::start; })
    kind.start = [](const std::any& data) -> Velocity { return std::any_cast<D>(&data)->start(); };
  if constexpr (requires { &D::localization; })
    kind.localization = [](const Record& record) { return D::localization(from_record<Params>(record)); };
  if constexpr (requires { &D::pushes; })
    kind.pushes = [](const Record& record) { return D::pushes(from_record<Params>(record)); };
  if constexpr (requires { &D::top_speed; })
    kind.top_speed = [](const Record& record) { return D::top_speed(from_record<Params>(record)); };
  return kind;
}

}  // namespace troupe::engine
