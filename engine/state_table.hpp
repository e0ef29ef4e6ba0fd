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

enum class Element : std::uint8_t { f64, f32, i64, i32, u64, u32, u8 };
std::size_t element_size(Element element);
std::string_view element_name(Element element);

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
  std::string name;
  Element element = Element::f64;
  std::uint32_t columns = 1;
  std::string unit;
  std::string text;
  std::uint32_t offset = 0;  ///< within a row, bytes; set by the table unless `packed` by a struct
  /// Optional state: where it is zero, byte for byte, the hash is that of an entity without it. So a world
  /// that does not use it keeps the hashes it had before there was such a field.
  bool sparse = false;
};
/// The fields of a component that is optional as a whole: a row that is all zero adds nothing to the hash.
std::vector<StateField> sparse(std::vector<StateField> fields);

/// Which of the hash log's columns a component adds to.
enum class HashGroup : std::uint8_t { pose, velocity, sensor, memory };
inline constexpr std::size_t k_hash_groups = 4;
std::string_view hash_group_name(HashGroup group);

/// The state of one component: a row an entity. From its description come allocation, hash and everything
/// that reads state without knowing it, so that a new array cannot be forgotten by the determinism tests.
///
/// Two layouts: `columns` keeps each field contiguous (for loops that read one field of every robot);
/// `rows` keeps each row contiguous (sensor readings, controller memories).
class StateTable {
 public:
  enum class Layout : std::uint8_t { columns, rows };

  StateTable() = default;
  /// With Layout::rows and row_bytes > 0 the fields' offsets are those of a struct of that size.
  StateTable(std::string component, HashGroup group, Layout layout, std::vector<StateField> fields,
             std::vector<BodyId> ids, std::size_t row_bytes = 0);

  const std::string& component() const { return component_; }
  HashGroup group() const { return group_; }
  std::span<const StateField> fields() const { return fields_; }
  std::size_t rows() const { return ids_.size(); }
  std::span<const BodyId> ids() const { return ids_; }

  /// One field of every row; Layout::columns only.
  template <class T>
  std::span<T> column(std::size_t field) {
    return {reinterpret_cast<T*>(data_.data() + starts_[field]), rows() * fields_[field].columns};
  }
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
  template <class T>
  std::span<const T> cell(std::size_t row, std::size_t field) const {
    return {reinterpret_cast<const T*>(data_.data() + starts_[field] + row * strides_[field]),
            fields_[field].columns};
  }
  /// From one row of a field to the next, bytes.
  std::size_t stride(std::size_t field) const { return strides_[field]; }
  /// The bytes of a row; Layout::rows only.
  std::size_t row_bytes() const { return row_bytes_; }
  std::byte* row(std::size_t row) { return data_.data() + row * row_bytes_; }
  const std::byte* row(std::size_t row) const { return data_.data() + row * row_bytes_; }

  /// A row that is a struct (memory_fields); Layout::rows only.
  template <class T>
  T& as(std::size_t r) {
    return *reinterpret_cast<T*>(row(r));
  }
  template <class T>
  const T& as(std::size_t r) const {
    return *reinterpret_cast<const T*>(row(r));
  }

  /// Hash of (component name, id, fields in declared order), and of (component and field name, id, field) for
  /// each sparse field that is not zero; equal rows of equal entities hash alike whatever the layout.
  std::uint64_t hash_row(std::size_t row) const { return hash_rows(row, row + 1); }
  /// The sum of the hashes of rows [first, last), modulo 2^64.
  std::uint64_t hash_rows(std::size_t first, std::size_t last) const;
  std::size_t bytes() const { return data_.size(); }
  /// Every byte 0 again, as in a new table.
  void clear() { std::ranges::fill(data_, std::byte{0}); }
  void clear_row(std::size_t row);

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
