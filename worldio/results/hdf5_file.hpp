#pragma once

#include "engine/state_table.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::worldio {

/// A file could not be written, or is not what a reader expects: `run.h5: error: ...` with the reason in
/// plain words. HDF5 itself prints nothing.
class Hdf5Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An id that HDF5's library handed out, given back with its owner.
class Hdf5Id {
 public:
  using Close = int (*)(std::int64_t);
  Hdf5Id() = default;
  Hdf5Id(std::int64_t id, Close close) : id_(id), close_(close) {}
  ~Hdf5Id() { reset(); }
  Hdf5Id(Hdf5Id&& other) noexcept;
  Hdf5Id& operator=(Hdf5Id&& other) noexcept;
  std::int64_t get() const { return id_; }
  bool valid() const { return id_ >= 0; }
  /// Gives it back; false where that failed.
  bool reset() noexcept;
  /// Forgets it: the library keeps it open until the process ends.
  void release() noexcept { id_ = -1; }

 private:
  std::int64_t id_ = -1;
  Close close_ = nullptr;
};

/// What groups and datasets have in common: attributes. A name may hold any character, "/" too.
/// Everything throws Hdf5Error that names file and attribute.
class Hdf5Object {
 public:
  /// Path in the file, "/state/pose".
  const std::string& path() const { return path_; }
  const std::filesystem::path& file_name() const { return file_; }

  /// A new attribute. Texts are UTF-8 of fixed length, which lie in the object's header and under its
  /// checksum; h5py gives them as bytes. Those of more than 60,000 bytes are of variable length.
  void set_text(const std::string& name, std::string_view value);
  void set_integer(const std::string& name, std::int64_t value);
  void set_number(const std::string& name, double value);
  /// Names in alphabetical order.
  std::vector<std::string> attributes() const;
  bool has_attribute(const std::string& name) const;
  /// The value of an attribute; an error where there is none, or none of this kind.
  std::string text(const std::string& name) const;
  std::int64_t integer(const std::string& name) const;
  double number(const std::string& name) const;

  /// Throws an Hdf5Error about this object: `run.h5: error: /frames/tick MESSAGE`.
  [[noreturn]] void fail(std::string_view message) const;

 protected:
  Hdf5Object() = default;
  Hdf5Object(Hdf5Id id, std::filesystem::path file, std::string path);
  /// Throws, with HDF5's reason, unless result is one of success.
  std::int64_t check(std::int64_t result, std::string_view action) const;
  void write_attribute(const std::string& name, std::int64_t type, std::int64_t file_type, const void* value);
  Hdf5Id open_attribute(const std::string& name) const;
  std::string variable_text(std::int64_t attribute, const std::string& name) const;

  Hdf5Id id_;
  std::filesystem::path file_;
  std::string path_;
};

/// An array of one element type. The first dimension is that of the rows; what is read or written is
/// row-major.
class Hdf5Dataset : public Hdf5Object {
 public:
  Hdf5Dataset() = default;  ///< of no file
  engine::Element element() const { return element_; }
  const std::vector<std::size_t>& extent() const { return extent_; }
  std::size_t rows() const { return extent_.empty() ? 1 : extent_.front(); }
  /// Values in a row.
  std::size_t row_values() const;
  /// All of it: rows times values in a row; an error where that is more than the file can hold, so that a
  /// damaged file requests no terabytes.
  std::size_t values() const;

  /// Writes all values, or reads them; the span's size must be values(), its type element()'s (bool: uint8).
  template <class T>
  void write(std::span<const T> from) {
    write_rows(0, rows(), from.data(), from.size(), engine::element_of<T>());
  }
  template <class T>
  void read(std::span<T> into) const {
    read_rows(0, into);
  }
  template <class T>
  std::vector<T> read() const {
    std::vector<T> into(values());
    read(std::span<T>(into));
    return into;
  }
  /// Rows from `first` on, as many as fit the span.
  template <class T>
  void read_rows(std::size_t first, std::span<T> into) const {
    read_rows(first, into.data(), into.size(), engine::element_of<T>());
  }
  /// The same where the element type is only known at run time: bytes of whole rows of element().
  void write_bytes(std::span<const std::byte> from);
  void read_bytes(std::size_t first, std::span<std::byte> into) const;

  /// New rows behind the last; of extendible datasets.
  template <class T>
  void append(std::span<const T> from) {
    append(from.data(), from.size(), engine::element_of<T>());
  }
  void append_bytes(std::span<const std::byte> from);
  /// Cuts rows off, or adds rows of the fill value.
  void resize(std::size_t rows);
  /// Hands what was written to the operating system: from then on it survives the death of the process, and
  /// readers in SWMR mode see it.
  void flush();

