#include "worldio/stage/stage_writer.hpp"

#include "engine/spec/names.hpp"
#include "worldio/images/floor_image.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/load.hpp"
#include "worldio/stage/stage_limits.hpp"
#include "worldio/stage/stage_round_trip.hpp"
#include "worldio/stage/stage_text.hpp"
#include "worldio/stage/stage_type_writer.hpp"
#include "worldio/stage/stage_watch.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace troupe::worldio {
namespace {

using engine::TypeSpec;
using engine::WorldSpec;

/// Turns a name into a word of Stage's syntax, which begins with a letter.
std::string word_of(const std::string& name) {
  std::string word;
  for (const char c : name) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    const bool is_other = (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
    if (word.empty() && !is_letter) word = "type_";
    word += is_letter || is_other ? c : '_';
  }
  return word.empty() ? "type" : word;
}

/// Whether a record, or a record inside it, has a heading outside [-pi, pi], which Stage would wrap.
bool has_wide_heading(const engine::Record& record, const engine::FieldTable& table) {
  for (std::size_t i = 0; i < table.fields.size() && i < record.size(); ++i) {
    const engine::Field& field = table.fields[i];
    if (!record[i].given()) continue;
    if (field.record) {
      for (const engine::Record& below : record[i].records())
        if (has_wide_heading(below, *field.record)) return true;
    } else if (field.name == "heading" && std::abs(record[i].number()) > k_pi) {
      return true;
    }
  }
  return false;
}

bool has_wide_heading(const WorldSpec& spec, const engine::Registry& registry) {
  for (const TypeSpec& type : spec.types)
    for (const engine::DeviceSpec& device : type.devices)
      if (const engine::DeviceKind* kind = registry.device(device.kind);
          kind && has_wide_heading(device.params, kind->params))
        return true;
  return false;
}

class WorldText {
 public:
  WorldText(const WorldSpec& spec, const std::filesystem::path& file, const WorldDocument* document,
            const engine::Registry& registry, Diagnostics& diagnostics)
      : spec_(spec),
        folder_(file.parent_path()),
        document_(document),
        registry_(registry),
        diagnostics_(diagnostics),
        images_(image_findings_),
        text_(diagnostics) {}

  std::string write() {
    write_settings();
    write_types();
    for (std::size_t b = 1; b < spec_.bodies.size(); ++b) write_body(spec_.bodies[b]);
    return text_.str();
  }

 private:
  bool says(std::string_view key) const { return document_ && document_->says(key); }
  /// Returns the place of a key of the JSON document. `key` is the name of the key as in Placed::Key. If the
  /// document does not have the key, returns the file as a whole.
  Where where_of(std::string_view key) const {
    return says(key) ? document_->where_of(key) : Where{spec_.resolution_where.file, 0};
  }
  void lacks(std::string_view key, std::string_view why) {
    const engine::Field& field = document_table<WorldDocument>().find(key)->field;
    diagnostics_.error(where_of(key),
                       fmt::format("a .world file cannot express this: \"{}\": {}", key_of(field), why));
  }
  void refuse_what_stage_lacks();
  void write_settings();
  void write_types();
  void write_body(const engine::BodySpec& body);

