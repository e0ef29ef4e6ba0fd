#pragma once

#include "base/ids.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::engine {

/// Type of the values of a field of the state (StateField). A bool is stored as a u8 with the value 0 or 1.
enum class Element : std::uint8_t {
  f64,  ///< double
  f32,  ///< float
  i64,  ///< std::int64_t
  i32,  ///< std::int32_t
  u64,  ///< std::uint64_t
  u32,  ///< std::uint32_t
  u8,   ///< std::uint8_t, bool
};
std::size_t element_size(Element element);       ///< size of a value, bytes: 8, 4 or 1
std::string_view element_name(Element element);  ///< name of the type in NumPy: "float64", "int32", ...

/// Returns the element type for a C++ type T. Does not compile unless T is one of the types listed at
/// Element.
template <class T>
constexpr Element element_of() {
  if constexpr (std::is_same_v<T, double>)
    return Element::f64;
  else if constexpr (std::is_same_v<T, float>)
    return Element::f32;
  else if constexpr (std::is_same_v<T, std::int64_t>)
    return Element::i64;
  else if constexpr (std::is_same_v<T, std::int32_t>)
    return Element::i32;
  else if constexpr (std::is_same_v<T, std::uint64_t>)
    return Element::u64;
  else if constexpr (std::is_same_v<T, std::uint32_t>)
    return Element::u32;
  else {
    static_assert(
        std::is_same_v<T, std::uint8_t> || std::is_same_v<T, bool>,
        "state fields must be double, float, a 32-bit or 64-bit integer, std::uint8_t or bool; store an "
        "enum as such an integer");
    return Element::u8;
  }
}

/// Calls visit(T()), where T is the C++ type of an element (std::uint8_t for Element::u8), and returns its
/// result.
template <class Visit>
decltype(auto) visit_element(Element element, Visit&& visit) {
  switch (element) {
    // NOLINTNEXTLINE(bugprone-branch-clone): the calls differ in the type of their argument
    case Element::f64: return visit(double());
    case Element::f32: return visit(float());
    case Element::i64: return visit(std::int64_t());
    case Element::i32: return visit(std::int32_t());
    case Element::u64: return visit(std::uint64_t());
    case Element::u32: return visit(std::uint32_t());
    case Element::u8: break;
  }
  return visit(std::uint8_t());
}
/// Returns the value whose bytes begin at `at`, as a double; integers of 64 bits are rounded.
inline double number_at(Element element, const std::byte* at) {
  return visit_element(element, [at](auto value) {
    std::memcpy(&value, at, sizeof value);
    return static_cast<double>(value);
  });
}
/// Converts the values whose bytes follow one another in `bytes` to doubles, as number_at() does. `into` must
/// have one element for each value.
void to_doubles(Element element, std::span<const std::byte> bytes, std::span<double> into);

/// A field of a state component (a StateTable): its name, element type, number of columns, unit and meaning.
struct StateField {
  std::string name = {};           ///< name, unique in the component
  Element element = Element::f64;  ///< type of the values
  std::uint32_t columns = 1;       ///< values per row
  std::string unit = {};           ///< unit of the values: "m", "rad/s"; empty: none
  std::string text = {};           ///< meaning, in one line, for documentation and recordings
  /// Offset of the field within a row, bytes. Used only in tables with StateTable::Layout::rows. If the rows
  /// are structs, it is the offset of the member in the struct. Otherwise the constructor of StateTable sets
  /// it.
  std::uint32_t offset = 0;
  /// True: the field adds nothing to the hash of a row in which all its bytes are 0. A new version of Troupe
  /// can thus add a field to the state without a change of the hashes of worlds that do not use the field.
  bool sparse = false;
  /// True: the appearance of a body depends on the field. A recording of poses therefore also contains the
  /// field.
  bool appearance = false;
  /// True: the values are bools. The element is u8, and each value is 0 or 1.
  bool is_bool = false;

  std::size_t bytes() const {
    return columns * element_size(element);
  }  ///< size of the values of a row, bytes
};

/// The field with this name; null if there is none. The result is an element of `fields`.
inline const StateField* field_named(std::span<const StateField> fields, std::string_view name) {
  const auto found = std::ranges::find(fields, name, &StateField::name);
  return found == fields.end() ? nullptr : &*found;
}

/// Whether two components have the same fields: equal names, element types and numbers of columns, in the
/// same order.
inline bool same_fields(std::span<const StateField> a, std::span<const StateField> b) {
  return std::ranges::equal(a, b, [](const StateField& x, const StateField& y) {
    return x.name == y.name && x.element == y.element && x.columns == y.columns;
  });
}
/// Returns a copy of `fields` in which StateField::sparse is true for every field.
std::vector<StateField> sparse(std::vector<StateField> fields);

