#include "base/diagnostics.hpp"
#include "engine/observing/sensed_rows.hpp"
#include "engine/world/world.hpp"
#include "python/bindings.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace troupe::python {
namespace {

using engine::Element;
using engine::StateField;
using engine::StateTable;

/// A state table, for Python. It keeps its simulation alive. It stores a pointer, because the address of a
/// table does not change while the simulation lives.
struct Table {
  Holder held;
  const StateTable* table;

  /// Returns the name of the type of the bodies; empty if they are of several types. Reads all rows.
  std::string type() const {
    const engine::World& world = held->use().world();
    std::string type;
    for (const BodyId body : table->ids()) {
      const std::string& own = world.view().type(world.view().row(body)).name;
      if (type.empty()) type = own;
      if (type != own) return {};
    }
    return type;
  }
  py::array field(const std::string& name) const {
    held->use().world().require_whole();
    const std::span<const StateField> fields = table->fields();
    std::vector<std::string_view> known;
    for (std::size_t f = 0; f < fields.size(); ++f) {
      known.push_back(fields[f].name);
      if (fields[f].name == name) return view_of(f);
    }
    throw std::out_of_range(unknown_name("field of " + given(), name, known));
  }
  std::vector<std::string> field_names() const {
    std::vector<std::string> names;
    for (const StateField& field : table->fields()) names.push_back(field.name);
    return names;
  }
  std::string given() const { return std::string(engine::given_name(table->component())); }
  /// Whether the values of all rows exist: false if the table has readings of a sensor that does not run.
  bool runs() const {
    const engine::CommittedView& view = held->use().world().view();
    return engine::SensedRows(view, *table).all_exist(view);
  }

 private:
  py::array view_of(std::size_t f) const {
    const StateField& field = table->fields()[f];
    const py::dtype element = dtype_of(field.element);
    std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(table->rows())};
    std::vector<py::ssize_t> strides{static_cast<py::ssize_t>(table->stride(f))};
    if (field.columns > 1) {
      shape.push_back(field.columns);
      strides.push_back(element.itemsize());
    }
    py::array whole =
        view(element, std::move(shape), std::move(strides), table->cell<std::byte>(0, f).data(), held);
    const bool is_real = field.element == Element::f64 || field.element == Element::f32;
    return is_real && !runs() ? with_nan(whole) : whole;
  }

  /// Returns a read-only copy of a field of floating-point numbers, with NaN where no reading exists.
  py::array with_nan(const py::array& whole) const {
    py::array copy = py::module_::import("numpy").attr("array")(whole);
    const engine::CommittedView& view = held->use().world().view();
    const engine::SensedRows readings(view, *table);
    for (std::size_t row = 0; row < table->rows(); ++row)
      if (!readings.exist(view, row)) copy[py::int_(row)] = std::numeric_limits<double>::quiet_NaN();
    copy.attr("setflags")(py::arg("write") = false);
    return copy;
  }
};

std::vector<Table> tables_of(const Holder& held) {
  const engine::World& world = held->use().world();
  std::vector<Table> tables;
  for (const StateTable& table : world.tables())
    if (table.rows() > 0) tables.push_back({held, &table});
  return tables;
}

/// Throws std::out_of_range if the world has no type of this name.
void require_type(const engine::World& world, const std::string& name) {
  std::vector<std::string_view> known;
  for (const engine::BodyType& type : world.view().types())
    if (!type.name.empty()) known.push_back(type.name);
  if (std::ranges::find(known, name) == known.end())
    throw std::out_of_range(unknown_name("type", name, std::move(known)));
}

/// The table of one component. component: the name that the world gives to the component, or its name in the
/// state.
Table table_of(const Holder& held, const std::string& component, const std::string& type) {
  std::vector<Table> found;
  const std::vector<Table> all = tables_of(held);
  if (!type.empty()) require_type(held->use().world(), type);
  const bool is_whole =
      std::ranges::any_of(all, [&](const Table& table) { return table.table->component() == component; });
  const auto has_type = [&type](const Table& table) { return type.empty() || table.type() == type; };
  for (const Table& table : all)
    if ((is_whole ? table.table->component() : table.given()) == component && has_type(table))
      found.push_back(table);
  if (found.size() == 1) return found.front();
  if (found.empty()) {
    std::vector<std::string> names;
    for (const Table& table : all)
      if (has_type(table) && std::ranges::find(names, table.given()) == names.end())
        names.push_back(table.given());
    std::vector<std::string_view> known(names.begin(), names.end());
    const std::string what = type.empty() ? "component" : fmt::format("component of type {}", type);
    throw std::out_of_range(unknown_name(what, component, std::move(known)));
  }
  std::vector<std::string_view> components;
  for (const Table& table : found)
    if (std::ranges::find(components, table.table->component()) == components.end())
      components.emplace_back(table.table->component());
  if (components.size() > 1)
    throw std::invalid_argument(fmt::format(
        "the name {1} stands for {0} components; use the name that belongs to only one of them: {2}",
        components.size(), component, comma_list(components)));
  std::vector<std::string> names;
  for (const Table& table : found) names.push_back(table.type());
  const std::vector<std::string_view> types(names.begin(), names.end());
  throw std::invalid_argument(
      fmt::format("robots of {1} types have the component {0}; give the parameter `type`: one of {2}",
                  component, types.size(), comma_list(types)));
}

}  // namespace

