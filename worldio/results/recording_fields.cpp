#include "worldio/results/recording_fields.hpp"

#include "base/split.hpp"
#include "engine/spec/names.hpp"
#include "engine/world/state_tables.hpp"
#include "worldio/files.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <utility>

namespace troupe::worldio {
namespace {

using engine::BodyType;
using engine::HashGroup;
using engine::StateTable;
using engine::World;

/// Whether a name of --record-fields chooses all fields of a table. True if the name is "all" or selects the
/// component of the table (engine::selects()). The name "pose" also chooses the displacements of joints,
/// without which moving parts cannot be drawn. chosen_fields() handles the names of single fields.
bool chooses(const std::string& name, const StateTable& table) {
  const std::string_view component = table.component();
  return name == "all" || engine::selects(name, component) ||
         (name == "pose" && component.starts_with("joint/"));
}

/// Whether a name of --record-fields chooses one field of a table: it is `COMPONENT.FIELD`, as in
/// `lamp.shows`.
bool chooses_field(std::string_view name, const StateTable& table, std::string_view field) {
  const std::size_t dot = name.rfind('.');
  return dot != name.npos && name.substr(dot + 1) == field &&
         engine::selects(name.substr(0, dot), table.component());
}

/// Returns the frame of the values of a table: RecordedComponent::frame.
std::string frame_of_table(const StateTable& table) {
  if (table.component().starts_with("joint/")) return "joint";
  if (table.component() == "carrier") return "carrier";
  switch (table.group()) {
    case HashGroup::pose: return "world";
    case HashGroup::velocity: return "body";
    case HashGroup::sensor: return "sensor";
    case HashGroup::memory: break;
  }
  return "";
}

/// Returns the indices of the fields of a table that the names choose.
std::vector<std::size_t> chosen_fields(const StateTable& table, std::span<const std::string> names) {
  std::vector<std::size_t> fields;
  for (std::size_t f = 0; f < table.fields().size(); ++f) {
    const bool chosen = std::ranges::any_of(names, [&](const std::string& name) {
      const engine::StateField& field = table.fields()[f];
      return chooses(name, table) || chooses_field(name, table, field.name) ||
             (table.group() == HashGroup::sensor &&
              (name == field.name || (name == "pose" && field.appearance)));
    });
    if (chosen) fields.push_back(f);
  }
  return fields;
}

/// Returns the path of a component in /state, as steps from the root of the file.
std::vector<std::string> steps_of(std::string_view component) {
  std::vector<std::string> steps{"state"};
  for (const std::string_view step : split(component, '/')) steps.push_back(hdf5_name(step));
  return steps;
}

RecordedComponent component_of(const StateTable& table, std::vector<std::string> path,
                               std::vector<std::size_t> columns, std::size_t rows) {
  RecordedComponent component{.path = std::move(path),
                              .name = table.component(),
                              .frame = frame_of_table(table),
                              .rows = rows,
                              .columns = std::move(columns)};
  for (const std::size_t column : component.columns) component.fields.push_back(table.fields()[column]);
  return component;
}

/// Whether a component has the name of a table and the chosen `fields` of this table, so that the rows of the
/// table belong in it. The numbers of columns may differ: they can depend on a parameter of the type.
bool has_fields_of(const RecordedComponent& component, const StateTable& table,
                   const std::vector<std::size_t>& fields) {
  if (component.name != table.component() || component.columns != fields) return false;
  for (std::size_t f = 0; f < fields.size(); ++f) {
    const engine::StateField& field = table.fields()[fields[f]];
    if (component.fields[f].name != field.name || component.fields[f].element != field.element) return false;
  }
  return true;
}

/// Gives each field of a component at least as many columns as the field has in a table.
void widen(RecordedComponent& component, const StateTable& table) {
  for (std::size_t f = 0; f < component.fields.size(); ++f)
    component.fields[f].columns =
        std::max(component.fields[f].columns, table.fields()[component.columns[f]].columns);
}

/// For each body of a world, by BodyId, its row in a recorded component: RecordedComponent::Source::recorded.
using RecordedRows = std::shared_ptr<const std::vector<std::uint32_t>>;

/// Returns, for each of `bodies`, its index in this list or, if `of_type` is true, its index among the bodies
/// of its type in this list. `bodies` must be in the order of ids.
RecordedRows recorded_rows(const World& world, std::span<const BodyId> bodies, bool of_type) {
  std::vector<std::uint32_t> rows(world.spec().bodies.size());
  std::vector<std::uint32_t> counts(world.view().types().size(),
                                    0);  // if not `of_type`, only the first is used
  for (const BodyId id : bodies)
    rows[id.index()] = counts[of_type ? world.spec().bodies[id.index()].type.index() : 0]++;
  return std::make_shared<const std::vector<std::uint32_t>>(std::move(rows));
}

/// Adds the sensors of each type as components of their own, because the number of readings differs between
/// types.
void add_sensors(const World& world, std::span<const BodyId> bodies, std::span<const std::string> names,
                 std::vector<RecordedComponent>& components) {
  const RecordedRows recorded = recorded_rows(world, bodies, true);
  const std::vector<std::string> type_names = recorded_type_names(world);
  for (std::size_t t = 0; t < world.view().types().size(); ++t) {
    for (const BodyType::Device& sensor : world.view().types()[t].devices) {
      const StateTable& table = world.tables()[sensor.table];
      if (sensor.table == 0) continue;  // a type without bodies has no tables
      std::vector<std::size_t> fields = chosen_fields(table, names);
      if (fields.empty()) continue;
      components.push_back(component_of(table, {"sensors", type_names[t], hdf5_name(sensor.name)},
                                        std::move(fields), table.rows()));
      components.back().sources.push_back(
          {sensor.table, recorded, sensor.kind->is_sensor() ? &sensor : nullptr});
    }
  }
}

/// Overwrites the values of bodies that are not in the world, and the readings of sensors that do not run
/// because they are inactive and not read (CommittedView::senses()), with absent().
void leave_out_absent(const World& world, const RecordedComponent& component,
                      const RecordedComponent::Source& source, std::span<const std::span<std::byte>> fields) {
  const StateTable& table = world.tables()[source.table];
  for (std::size_t r = 0; r < table.rows(); ++r) {
    const Row row = world.view().row(table.ids()[r]);
    if (world.view().is_there(row) && (!source.sensor || world.view().senses(row, *source.sensor))) continue;
    for (std::size_t f = 0; f < component.fields.size(); ++f) {
      const engine::StateField& field = component.fields[f];
      const std::size_t width = field.bytes();
      const std::size_t recorded = (*source.recorded)[table.ids()[r].index()];
      std::ranges::fill(fields[f].subspan(width * recorded, width), absent(field));
    }
  }
}

}  // namespace

std::size_t RecordedComponent::bytes(std::size_t field) const { return rows * fields[field].bytes(); }

std::vector<BodyId> recorded_bodies(const World& world) {
  std::vector<BodyId> bodies;
  bodies.reserve(world.view().rows());
  for (std::size_t r = 0; r < world.view().rows(); ++r) bodies.push_back(world.view().body(Row(r)));
  std::ranges::sort(bodies);
  return bodies;
}

std::vector<std::string> recorded_type_names(const World& world) {
  engine::UniqueNames unique("~");
  std::vector<std::string> names;
  for (const BodyType& type : world.view().types()) names.push_back(unique.add(hdf5_name(type.name)));
  return names;
}

std::vector<std::string> recordable_names(const World& world) {
  std::vector<std::string> names{"all"};
  const auto add = [&names](std::string_view name) {
    if (std::ranges::find(names, name) == names.end()) names.emplace_back(name);
  };
  const auto add_names = [&add](std::span<const StateTable> tables) {
    for (const StateTable& table : tables)
      if (table.group() == HashGroup::sensor)
        for (const engine::StateField& field : table.fields()) add(field.name);
      else
        add(std::string_view(table.component()).substr(0, table.component().find('/')));
    for (const StateTable& table : tables) {
      add(std::string_view(table.component()).substr(0, table.component().find('/')));
      add(engine::given_name(table.component()));
    }
  };
  add_names(world.tables());
  add_names(engine::unused_tables(world.state()));
  return names;
}

std::optional<std::string> name_for_path(const World& world, std::string_view name) {
  constexpr std::string_view k_sensors = "sensors/";
  if (name.starts_with(k_sensors)) name.remove_prefix(k_sensors.size());
  const std::vector<std::string> type_names = recorded_type_names(world);
  for (std::size_t t = 0; t < type_names.size(); ++t) {
    const std::string& type = type_names[t];
    if (!name.starts_with(type) || name.size() == type.size() || name[type.size()] != '/') continue;
    const std::string_view rest = name.substr(type.size() + 1);
    for (const BodyType::Device& device : world.view().types()[t].devices) {
      if (rest == device.name) return device.name;
      if (!rest.starts_with(device.name)) continue;
      const char separator = rest[device.name.size()];
      const std::string_view field = rest.substr(device.name.size() + 1);
      const std::vector<engine::StateField>& fields = device.prepared.percepts;
      if ((separator == '.' || separator == '/') &&
          engine::field_named(fields, field.substr(0, field.find('.'))) != nullptr)
        return fmt::format("{}.{}", device.name, field);
    }
  }
  return std::nullopt;
}

std::string wrong_spelling(std::string_view what, std::string_view name, std::string_view right) {
  return fmt::format("unknown {} \"{}\": write \"{}\" instead", what, name, right);
}

namespace {

/// Throws std::invalid_argument if one of `names` selects nothing that can be recorded.
void require_recordable(const World& world, std::span<const std::string> names) {
  const std::vector<std::string> known = recordable_names(world);
  const std::vector<StateTable> unused = engine::unused_tables(world.state());
  for (const std::string& name : names) {
    const auto is_chosen_from = [&name](const StateTable& table) {
      return !chosen_fields(table, std::span(&name, 1)).empty();
    };
    if (std::ranges::find(known, name) == known.end() &&
        std::ranges::none_of(world.tables(), is_chosen_from) &&
        std::ranges::none_of(unused, is_chosen_from)) {
      if (const auto right = name_for_path(world, name))
        throw std::invalid_argument(wrong_spelling("field", name, *right));
      throw std::invalid_argument(unknown_name("field", name, {known.begin(), known.end()}));
    }
  }
}

/// Sets RecordedComponent::has of a component whose tables lack bodies. recorded: rows of all bodies
void mark_bodies(const World& world, const RecordedRows& recorded, RecordedComponent& component) {
  std::size_t rows = 0;
  for (const RecordedComponent::Source& source : component.sources)
    rows += world.tables()[source.table].rows();
  if (rows == component.rows) return;
  component.has.assign(component.rows, 0);
  for (const RecordedComponent::Source& source : component.sources)
    for (const BodyId id : world.tables()[source.table].ids()) component.has[(*recorded)[id.index()]] = 1;
}

}  // namespace

std::vector<RecordedComponent> recorded_components(const World& world, std::span<const std::string> names) {
  require_recordable(world, names);
  const std::vector<BodyId> bodies = recorded_bodies(world);
  const RecordedRows recorded = recorded_rows(world, bodies, false);
  std::vector<RecordedComponent> components;
  for (std::size_t t = 0; t < world.tables().size(); ++t) {
    const StateTable& table = world.tables()[t];
    if (table.group() == HashGroup::sensor) continue;
    std::vector<std::size_t> fields = chosen_fields(table, names);
    if (fields.empty()) continue;
    auto component = std::ranges::find_if(
        components, [&](const RecordedComponent& other) { return has_fields_of(other, table, fields); });
    if (component == components.end()) {
      std::vector<std::string> path = steps_of(table.component());
      const auto n = std::ranges::count(components, table.component(), &RecordedComponent::name);
      if (n > 0) path.back() += fmt::format("~{}", n + 1);
      component = components.insert(components.end(),
                                    component_of(table, std::move(path), std::move(fields), bodies.size()));
    }
    widen(*component, table);
    component->sources.push_back({t, recorded});
  }
  for (RecordedComponent& component : components) mark_bodies(world, recorded, component);
  add_sensors(world, bodies, names, components);
  return components;
}

std::string_view frame_of(const RecordedComponent& component, const engine::StateField& field) {
  return field.text.find("world frame") == field.text.npos ? std::string_view(component.frame) : "world";
}

void check_recording_file(const engine::RecordSpec& record, Diagnostics& diagnostics) {
  const std::filesystem::path file = record.file;
  if (has_ending_of_other_format(file))
    diagnostics.error(record.where, fmt::format("/record/file: must be the name of an HDF5 file, such as "
                                                "\"run.h5\", found \"{}\"",
                                                record.file));
  if (file.is_absolute() || std::ranges::find(file, "..") != file.end()) {
    diagnostics.error(record.where,
                      fmt::format("/record/file: must be a file in or below the working folder (no leading "
                                  "\"/\", no \"..\"), found \"{}\"; --record may name any file",
                                  record.file));
    return;
  }
  if (file.empty()) return;  // the world names no file
  const std::filesystem::path resolved = resolved_path(file);
  const std::filesystem::path folder = resolved_path(".");
  if (std::ranges::mismatch(folder, resolved).in1 == folder.end()) return;
  diagnostics.error(
      record.where,
      fmt::format("/record/file: must be a file in or below the working folder, but \"{}\" is {}, "
                  "because of a symbolic link; --record may name any file",
                  record.file, resolved.string()));
}

std::string join_field_names(std::span<const std::string> names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += ',';
    for (const char c : names[i]) {
      if (c == ',' || c == '\\') text += '\\';
      text += c;
    }
  }
  return text;
}