 private:
  friend class Hdf5Group;
  Hdf5Dataset(Hdf5Id id, std::filesystem::path file, std::string path);
  void append(const void* from, std::size_t values, engine::Element element);
  void write_rows(std::size_t first, std::size_t rows, const void* from, std::size_t values,
                  engine::Element element);
  void read_rows(std::size_t first, void* into, std::size_t values, engine::Element element) const;
  void check_element(engine::Element element) const;

  engine::Element element_ = engine::Element::f64;
  std::vector<std::size_t> extent_;
};

/// How an extendible dataset lies in the file.
struct Hdf5Chunks {
  std::vector<std::size_t> extent;    ///< of a chunk: as many dimensions as the dataset, none 0
  std::optional<std::uint64_t> fill;  ///< of rows that were never written; not given: 0, or NaN where a float
};

class Hdf5Group : public Hdf5Object {
 public:
  /// A new group below this one. A name is one step: it holds no "/" (hdf5_name), and is new.
  Hdf5Group create_group(const std::string& name);
  Hdf5Group group(const std::string& name) const;
  bool has(const std::string& name) const;
  bool has_group(const std::string& name) const;
  /// Names of groups and datasets, in alphabetical order.
  std::vector<std::string> names() const;

  /// A new dataset of a size that stays; write() fills it.
  Hdf5Dataset create_dataset(const std::string& name, engine::Element element,
                             const std::vector<std::size_t>& extent);
  /// A new dataset without a row, to be appended to; `row` is the extent of one.
  Hdf5Dataset create_extendible(const std::string& name, engine::Element element,
                                const std::vector<std::size_t>& row, const Hdf5Chunks& chunks);
  Hdf5Dataset dataset(const std::string& name) const;
  /// create_dataset of one dimension, filled.
  template <class T>
  void write(const std::string& name, std::span<const T> values) {
    create_dataset(name, engine::element_of<T>(), {values.size()}).write(values);
  }

  /// A dataset that is one text, or a list of texts; UTF-8, each as long as the longest.
  void write_text(const std::string& name, std::string_view text);
  std::string read_text(const std::string& name) const;
  void write_texts(const std::string& name, std::span<const std::string> texts);
  std::vector<std::string> read_texts(const std::string& name) const;

 protected:
  Hdf5Group() = default;
  Hdf5Group(Hdf5Id id, std::filesystem::path file, std::string path);

 private:
  std::string path_of(const std::string& name) const;
};

/// A file, and its root group. One thread at a time uses it and what was opened from it; threads that use
/// different files take turns inside HDF5's library. Its end closes it, if datasets and groups of it have
/// ended before; what fails then is lost: close() tells.
class Hdf5File : public Hdf5Group {
 public:
  /// A new file, replacing one of the same name. The first `user_block` bytes are the caller's (0, or a power
  /// of two from 512 on): HDF5 leaves them alone.
  static Hdf5File create(const std::filesystem::path& file, std::size_t user_block = 0);
  /// A new file that lies in memory, under the name that messages are to give it; what the disk does cannot
  /// harm it. image() is the file.
  static Hdf5File create_in_memory(const std::filesystem::path& file, std::size_t user_block = 0);
  /// To read, a file that was closed.
  static Hdf5File open(const std::filesystem::path& file);
  /// To read, a file that is being written in SWMR mode or whose writer was killed there.
  static Hdf5File open_swmr(const std::filesystem::path& file);
  /// To read and write, a file that was closed.
  static Hdf5File open_to_write(const std::filesystem::path& file);

  /// From here on, readers in SWMR mode ("single writer, multiple readers") may come while it is written, and
  /// what was flushed survives the writer's death. No group, dataset or attribute can be made any more.
  void start_swmr();
  /// Hands everything that was written to the operating system.
  void flush();
  /// The bytes of a file in memory as it is now, the user block's (zeros) first.
  std::vector<std::byte> image();
  /// Writes what is left and closes; datasets and groups of the file must be gone. Throws where it fails.
  void close();
  /// Leaves the file on the disk as it is now and writes no more to it: what a full disk makes of the rest is
  /// worse than nothing. Datasets and groups of it that live on only waste memory.
  void abandon() noexcept;

 private:
  Hdf5File(Hdf5Id id, std::filesystem::path file);
  static Hdf5File opened(const std::filesystem::path& file, unsigned flags);
};

/// Whether the program was built with HDF5 (TROUPE_HDF5). Without, files can neither be made nor opened, and
/// the error says so.
bool has_hdf5();

/// A name as one step of a path: "/" and "%" become "%2F" and "%25", "." and "" become "%2E" and "%".
std::string hdf5_name(std::string_view name);

}  // namespace troupe::worldio
