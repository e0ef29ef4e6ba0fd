#pragma once

#include "base/ids.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::engine {

/// What state is made of; element_name() as NumPy calls it. A bool is a u8 of 0 or 1.
enum class Element : std::uint8_t {
  f64,  ///< double
  f32,  ///< float
  i64,  ///< std::int64_t
  i32,  ///< std::int32_t
  u64,  ///< std::uint64_t
  u32,  ///< std::uint32_t
  u8,   ///< std::uint8_t, bool
};
std::size_t element_size(Element element);       ///< bytes: 8, 4 or 1
std::string_view element_name(Element element);  ///< "float64", "int32", "uint8", ...

/// The element that holds a T; any type without one does not compile.
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
    static_assert(std::is_same_v<T, std::uint8_t> || std::is_same_v<T, bool>,
                  "state is made of float64, float32, integers and bool; no pointers, no nested types");
    return Element::u8;
  }
}

/// One array of the state: name, element type, columns a row, unit and meaning.
struct StateField {
  std::string name;                ///< of the component, unique there
  Element element = Element::f64;  ///< of each column
  std::uint32_t columns = 1;       ///< numbers a row
  std::string unit;                ///< "m", "rad/s"; empty: none
  std::string text;                ///< what it is, one line for `troupe describe` and recordings
  std::uint32_t offset = 0;        ///< within a row, bytes; set by the table unless `packed` by a struct
  /// Optional state: where it is zero, byte for byte, the hash is that of an entity without it. So a world
  /// that does not use it keeps the hashes it had before there was such a field.
  bool sparse = false;
  /// It says how a body looks, beside where it is, and is recorded wherever poses are.
  bool look = false;
};
/// The fields of a component that is optional as a whole: a row that is all zero adds nothing to the hash.
std::vector<StateField> sparse(std::vector<StateField> fields);

/// Which of the hash log's columns a component adds to.
enum class HashGroup : std::uint8_t {
  pose,      ///< where bodies and joints are, who carries whom, who lives
  velocity,  ///< velocities, what is asked of drives and devices, stalls
  sensor,    ///< readings, and the state of other devices
  memory,    ///< of controllers; odometry; what keeps bodies from working
};
inline constexpr std::size_t k_hash_groups = 4;     ///< values of HashGroup
std::string_view hash_group_name(HashGroup group);  ///< the column's name in a hash log

/// The state of one component: a row an entity. From its description come allocation, hash and everything
/// that reads state without knowing it, so that a new array cannot be forgotten by the determinism tests.
///
/// Two layouts: `columns` keeps each field contiguous (for loops that read one field of every robot);
/// `rows` keeps each row contiguous (sensor readings, controller memories).
class StateTable {
 public:
  /// How rows lie in memory.
  enum class Layout : std::uint8_t {
    columns,  ///< a field of all rows, then the next field
    rows,     ///< a row with all of its fields, then the next row
  };

  StateTable() = default;  ///< of no rows
  /// With Layout::rows and row_bytes > 0 the fields' offsets are those of a struct of that size.
  StateTable(std::string component, HashGroup group, Layout layout, std::vector<StateField> fields,
             std::vector<BodyId> ids, std::size_t row_bytes = 0);

  /// Its name, unique in a world: "pose", "ranger/0".
  const std::string& component() const { return component_; }
  HashGroup group() const { return group_; }                      ///< the hash log's column that it adds to
  std::span<const StateField> fields() const { return fields_; }  ///< in declared order
  std::size_t rows() const { return ids_.size(); }                ///< how many there are, there or not
  std::span<const BodyId> ids() const { return ids_; }            ///< of the rows' entities, beside them

  /// One field of every row; Layout::columns only.
  template <class T>
  std::span<T> column(std::size_t field) {
    return {reinterpret_cast<T*>(data_.data() + starts_[field]), rows() * fields_[field].columns};
  }
  /// To read.
  template <class T>
  std::span<const T> column(std::size_t field) const {
    return {reinterpret_cast<const T*>(data_.data() + starts_[field]), rows() * fields_[field].columns};
  }
  /// One field of one row, either layout.
  template <class T>
  std::span<T> cell(std::size_t row, std::size_t field) {
    return {reinterpret_cast<T*>(data_.data() + starts_[field] + row * strides_[field]),
            fields_[field].columns};
  }
  /// To read.
  template <class T>
  std::span<const T> cell(std::size_t row, std::size_t field) const {
    return {reinterpret_cast<const T*>(data_.data() + starts_[field] + row * strides_[field]),
            fields_[field].columns};
  }
  /// From one row of a field to the next, bytes.
  std::size_t stride(std::size_t field) const { return strides_[field]; }
  /// The bytes of a row; Layout::rows only.
  std::size_t row_bytes() const { return row_bytes_; }
  /// Its first byte; Layout::rows only.
  std::byte* row(std::size_t row) { return data_.data() + row * row_bytes_; }
  /// Its first byte; Layout::rows only.
  const std::byte* row(std::size_t row) const { return data_.data() + row * row_bytes_; }

  /// A row that is a struct (memory_fields); Layout::rows only.
  template <class T>
  T& as(std::size_t r) {
    return *reinterpret_cast<T*>(row(r));
  }
  /// To read.
  template <class T>
  const T& as(std::size_t r) const {
    return *reinterpret_cast<const T*>(row(r));
  }

  /// Hash of (component name, id, fields in declared order), and of (component and field name, id, field) for
  /// each sparse field that is not zero; equal rows of equal entities hash alike whatever the layout.
  std::uint64_t hash_row(std::size_t row) const { return hash_rows(row, row + 1); }
  /// The sum of the hashes of rows [first, last), modulo 2^64.
  std::uint64_t hash_rows(std::size_t first, std::size_t last) const;
  std::size_t bytes() const { return data_.size(); }  ///< of all rows, padding included
  /// Every byte 0 again, as in a new table.
  void clear() { std::ranges::fill(data_, std::byte{0}); }
  void clear_row(std::size_t row);  ///< every byte of one row 0 again, either layout

 private:
  /// What the fields that are not sparse add.
  std::uint64_t hash_dense(std::size_t first, std::size_t last) const;

  std::string component_;
  HashGroup group_ = HashGroup::pose;
  Layout layout_ = Layout::columns;
  std::vector<StateField> fields_;
  std::vector<BodyId> ids_;
  std::vector<std::size_t> starts_;   // of row 0, bytes
  std::vector<std::size_t> strides_;  // between rows, bytes
  std::size_t row_bytes_ = 0;
  std::size_t hashed_bytes_ = 0;
  struct Stretch {  // of a row: fields that follow one another in memory as they do in the hash
    std::size_t start;
    std::size_t stride;
    std::size_t bytes;
  };
  std::vector<Stretch> stretches_;
  struct Sparse {  // a field of its own
    Stretch place;
    std::uint64_t seed;
    std::uint64_t hash_rows(std::span<const BodyId> ids, const std::byte* data, std::size_t first,
                            std::size_t last) const;
  };
  std::vector<Sparse> sparse_;
  std::uint64_t component_hash_ = 0;
  std::vector<std::byte> data_;
};

}  // namespace troupe::engine
