#pragma once

#include "base/diagnostics.hpp"
#include "engine/kinds/registry.hpp"
#include "engine/spec/measure_spec.hpp"
#include "worldio/json/json_reader.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::worldio {

/// Reads an entry of the list `measures` of a world. A measure is a number that is computed from the state of
/// a run, such as `stalls`, the number of robots that cannot move. An entry has one of these forms:
/// - `"stalls"`: the measure of all robots
/// - `"stalls:leaders"`: the measure of the robots that "leaders" names. This is the name of a body type, of
///   a population (a group of bodies that are placed by a rule) or of a single robot.
/// - an object, such as {"kind": "stalls", "of": "leaders", "name": "stalled_leaders"}; the parameters of the
///   measure are further keys
///
/// If the entry has another form, names an unknown measure or has wrong parameters, reports errors and
/// returns nothing. Does not check that "leaders" exists, which is checked when the world is built.
std::optional<engine::MeasureSpec> read_measure(const JsonCursor& at, const engine::Registry& registry);

/// Like read_measure(), but reads the measure from an argument of the command line. `text` is `stalls` or
/// `stalls:leaders` without quotation marks, or an object, which begins with `{`. Errors name `source`, such
/// as "--measure", in place of a file.
std::optional<engine::MeasureSpec> parse_measure(const std::string& text, const std::string& source,
                                                 const engine::Registry& registry, Diagnostics& diagnostics);

/// Returns an error message if `name` is no kind of measure, resembles no kind, but resembles one of the
/// names `listed` that the list `measures` of the world gives to its measures. Otherwise returns an empty
/// text; the functions above then say what is wrong with the name.
std::string misspelled_measure(const std::string& name, std::vector<std::string_view> listed,
                               const engine::Registry& registry);

}  // namespace troupe::worldio
