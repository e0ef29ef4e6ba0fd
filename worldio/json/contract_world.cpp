#include "engine/spec/names.hpp"
#include "engine/spec/watch_spec.hpp"
#include "worldio/colors.hpp"
#include "worldio/images/floor_image.hpp"
#include "worldio/json/experiment_json.hpp"
#include "worldio/json/json_parts.hpp"
#include "worldio/json/json_text.hpp"
#include "worldio/json/json_world.hpp"
#include "worldio/json/spec_difference.hpp"
#include "worldio/json/type_document.hpp"
#include "worldio/json/write_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <set>
#include <stdexcept>
#include <unordered_map>
#include <utility>
#include <vector>

namespace troupe::worldio {
namespace {

using engine::BodySpec;
using engine::PartSpec;
using engine::TypeSpec;
using engine::WorldSpec;

/// Which violations the document treats as errors. If a member is false, the violation is a warning.
struct Checks {
  bool overlaps = true;    ///< bodies that overlap at the start
  bool same_names = true;  ///< bodies of the same name
};

/// Whether the document has the list `floorplans` and, if so, whether it also has the key `bounds_m`. Without
/// `bounds_m`, the bounds of the world are those of the floor plans.
enum class FloorPlans : std::uint8_t { none, with_their_bounds, with_other_bounds };

/// Makes a document from the spec of a world.
class WorldContractor {
 public:
  WorldContractor(WorldSpec spec, const std::filesystem::path& file, const engine::Registry& registry)
      : spec_(std::move(spec)),
        registry_(registry),
        file_(file),
        folder_(file.parent_path()),
        images_(image_findings_) {}

  WorldDocument contract(const Checks& checks, FloorPlans floor_plans);

 private:
  std::size_t count_floor_plans();
  bool is_floor_plan(std::size_t body);
  /// Whether the image of a part, read again, gives exactly the solids and the size of the part. False for a
  /// size of 0, because sizes in JSON must be above 0.
  /// `as_floor_plan`: true for the image of an entry of `floorplans`, false for that of a part of a type.
  bool makes(const PartSpec& part, bool as_floor_plan);
  void drop_images();
  void contract_settings(const Checks& checks, bool with_bounds, WorldDocument& document) const;
  FloorplanDocument contract_floor_plan(const BodySpec& body) const;
  void contract_types(std::size_t first, WorldDocument& document);
  PopulationDocument contract_empty_population(const engine::EmptyPopulation& population) const;
  ModelDocument contract_model(std::size_t body) const;

