#pragma once

#include "engine/fields/description.hpp"
#include "engine/kinds/drive_kind.hpp"

#include <any>
#include <string_view>

namespace troupe::engine {

/// Makes the kind of a drive from a class D. A kind is a table of functions, its hooks. DriveKind in
/// engine/kinds/drive_kind.hpp says when the engine calls each hook and what the hook must do.
///
/// name: name of the kind in files, such as "diff"
/// text: description in one sentence, which `troupe describe` prints
///
/// Both strings must live as long as the kind. D must be copyable. All robots of a body type share one object
/// of D, and several threads call this object at once. D must have these members:
///
///     struct Params { ...; describe };         // parameters of the drive (engine/fields/description.hpp)
///     void drive(const DriveBatch&) const;     // computes the velocities of several robots
///
/// `describe` is a function that lists the members of Params with units, limits and texts. D may also have
/// these members:
///
///     static D make(const Params&);            // makes the object; default: D{params}
///     static Result<> check(const Params&);    // finds inconsistent parameters; default: no error
///     Velocity start() const;                  // velocity until the drive first runs; default: 0
///     static Result<Localization> localization(const Params&);
///         // how robots estimate their poses; default: the estimates are the true poses
///     static std::int64_t pushes(const Params&);
///         // number of bodies that a robot can push at once; default: 0
///     static bool turns_when_blocked(const Params&);
///         // whether a robot whose motion is blocked may turn on the spot; default: false
///     static double top_speed(const Params&);  // highest speed, m/s; default: unknown
///     void lint(const LintView&) const;        // finds probable mistakes; default: none
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
  if constexpr (requires { &D::turns_when_blocked; })
    kind.turns_when_blocked = [](const Record& record) {
      return D::turns_when_blocked(from_record<Params>(record));
    };
  if constexpr (requires { &D::top_speed; })
    kind.top_speed = [](const Record& record) { return D::top_speed(from_record<Params>(record)); };
  if constexpr (requires { &D::lint; })
    kind.lint = [](const std::any& data, const LintView& view) { std::any_cast<D>(&data)->lint(view); };
  return kind;
}

}  // namespace troupe::engine