  const WorldSpec& spec_;
  std::filesystem::path folder_;
  const WorldDocument* document_;
  const engine::Registry& registry_;
  Diagnostics& diagnostics_;
  Diagnostics image_findings_;  // ignored: if an image cannot be read, the body is written as outlines
  FloorImages images_;
  StageText text_;
  std::vector<std::string> macros_;  // per type: the name of its macro
  std::vector<Color> colors_;        // per type: the colour of its first body
};

void WorldText::refuse_what_stage_lacks() {
  if (spec_.ranging != engine::RangingEngine::exact)
    lacks("ranging", "remove this key, and choose the ray engine with troupe run --raytracer");
  if (spec_.record) lacks("record", "remove this key, and record with troupe run --record");
  if (!spec_.measures.empty())
    lacks("measures", "remove this key, and choose measures with troupe run --measure");
  if (spec_.measure_every_s != WorldSpec().measure_every_s)
    lacks("measure_every", "remove this key, and set the interval with troupe run --measure-every");
  if (!spec_.reserves.empty())
    lacks(says("populations") ? "populations" : "models",
          "Stage has no \"reserve\" of bodies that are born later: remove the reserve");
  for (const engine::EmptyPopulation& population : spec_.empty_populations)
    diagnostics_.warning(
        where_of("populations"),
        fmt::format("population \"{}\" has no bodies, so the .world file does not contain it",
                    population.name));
  if (spec_.mortal) lacks("mortal", "a .world file has no such property: remove this key");
  if (spec_.contacts) lacks("contacts", "a .world file has no such property: remove this key");
  if (!spec_.experiment.stop_when.empty())
    lacks("stop_when", "in Stage, a run can end only at its \"quit_time\": remove this key");
  if (!spec_.experiment.at.empty()) lacks("at", "a .world file has no interventions: remove this key");
  if (!spec_.experiment.faults.empty()) lacks("faults", "robots do not fail in Stage: remove this key");
  if (says("bounds_m"))
    lacks("bounds_m",
          "a Stage world always reaches 100 km from its origin in each direction: remove this key");
  else if (document_ && document_->arena && !document_->arena->walls)
    lacks("arena",
          "without walls, an arena only sets the bounds, and a Stage world always reaches 100 km from its "
          "origin in each direction: remove this key");
  else if (spec_.bounds)
    diagnostics_.warning(
        where_of(says("floorplans") ? "floorplans" : "arena"),
        fmt::format("the world of a .world file reaches 100 km from its origin in each direction: the edge "
                    "of the {} no longer stops robots",
                    says("floorplans") ? "floor plans" : "arena"));
}

void WorldText::write_settings() {
  refuse_what_stage_lacks();
  text_.comment("Written by troupe convert.");
  text_.at(where_of("title"));
  if (!spec_.title.empty()) text_.text("name", spec_.title);
  text_.text("unit_length", "m");
  text_.text("unit_angle", "radians");
  if (has_wide_heading(spec_, registry_)) text_.flag("wrap_headings", false);
  // Stage counts whole microseconds.
  const auto clock = [](double ms) { return std::floor(ms * 1000) / 1e6; };
  text_.number("interval_sim", solved(spec_.tick_s, spec_.tick_s * 1000, clock));
  text_.at(where_of("quit_time"));
  if (spec_.quit_time_s) text_.number("quit_time", *spec_.quit_time_s);
  if (spec_.resolution_m != WorldSpec().resolution_m) text_.number("resolution", spec_.resolution_m);
  text_.at(where_of("seed"));
  if (spec_.seed > static_cast<std::uint64_t>(k_largest_number))
    lacks("seed", fmt::format("numbers of a .world file must be from -2^53 to 2^53, found {}", spec_.seed));
  else
    text_.number("seed", static_cast<double>(spec_.seed));
  write_stage_watch(spec_.watch, text_);
  text_.at(where_of("window"));
  if (spec_.window) write_stage_window(*spec_.window, text_);
}

/// Writes a macro for each type that has bodies. The name of the macro is that of the type, with a number if
/// another macro has this name.
void WorldText::write_types() {
  std::vector<bool> is_used(spec_.types.size(), false);
  std::vector<bool> has_many_colors(spec_.types.size(), false);
  colors_.resize(spec_.types.size());
  for (std::size_t b = 1; b < spec_.bodies.size(); ++b) {
    const std::size_t t = spec_.bodies[b].type.index();
    if (!is_used[t]) colors_[t] = spec_.bodies[b].color;
    if (spec_.bodies[b].color != colors_[t]) has_many_colors[t] = true;
    is_used[t] = true;
  }
  engine::UniqueNames unique("_");
  for (const std::string_view word : {"define", "include", "block", "sensor", "window", "laser", "sonar"})
    unique.add(word);
  for (const engine::ModelKind& kind : registry_.models) unique.add(kind.name);
  macros_.resize(spec_.types.size());
  std::vector<std::set<std::string>> global_parts(spec_.types.size());
  for (const auto& [name, place] : spec_.part_aliases)
    global_parts[spec_.bodies[place.body.index()].type.index()].insert(name);
  for (std::size_t t = 1; t < spec_.types.size(); ++t) {
    if (!is_used[t]) continue;
    const TypeSpec& type = spec_.types[t];
    macros_[t] = unique.add(word_of(type.name));
    const StageMacro macro{.word = macros_[t],
                           .color = colors_[t],
                           .has_many_colors = has_many_colors[t],
                           .added = added_parts(type, spec_.seed, registry_),
                           .global_parts = std::move(global_parts[t])};
    TypeSpec colored = type;  // in a spec, a part without a colour has that of its body
    for (std::size_t p = 1; p < colored.parts.size(); ++p) {
      if (macro.added[p] || colored.parts[p].color || colored.parts[p].solids.empty()) continue;
      colored.parts[p].color = colors_[t];
      if (has_many_colors[t])
        diagnostics_.error(
            colored.parts[p].where,
            fmt::format("a .world file cannot express this: part \"{}\" of type \"{}\" has no color of its "
                        "own, and the bodies of this type differ in color: give the part a \"color\"",
                        colored.parts[p].name, type.name));
    }
    write_stage_type(colored, macro, {folder_, registry_, images_, diagnostics_}, text_);
  }
}

void WorldText::write_body(const engine::BodySpec& body) {
  const std::size_t type = body.type.index();
  const std::string name = spec_.names.text(body.name);
  text_.at(body.where);
  text_.open(macros_[type]);
  text_.text("name", name.starts_with('/') ? "/" + name : name);
  text_.pose("pose", body.pose_world_body);
  if (body.color != colors_[type]) write_stage_color(body.color, text_);
  if (body.fiducial != 0) text_.number("fiducial_return", body.fiducial);
  text_.close();
}

}  // namespace

std::string write_stage_world(const WorldSpec& spec, const std::filesystem::path& file,
                              const WorldDocument* document, const engine::Registry& registry,
                              Diagnostics& diagnostics) {
  std::string text = WorldText(spec, file, document, registry, diagnostics).write();
  if (diagnostics.has_errors()) return text;
  Diagnostics found;
  const WorldSpec back = load_stage_world(file, text, registry, {}, found);
  for (const Finding& finding : found.findings())
    if (finding.severity == Severity::error)
      diagnostics.error(
          {spec.resolution_where.file, 0},
          fmt::format("a .world file cannot express this world: the written text could not be loaded: {}",
                      finding.message));
  if (!diagnostics.has_errors()) check_stage_round_trip(spec, back, registry, diagnostics);
  return text;
}

}  // namespace troupe::worldio