py::dtype dtype_of(Element element) {
  return engine::visit_element(element, []<class T>(T) { return py::dtype::of<T>(); });
}

void bind_tables(py::module_& module, SimulationClass& simulation) {
  py::class_<StateField>(module, "Field",
                         "A field of a component of the state: name, number of columns, unit, text (a "
                         "description) and dtype (NumPy type).")
      .def_readonly("name", &StateField::name)
      .def_readonly("columns", &StateField::columns)
      .def_readonly("unit", &StateField::unit)
      .def_readonly("text", &StateField::text)
      .def_property_readonly("dtype", [](const StateField& field) { return dtype_of(field.element); })
      .def("__repr__", [](const StateField& field) {
        return fmt::format("<Field {}: {} x {}{}{}>", field.name, engine::element_name(field.element),
                           field.columns, field.unit.empty() ? "" : ", ", field.unit);
      });

  py::class_<Table>(
      module, "Table",
      "A component of the state, such as the poses or the readings of one sensor: a table with one row for "
      "each body that has\nsuch data. table[\"ranges\"] is one field of it: a read-only array that refers to "
      "the memory of the simulation, so that\nits content changes with each step. Rows are in the order of "
      "storage, not of ids; ids[i] is the id of the body in row i.\nFor a sensor that does not run (`runs`), "
      "a field of floating-point numbers is a copy instead, with NaN where there is no\nreading.")
      .def_property_readonly(
          "component", [](const Table& t) { return t.table->component(); },
          "Name of the component in the state, such as \"ranger/ir\".")
      .def_property_readonly(
          "name", [](const Table& t) { return t.given(); },
          "Name that the world gives the component, such as \"ir\".")
      .def_property_readonly(
          "runs", [](const Table& t) { return t.runs(); },
          "False if the table has the readings of a sensor that does not run on one or more robots. A sensor "
          "does not run on a\nrobot if no controller uses it, the world file makes it inactive (\"active\": "
          "false in JSON, no `alwayson 1` in a .world\nfile), and subscribe() was not called for the robot. "
          "True for all other tables.")
      .def_property_readonly(
          "type", [](const Table& t) { return t.type(); },
          "Name of the type of the bodies; empty if they are of several types.")
      .def_property_readonly("fields",
                             [](const Table& t) {
                               return std::vector<StateField>(t.table->fields().begin(),
                                                              t.table->fields().end());
                             })
      .def_property_readonly("ids",
                             [](const Table& t) {
                               static_assert(sizeof(BodyId) == sizeof(std::uint32_t));
                               return view(py::dtype::of<std::uint32_t>(),
                                           {static_cast<py::ssize_t>(t.table->rows())}, {sizeof(BodyId)},
                                           t.table->ids().data(), t.held);
                             })
      .def("__getitem__", &Table::field, py::arg("field"))
      .def("keys", &Table::field_names,
           "Names of the fields; dict(table) is a dict from these names to the fields.")
      .def("__iter__", [](const Table& t) { return py::iter(py::cast(t.field_names())); })
      .def("__len__", [](const Table& t) { return t.table->rows(); })
      .def("__repr__", [](const Table& t) {
        return fmt::format("<Table {}: {} rows{}>", t.given(), t.table->rows(),
                           t.runs() ? "" : "; the sensor does not run on all robots");
      });

  simulation
      .def("tables", &tables_of,
           "All tables of the state that have rows, one per component and, for devices and controllers, per "
           "type of robot.")
      .def("table", &table_of, py::arg("component"), py::arg("type") = "",
           "The table of one component: component is its name in the state, such as \"pose\" or "
           "\"ranger/ir\", or the name that the\n"
           "world gives it, such as \"ir\" for a device of this name. If several types of robots have this "
           "component, `type` must\n"
           "name one of them. Raises LookupError, whose text lists the known names, for an unknown component "
           "or type, and\n"
           "ValueError if several tables fit.");
}

}  // namespace troupe::python