/// Groups of state components (state tables). A hash log is a text file with hashes of the state after every
/// tick (docs/determinism.md). For each group it has one column: the sum of the hashes of the group's
/// components.
enum class HashGroup : std::uint8_t {
  pose,      ///< poses of bodies and joints, which body carries which, births and deaths
  velocity,  ///< velocities, commands to drives and devices, whether motions were blocked
  sensor,    ///< readings of sensors, and states of other devices
  memory,    ///< memories of controllers, odometry, disabled and faulty bodies
};
inline constexpr std::size_t k_hash_groups = 4;     ///< number of hash groups
std::string_view hash_group_name(HashGroup group);  ///< name of the group's column in a hash log

/// One component of the state of a world: a table with one row per body. Examples are `pose`, the poses of
/// the bodies, and `ranger/eye`, the readings of the sensors of kind `ranger` with the name `eye`. Some
/// tables have rows for the bodies of only one body type. A list of fields describes the columns of a table.
/// All code that allocates, hashes, stores or compares states uses this list, so that it leaves out no part
/// of the state.
///
/// There are two layouts: `columns` keeps each field contiguous, for loops that read one field of every
/// robot; `rows` keeps each row contiguous, for sensor readings and controller memories.
///
/// In the functions, `row` is the index of a row, and `field` is an index into fields(). T must be the C++
/// type of the field's values (StateField::element). None of this is checked.
class StateTable {
 public:
  /// Memory layout of the rows.
  enum class Layout : std::uint8_t {
    columns,  ///< field by field: each field has the values of all rows
    rows,     ///< row by row: each row has the values of all fields
  };

  StateTable() = default;  ///< a table without rows
  /// Makes a table with one row for each of `ids`. All bytes are 0.
  ///
  /// row_bytes: only used for Layout::rows. If it is greater than 0, each row is a struct of this size,
  /// bytes, with the fields at their offsets StateField::offset. If it is 0, the constructor computes the
  /// offsets and the size of a row.
  StateTable(std::string component, HashGroup group, Layout layout, std::vector<StateField> fields,
             std::vector<BodyId> ids, std::size_t row_bytes = 0);

  /// Name of the component, such as "pose" or "ranger/eye". Tables of different body types may have the same
  /// name.
  const std::string& component() const { return component_; }
  HashGroup group() const { return group_; }  ///< group of the component, which has a column in the hash log
  std::span<const StateField> fields() const { return fields_; }  ///< fields in declared order
  /// Number of rows, including those of bodies that are not yet in the world (unborn) and of dead bodies.
  std::size_t rows() const { return ids_.size(); }
  std::span<const BodyId> ids() const { return ids_; }  ///< body of each row

  /// The values of a field in all rows, ordered by row; a row has StateField::columns values. Layout::columns
  /// only.
  template <class T>
  std::span<T> column(std::size_t field) {
    return {reinterpret_cast<T*>(data_.data() + starts_[field]), rows() * fields_[field].columns};
  }
  /// The values of a field in all rows, ordered by row, read-only; Layout::columns only.
  template <class T>
  std::span<const T> column(std::size_t field) const {
    return {reinterpret_cast<const T*>(data_.data() + starts_[field]), rows() * fields_[field].columns};
  }
  /// The values of a field in one row (StateField::columns values); for both layouts.
  template <class T>
  std::span<T> cell(std::size_t row, std::size_t field) {
    return {reinterpret_cast<T*>(data_.data() + starts_[field] + row * strides_[field]),
            fields_[field].columns};
  }
  /// The values of a field in one row, read-only; for both layouts.
  template <class T>
  std::span<const T> cell(std::size_t row, std::size_t field) const {
    return {reinterpret_cast<const T*>(data_.data() + starts_[field] + row * strides_[field]),
            fields_[field].columns};
  }
  /// The value in one column of a field in one row, as number_at() returns it; for both layouts.
  double number(std::size_t row, std::size_t field, std::size_t column) const {
    const Element element = fields_[field].element;
    return number_at(element,
                     data_.data() + starts_[field] + row * strides_[field] + column * element_size(element));
  }
  /// Whether every value of the fields with StateField::is_bool is 0 or 1.
  bool bools_hold() const;
  /// Distance in memory between the values of a field in consecutive rows, bytes.
  std::size_t stride(std::size_t field) const { return strides_[field]; }
  /// Size of a row, including padding, bytes; Layout::rows only.
  std::size_t row_bytes() const { return row_bytes_; }
  /// Whether the rows have the size of T; Layout::rows only.
  template <class T>
  bool has_rows_of() const {
    return row_bytes_ == sizeof(T);
  }
  /// First byte of a row; Layout::rows only.
  std::byte* row(std::size_t row) { return data_.data() + row * row_bytes_; }
  /// First byte of a row, read-only; Layout::rows only.
  const std::byte* row(std::size_t row) const { return data_.data() + row * row_bytes_; }