  WorldSpec spec_;
  const engine::Registry& registry_;
  std::filesystem::path file_;
  std::filesystem::path folder_;
  Diagnostics image_findings_;  // ignored: an image that can no longer be read is written as outlines
  FloorImages images_;
  std::vector<std::string> keys_;             // for each type, its key in the document
  std::vector<std::optional<Color>> colors_;  // for each type, the colour of its first body
  std::unordered_map<std::uint32_t, engine::Name> aliases_;
  std::unordered_map<std::uint32_t, std::set<std::string>> global_parts_;
};

bool WorldContractor::makes(const PartSpec& part, bool as_floor_plan) {
  if (part.size.minCoeff() <= 0) return false;
  const FloorImage* image = images_.read(part.image->file, part.image->unknown_is_solid, {});
  if (!image) return false;
  PartSpec made = part;
  made.solids = as_floor_plan ? floor_plan_body(*image, *made.image, made.size) : image_solids(*image, made);
  return made.size == part.size && made.solids == part.solids;
}

/// Removes each image that does not give the present solids of its part. This happens if the frame of the
/// part or the image file was changed after the image was read, or if the part has no height. The part is
/// then written as outlines.
void WorldContractor::drop_images() {
  for (TypeSpec& type : spec_.types)
    for (PartSpec& part : type.parts)
      if (part.image && !makes(part, false)) part.image.reset();
}

/// Whether the list `floorplans` can express a body if no other body has its type, which
/// count_floor_plans() checks. True if the body is only an image, and its type has the same index as the
/// body.
bool WorldContractor::is_floor_plan(std::size_t body) {
  const BodySpec& spec = spec_.bodies[body];
  if (spec.type.index() != body || spec.type.index() >= spec_.types.size()) return false;
  const TypeSpec& type = spec_.types[body];
  const PartSpec& part = type.parts.front();
  const bool is_bare =
      type.parts.size() == 1 && !type.drive && type.devices.empty() && type.controllers.empty();
  if (!is_bare || !part.image || !part.floor_plan || part.kind != "model" || part.color ||
      !part.alias.empty())
    return false;
  return type.name == spec_.names.text(spec.name) && part.image->origin == Pose() && makes(part, true);
}

/// Returns how many bodies are written as floor plans. These are the first bodies after the ground.
std::size_t WorldContractor::count_floor_plans() {
  std::size_t count = 0;
  while (count + 1 < spec_.bodies.size() && is_floor_plan(count + 1)) ++count;
  // The type of a floor plan must not have other bodies.
  for (std::size_t b = count + 1; b < spec_.bodies.size(); ++b)
    if (const std::size_t type = spec_.bodies[b].type.index(); type >= 1 && type <= count) count = type - 1;
  return count;
}

WorldDocument WorldContractor::contract(const Checks& checks, FloorPlans floor_plans) {
  const std::size_t plans = floor_plans == FloorPlans::none ? 0 : count_floor_plans();
  for (const engine::NamedBody& alias : spec_.aliases) aliases_.emplace(alias.body.value, alias.name);
  for (const auto& [name, place] : spec_.part_aliases) global_parts_[place.body.value].insert(name);

  WorldDocument document;
  document.where = {spec_.resolution_where.file, 0};
  contract_settings(checks, floor_plans != FloorPlans::with_their_bounds, document);
  for (std::size_t b = 1; b <= plans; ++b)
    document.floorplans.push_back(contract_floor_plan(spec_.bodies[b]));
  drop_images();
  contract_types(plans + 1, document);
  for (std::size_t b = plans + 1; b < spec_.bodies.size(); ++b) document.models.push_back(contract_model(b));
  for (const engine::EmptyPopulation& population : spec_.empty_populations)
    document.populations.push_back(contract_empty_population(population));
  for (const engine::MeasureSpec& measure : spec_.measures)
    document.measures.push_back(contract_measure(measure));
  contract_experiment(spec_, keys_, registry_, document.experiment);
  return document;
}

void WorldContractor::contract_settings(const Checks& checks, bool with_bounds,
                                        WorldDocument& document) const {
  if (spec_.title != file_.stem().string()) document.title = spec_.title;
  document.seed = spec_.seed;
  document.tick = spec_.tick_s;
  document.quit_time = spec_.quit_time_s;
  document.measure_every = spec_.measure_every_s;
  document.ranging = spec_.ranging;
  document.resolution = spec_.resolution_m;
  if (with_bounds) document.bounds = spec_.bounds;
  for (const engine::NamedBody& alias : spec_.aliases)
    if (alias.body == BodyId(0) && !document.ground)  // a document can have only one other name of the ground
      document.ground.emplace().alias = spec_.names.text(alias.name);
  if (const auto& record = spec_.record) {
    document.record.emplace();
    document.record->where = record->where;
    document.record->file = record->file;
    document.record->every = record->every_s;
    document.record->fields = record->fields;
  }
  if (spec_.watch != engine::WatchSpec()) document.watch = engine::watch_record(spec_.watch);
  document.window = spec_.window;
  document.mortal = spec_.mortal;
  document.contacts = spec_.contacts;
  if (!checks.overlaps) document.overlaps = WorldDocument::Check::warn;
  if (!checks.same_names) document.same_names = WorldDocument::Check::warn;
}

FloorplanDocument WorldContractor::contract_floor_plan(const BodySpec& body) const {
  const PartSpec& part = spec_.types[body.type.index()].parts.front();
  FloorplanDocument document;
  document.where = body.where;
  document.name = spec_.names.text(body.name);
  document.image = contract_image(*part.image, part.size, folder_);
  document.pose = body.pose_world_body;
  if (body.color != k_wall_color) document.color = body.color;
  document.returns = part.returns;
  return document;
}

/// Adds the types with index `first` and above to the document. Keys of types must be unique. If several
/// types have the same name, all but the first therefore get another key.
void WorldContractor::contract_types(std::size_t first, WorldDocument& document) {
  keys_.assign(spec_.types.size(), {});
  colors_.assign(spec_.types.size(), {});
  for (std::size_t b = spec_.bodies.size(); b-- > 1;)
    colors_[spec_.bodies[b].type.index()] = spec_.bodies[b].color;
  const std::vector<Color> default_colors = worldio::default_colors(spec_.types);
  engine::UniqueNames unique("#");
  for (std::size_t t = first; t < spec_.types.size(); ++t) {
    const TypeSpec& type = spec_.types[t];
    std::string& key = keys_[t];
    key = unique.add(type.name);
    std::optional<Color> color = colors_[t];
    if (color == default_colors[t]) color.reset();
    document.types.emplace_back(key, contract_type(type, key, color, registry_, &folder_));
  }
}

/// Returns a population without bodies, whose rule of placement does not matter.
PopulationDocument WorldContractor::contract_empty_population(
    const engine::EmptyPopulation& population) const {
  PopulationDocument document;
  document.name = population.name;
  document.type = keys_[population.type.index()];
  document.count = 0;
  document.place.emplace().rule = engine::PlacementRule::Kind::uniform;
  document.place->region = spec_.bounds.value_or(Box::around(Vec2::Zero(), 1));
  return document;
}

ModelDocument WorldContractor::contract_model(std::size_t b) const {
  const BodySpec& body = spec_.bodies[b];
  const std::size_t type = body.type.index();
  ModelDocument document;
  document.where = body.where;
  document.name = spec_.names.text(body.name);
  if (const auto alias = aliases_.find(static_cast<std::uint32_t>(b)); alias != aliases_.end())
    document.alias = spec_.names.text(alias->second);
  document.type = keys_[type];
  if (const engine::ReserveSpec* reserve = spec_.reserve_of(BodyId(b)))
    document.reserve_of = reserve->population;
  document.pose = body.pose_world_body;
  if (colors_[type] != body.color) document.color = body.color;
  if (body.fiducial != 0) document.fiducial_return = body.fiducial;
  if (const auto parts = global_parts_.find(static_cast<std::uint32_t>(b)); parts != global_parts_.end())
    document.global_parts.assign(parts->second.begin(), parts->second.end());
  return document;
}

bool has_repeated_names(const WorldSpec& spec) {
  engine::NameMap taken;
  taken.reserve(spec.bodies.size());
  for (std::size_t b = 0; b < spec.bodies.size(); ++b)
    if (taken.add(spec.bodies[b].name, BodyId(b)) != BodyId(b)) return true;
  return false;
}

/// The result of one attempt to write a world.
struct Attempt {
  std::optional<JsonNode> document;  ///< the document, if it reads back as the same world; empty: failure
  std::vector<Finding> findings;     ///< after a failure: errors from reading the document back
  /// After a failure without findings: the path of the first value that differs, or the text of an exception.
  std::string difference;
};

Attempt attempt(const WorldSpec& spec, const std::filesystem::path& file, const Checks& checks,
                FloorPlans floor_plans, const engine::Registry& registry,
                const std::shared_ptr<SourceFiles>& files) {
  Attempt result;
  const Where whole{files->add(file.string()), 0};
  try {
    JsonNode document =
        write_document(WorldContractor(spec, file, registry).contract(checks, floor_plans), registry);
    place_nodes(document, whole);
    Diagnostics found(files);
    const std::optional<JsonNode> read = parse_json(json_text(document), whole, true, found);
    const WorldSpec back = read ? read_json_world(file, *read, registry, {}, found) : WorldSpec();
    if (found.has_errors()) {
      Diagnostics placed(files);  // the same errors, at their places in the original world
      if (read) read_json_world(file, document, registry, {}, placed);
      const auto findings = placed.has_errors() ? placed.findings() : found.findings();
      result.findings.assign(findings.begin(), findings.end());
      std::erase_if(result.findings, [](const Finding& f) { return f.severity != Severity::error; });
    } else {
      result.difference = spec_difference(spec, back);
      if (result.difference.empty()) result.document = std::move(document);
    }
  } catch (const std::runtime_error& error) {
    result.difference = error.what();
  }
  return result;
}

}  // namespace

std::optional<JsonNode> write_json_world(const WorldSpec& spec, const std::filesystem::path& file,
                                         const engine::Registry& registry, Diagnostics& diagnostics) {
  std::vector<FloorPlans> ways{FloorPlans::none};
  if (spec.bounds) ways = {FloorPlans::with_their_bounds, FloorPlans::with_other_bounds, FloorPlans::none};
  Checks checks;
  checks.same_names = !has_repeated_names(spec);
  Attempt last;
  for (const bool overlaps_are_errors : {true, false})
    for (const FloorPlans way : ways) {
      checks.overlaps = overlaps_are_errors;
      last = attempt(spec, file, checks, way, registry, diagnostics.files());
      if (last.document) return std::move(last.document);
    }
  constexpr std::string_view k_what = "a JSON world cannot express this: ";
  for (const Finding& finding : last.findings)
    diagnostics.error(finding.where, fmt::format("{}{}", k_what, finding.message));
  if (last.findings.empty())
    diagnostics.error({diagnostics.files()->add(file.string()), 0},
                      fmt::format("{}{}", k_what, last.difference));
  return std::nullopt;
}

}  // namespace troupe::worldio
