#include "engine/fields/state_table.hpp"

#include "base/assert.hpp"
#include "base/capacity.hpp"
#include "base/hash.hpp"
#include "engine/fields/moved_rows.hpp"

#include <array>
#include <cstring>

namespace troupe::engine {

std::size_t element_size(Element element) {
  return visit_element(element, [](auto value) { return sizeof value; });
}

void to_doubles(Element element, std::span<const std::byte> bytes, std::span<double> into) {
  visit_element(element, [&](auto value) {
    for (std::size_t i = 0; i < into.size(); ++i) {
      std::memcpy(&value, bytes.data() + i * sizeof value, sizeof value);
      into[i] = static_cast<double>(value);
    }
  });
}

std::string_view element_name(Element element) {
  switch (element) {
    case Element::f64: return "float64";
    case Element::f32: return "float32";
    case Element::i64: return "int64";
    case Element::i32: return "int32";
    case Element::u64: return "uint64";
    case Element::u32: return "uint32";
    case Element::u8: break;
  }
  return "uint8";
}

std::string_view hash_group_name(HashGroup group) {
  switch (group) {
    case HashGroup::pose: return "pose";
    case HashGroup::velocity: return "velocity";
    case HashGroup::sensor: return "sensor";
    case HashGroup::memory: break;
  }
  return "memory";
}

std::vector<StateField> sparse(std::vector<StateField> fields) {
  for (StateField& field : fields) field.sparse = true;
  return fields;
}

namespace {

bool is_zero(const std::byte* first, std::size_t bytes) {
  // The first byte is 0, and each byte equals the next. memcmp tests this as fast as memory is read.
  return bytes == 0 || (first[0] == std::byte{0} && std::memcmp(first, first + 1, bytes - 1) == 0);
}

}  // namespace

StateTable::StateTable(std::string component, HashGroup group, Layout layout, std::vector<StateField> fields,
                       std::vector<BodyId> ids, std::size_t row_bytes)
    : component_(std::move(component)),
      group_(group),
      layout_(layout),
      fields_(std::move(fields)),
      ids_(std::move(ids)),
      room_(ids_.size()),
      component_hash_(hash_text(component_)) {
  if (layout_ == Layout::rows) {
    const bool packed = row_bytes > 0;
    for (StateField& field : fields_) {
      if (packed) break;
      const std::size_t align = element_size(field.element);
      field.offset = static_cast<std::uint32_t>((row_bytes + align - 1) / align * align);
      row_bytes = field.offset + align * field.columns;
    }
    row_bytes_ = packed ? row_bytes : (row_bytes + 7) / 8 * 8;
  }
  data_.assign(lay_out(), std::byte{0});
}

/// Computes the places of the fields in a memory of room_ rows. Returns the size of this memory, bytes.
std::size_t StateTable::lay_out() {
  constexpr std::size_t k_align = 64;  // a cache line, which columns of different fields never share
  starts_.clear();
  strides_.clear();
  stretches_.clear();
  sparse_.clear();
  hashed_bytes_ = 0;
  std::size_t end = layout_ == Layout::rows ? row_bytes_ * room_ : 0;
  for (const StateField& field : fields_) {
    const std::size_t width = field.bytes();
    if (layout_ == Layout::rows) {
      starts_.push_back(field.offset);
      strides_.push_back(row_bytes_);
    } else {
      starts_.push_back(end);
      strides_.push_back(width);
      end = (end + width * room_ + k_align - 1) / k_align * k_align;
    }
    const Stretch stretch{starts_.back(), strides_.back(), width};
    if (field.sparse) {
      sparse_.push_back({stretch, hash_bytes(std::as_bytes(std::span(field.name)), component_hash_)});
      continue;
    }
    hashed_bytes_ += width;
    if (layout_ == Layout::rows && !stretches_.empty() &&
        stretches_.back().start + stretches_.back().bytes == stretch.start)
      stretches_.back().bytes += width;
    else
      stretches_.push_back(stretch);
  }
  return end;
}

void StateTable::change_capacity(std::size_t rows) {
  const std::size_t room = capacity_for(rows, room_);
  if (room == room_) return;
  room_ = room;
  const std::vector<std::size_t> old_starts = starts_;
  std::vector<std::byte> data(lay_out(), std::byte{0});
  const auto copy = [&](std::size_t from, std::size_t to, std::size_t bytes) {
    if (bytes > 0) std::memcpy(data.data() + to, data_.data() + from, bytes);
  };
  if (layout_ == Layout::rows) copy(0, 0, this->rows() * row_bytes_);
  for (std::size_t f = 0; layout_ == Layout::columns && f < fields_.size(); ++f)
    copy(old_starts[f], starts_[f], this->rows() * strides_[f]);
  data_.swap(data);
  troupe::change_capacity(ids_, rows);
}

bool StateTable::bools_hold() const {
  for (std::size_t field = 0; field < fields_.size(); ++field) {
    if (!fields_[field].is_bool) continue;
    for (std::size_t row = 0; row < rows(); ++row)
      if (std::ranges::any_of(cell<std::uint8_t>(row, field), [](std::uint8_t value) { return value > 1; }))
        return false;
  }
  return true;
}

void StateTable::fill_row(std::size_t row, std::byte value) {
  for (std::size_t f = 0; f < fields_.size(); ++f)
    std::memset(data_.data() + starts_[f] + row * strides_[f], std::to_integer<int>(value),
                fields_[f].bytes());
}

void StateTable::copy_row(std::size_t row, const StateTable& from) {
  for (std::size_t f = 0; f < fields_.size(); ++f) {
    std::memcpy(data_.data() + starts_[f] + row * strides_[f],
                from.data_.data() + from.starts_[f] + row * strides_[f], fields_[f].bytes());
  }
}

void StateTable::add_rows(std::span<const BodyId> ids) {
  TROUPE_ASSERT(rows() + ids.size() <= room_);
  for (const BodyId id : ids) {
    ids_.push_back(id);
    clear_row(ids_.size() - 1);
  }
}

void StateTable::move_rows(std::span<const std::uint32_t> to) {
  const std::vector<std::uint32_t> moved = moved_places(to);
  move_elements(ids_, moved, to);
  std::vector<std::byte> cells;  // of a field, of the rows in `moved`
  for (std::size_t f = 0; f < fields_.size(); ++f) {
    const std::size_t width = fields_[f].bytes();
    if (width == 0) continue;  // a sensor without beams; data_ may be empty
    const auto cell = [&](std::size_t row) { return data_.data() + starts_[f] + row * strides_[f]; };
    cells.resize(moved.size() * width);
    for (std::size_t i = 0; i < moved.size(); ++i) std::memcpy(&cells[i * width], cell(moved[i]), width);
    for (std::size_t i = 0; i < moved.size(); ++i) std::memcpy(cell(to[moved[i]]), &cells[i * width], width);
  }
}

std::uint64_t StateTable::hash_rows(std::size_t first, std::size_t last) const {
  std::uint64_t sum = stretches_.empty() && !sparse_.empty() ? 0 : hash_dense(first, last);
  for (const Sparse& field : sparse_) sum += field.hash_rows(ids_, data_.data(), first, last);
  return sum;
}

std::uint64_t StateTable::Sparse::hash_rows(std::span<const BodyId> ids, const std::byte* data,
                                            std::size_t first, std::size_t last) const {
  const std::byte* const begin = data + place.start;
  // A sparse field is nearly always 0 in all rows. If its column is contiguous, one call tests this.
  if (place.stride == place.bytes && is_zero(begin + first * place.stride, (last - first) * place.bytes))
    return 0;
  std::uint64_t sum = 0;
  for (std::size_t row = first; row < last; ++row) {
    const std::byte* const field = begin + row * place.stride;
    if (!is_zero(field, place.bytes))
      sum += troupe::hash_rows(ids.subspan(row, 1), field, place.stride, place.bytes, seed);
  }
  return sum;
}

std::uint64_t StateTable::hash_dense(std::size_t first, std::size_t last) const {
  if (stretches_.size() == 1) {
    const Stretch& row = stretches_.front();
    return troupe::hash_rows(std::span(ids_).subspan(first, last - first),
                             data_.data() + row.start + first * row.stride, row.stride, row.bytes,
                             component_hash_);
  }
  // The fields of a row are copied into one buffer, so that the hash depends on neither padding nor layout.
  std::array<std::byte, 1024> small;
  std::vector<std::byte> large;
  const std::size_t bytes = sizeof(BodyId) + hashed_bytes_;
  if (bytes > small.size()) large.resize(bytes);
  const std::span<std::byte> gathered(bytes > small.size() ? large.data() : small.data(), bytes);
  std::uint64_t sum = 0;
  for (std::size_t row = first; row < last; ++row) {
    std::byte* p = gathered.data();
    std::memcpy(p, &ids_[row], sizeof(BodyId));
    p += sizeof(BodyId);
    for (const Stretch& stretch : stretches_) {
      if (stretch.bytes == 0) continue;  // a sensor without beams; data_ may be empty
      std::memcpy(p, data_.data() + stretch.start + row * stretch.stride, stretch.bytes);
      p += stretch.bytes;
    }
    sum += hash_bytes(gathered, component_hash_);
  }
  return sum;
}

std::string_view given_name(std::string_view component) {
  const std::size_t slash = component.find('/');
  if (slash == component.npos) return component;
  if (component.starts_with("sensors/") && component.find('/', slash + 1) != component.npos)
    return component.substr(component.rfind('/') + 1);
  const std::string_view rest = component.substr(slash + 1);
  const bool is_number = rest.find_first_not_of("0123456789") == rest.npos;  // of a controller
  return is_number ? component : rest;
}

bool selects(std::string_view name, std::string_view component) {
  return name == component || name == given_name(component) ||
         name == component.substr(0, component.find('/'));
}

}  // namespace troupe::engine