  /// A row as the struct T; Layout::rows only. The size of T must be row_bytes(), and its members must be the
  /// fields of the table, at the same offsets. Neither is checked.
  template <class T>
  T& as(std::size_t r) {
    return *reinterpret_cast<T*>(row(r));
  }
  /// A row as the struct T, read-only; Layout::rows only.
  template <class T>
  const T& as(std::size_t r) const {
    return *reinterpret_cast<const T*>(row(r));
  }

  /// Hash of a row; it does not depend on the layout. It is the sum, modulo 2^64, of these hashes:
  /// - the hash of (component name, id of the body, all fields that are not sparse, in declared order),
  ///   unless all fields are sparse (StateField::sparse);
  /// - for each sparse field that is not zero, the hash of (component name, field name, id of the body,
  ///   field).
  std::uint64_t hash_row(std::size_t row) const { return hash_rows(row, row + 1); }
  /// Sum of the hashes of rows [first, last), modulo 2^64.
  std::uint64_t hash_rows(std::size_t first, std::size_t last) const;
  std::size_t bytes() const { return data_.size(); }  ///< size of data(), bytes
  /// The memory of all rows, including padding and memory that is reserved for more rows (change_capacity()).
  std::span<std::byte> data() { return data_; }
  /// Sets every byte of all rows to 0, as in a new table.
  void clear() { std::ranges::fill(data_, std::byte{0}); }
  /// Sets every byte of a row's fields to 0. Padding between the fields does not change.
  void clear_row(std::size_t row) { fill_row(row, std::byte{0}); }
  void fill_row(std::size_t row, std::byte value);  ///< sets every byte of a row's fields to `value`
  /// Overwrites the fields of a row with those of the row of the same index in the table `from`, which must
  /// have the same fields and layout.
  void copy_row(std::size_t row, const StateTable& from);
  /// Gives the table memory for at least `rows` rows, and frees memory if too much of it is unused
  /// (capacity_for() in base/capacity.hpp). `rows` must be at least rows(). Earlier pointers and spans into
  /// the table may become invalid.
  void change_capacity(std::size_t rows);
  /// add_rows() adds a row at the end for each of the bodies `ids`, with all fields 0. The table must already
  /// have memory for these rows, see change_capacity(). keep_rows() removes rows from the end, so that
  /// `count` rows remain; `count` must not exceed rows().
  ///@{
  void add_rows(std::span<const BodyId> ids);
  void keep_rows(std::size_t count) { ids_.resize(count); }
  ///@}
  /// Moves each row r, with its body, to the row to[r]. `to` must contain each number below rows() exactly
  /// once.
  void move_rows(std::span<const std::uint32_t> to);

 private:
  std::size_t lay_out();
  /// Sum, over the rows [first, last), of the hashes of the fields that are not sparse.
  std::uint64_t hash_dense(std::size_t first, std::size_t last) const;

  std::string component_;
  HashGroup group_ = HashGroup::pose;
  Layout layout_ = Layout::columns;
  std::vector<StateField> fields_;
  std::vector<BodyId> ids_;
  std::size_t room_ = 0;              // number of rows for which data_ has memory
  std::vector<std::size_t> starts_;   // one per field: its offset in row 0, bytes
  std::vector<std::size_t> strides_;  // one per field: distance between rows, bytes
  std::size_t row_bytes_ = 0;
  std::size_t hashed_bytes_ = 0;
  struct Stretch {  // fields of a row that are adjacent both in memory and in the hashed sequence
    std::size_t start;
    std::size_t stride;
    std::size_t bytes;
  };
  std::vector<Stretch> stretches_;
  struct Sparse {  // one sparse field
    Stretch place;
    std::uint64_t seed;
    std::uint64_t hash_rows(std::span<const BodyId> ids, const std::byte* data, std::size_t first,
                            std::size_t last) const;
  };
  std::vector<Sparse> sparse_;
  std::uint64_t component_hash_ = 0;
  std::vector<std::byte> data_;
};

/// Returns the short name of a component, which contains the name that the world file gives the device or
/// joint:
/// - In general, it is the part after the first slash: `ir` for `ranger/ir`, `arm` for `joint/arm`, and
///   `lamp/command` for `led/lamp/command` (the commands to the device `lamp`).
/// - For a component `sensors/TYPE/NAME` of a recording, it is NAME: `eye` for `sensors/minibot/eye`.
/// - If the name of the component has no slash (`pose`), or if only a number follows the slash (`wander/0`,
///   the memory of a controller), it is the whole name.
std::string_view given_name(std::string_view component);
/// Whether a name that a user gives, for example as a field to record, selects a component. A component has
/// three such names: its whole name (`ranger/ir`), its given_name() (`ir`), and its kind, which is the part
/// before the first slash (`ranger`).
bool selects(std::string_view name, std::string_view component);

}  // namespace troupe::engine