std::vector<std::string> split_field_names(std::string_view text) {
  std::vector<std::string> names;
  if (!text.empty()) names.emplace_back();
  for (std::size_t i = 0; i < text.size(); ++i) {
    // Earlier versions wrote no backslash before a backslash: one before another character is part of a name.
    const bool is_escape =
        text[i] == '\\' && i + 1 < text.size() && (text[i + 1] == ',' || text[i + 1] == '\\');
    if (is_escape)
      names.back() += text[++i];
    else if (text[i] == ',')
      names.emplace_back();
    else
      names.back() += text[i];
  }
  return names;
}

std::byte absent(const engine::StateField& field) {
  using engine::Element;
  return field.element == Element::f64 || field.element == Element::f32 ? std::byte{0xff} : std::byte{0};
}

void gather(const World& world, const RecordedComponent& component,
            std::span<const std::span<std::byte>> fields) {
  thread_local std::vector<std::uint32_t> rows;  // reused, because this is called for every frame
  for (const RecordedComponent::Source& source : component.sources) {
    const StateTable& table = world.tables()[source.table];
    rows.clear();
    for (const BodyId id : table.ids()) rows.push_back((*source.recorded)[id.index()]);
    for (std::size_t f = 0; f < component.fields.size(); ++f) {
      const std::size_t element = engine::element_size(component.fields[f].element);
      const std::size_t width = element * component.fields[f].columns;
      const std::size_t own = element * table.fields()[component.columns[f]].columns;  // at most `width`
      const std::size_t stride = table.stride(component.columns[f]);
      if (table.rows() == 0 || own == 0) continue;
      const std::byte* from = table.cell<std::byte>(0, component.columns[f]).data();
      std::byte* const into = fields[f].data();
      if (width == 8 && own == 8) {  // one number per row: a loop of its own, since others are rare or long
        for (const std::uint32_t row : rows) {
          std::memcpy(into + std::size_t{8} * row, from, 8);
          from += stride;
        }
      } else {
        for (const std::uint32_t row : rows) {
          std::memcpy(into + width * row, from, own);
          from += stride;
        }
      }
    }
    const bool may_rest = source.sensor && !source.sensor->active;
    if ((world.view().absent_count() > 0 || may_rest) &&
        component.name != "life")  // `life` itself lists absent bodies
      leave_out_absent(world, component, source, fields);
  }
}

}  // namespace troupe::worldio
