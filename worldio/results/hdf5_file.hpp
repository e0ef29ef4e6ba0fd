#pragma once

#include "engine/fields/state_table.hpp"

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

/// The exception that is thrown if a file cannot be read or written, or if its content is not what a reader
/// expects. The message has the name of the file and the reason: `run.h5: error: ...`. If the HDF5 library
/// cannot be initialised, the message names no file. The HDF5 library itself prints nothing.
class Hdf5Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Owns an id (a handle) of the HDF5 library and closes it when destroyed.
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
  /// Closes the id. Returns false if closing failed; true if there is no open id.
  bool reset() noexcept;
  /// Gives up the id without closing it: the library keeps it open until the process ends.
  void release() noexcept { id_ = -1; }

 private:
  std::int64_t id_ = -1;
  Close close_ = nullptr;
};

/// A group or a dataset, with its attributes. The name of an attribute may contain any character except NUL,
/// even "/". On failure, the functions throw Hdf5Error, whose message names the file and the object;
/// has_attribute() returns false instead.
class Hdf5Object {
 public:
  /// The path of the object in the file, such as "/state/pose".
  const std::string& path() const { return path_; }
  const std::filesystem::path& file_name() const { return file_; }

  /// These functions add an attribute; the object must not have an attribute of this name. Texts are UTF-8.
  /// They are stored with a fixed length in the header of the object, and a checksum protects this header;
  /// h5py reads such texts as bytes. Texts of more than 60,000 bytes are stored with variable length outside
  /// the header, without a checksum.
  void set_text(const std::string& name, std::string_view value);
  void set_integer(const std::string& name, std::int64_t value);
  void set_number(const std::string& name, double value);
  /// The names of the attributes, sorted by their bytes.
  std::vector<std::string> attributes() const;
  bool has_attribute(const std::string& name) const;
  /// These functions return the value of an attribute. They throw if the attribute does not exist or has
  /// another type. NUL characters at the end of a text are lost.
  std::string text(const std::string& name) const;
  std::int64_t integer(const std::string& name) const;
  double number(const std::string& name) const;

  /// Throws an Hdf5Error about this object: `run.h5: error: /frames/tick MESSAGE`. The message is a
  /// predicate, such as "is larger than the file".
  [[noreturn]] void fail(std::string_view message) const;

 protected:
  Hdf5Object() = default;
  Hdf5Object(Hdf5Id id, std::filesystem::path file, std::string path);
  /// Returns `result`, the return value of a function of HDF5. If it is negative, throws an Hdf5Error:
  /// "cannot be ACTION", with the reason that HDF5 gives. `action` is a participle, such as "read".
  std::int64_t check(std::int64_t result, std::string_view action) const;
  void write_attribute(const std::string& name, std::int64_t type, std::int64_t file_type, const void* value);
  Hdf5Id open_attribute(const std::string& name) const;
  std::string variable_text(std::int64_t attribute, const std::string& name) const;

  Hdf5Id id_;
  std::filesystem::path file_;
  std::string path_;
};

/// An array of one element type. Its first dimension counts the rows; an array without dimensions is one row
/// with a single value. Values are read and written in row-major order.
class Hdf5Dataset : public Hdf5Object {
 public:
  Hdf5Dataset() = default;  ///< refers to no dataset
  engine::Element element() const { return element_; }
  /// The size along each dimension; empty if the array has no dimensions.
  const std::vector<std::size_t>& extent() const { return extent_; }
  std::size_t rows() const { return extent_.empty() ? 1 : extent_.front(); }
  /// The number of values in a row.
  std::size_t row_values() const;
  /// The number of all values: rows() * row_values(). Throws if this many values take more bytes than the
  /// file has, so that a damaged file cannot make the caller allocate terabytes.
  std::size_t values() const;

  /// Writes (write()) or reads (read()) all values. The span must have rows() * row_values() elements of the
  /// type element(); bool is stored as uint8. Throws for another element type and, in write(), for another
  /// number of elements.
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
  /// Reads as many rows as the span can hold, from the row with index `first` on. The size of the span must
  /// be a multiple of row_values(). Throws if the dataset does not have all these rows.
  template <class T>
  void read_rows(std::size_t first, std::span<T> into) const {
    read_rows(first, into.data(), into.size(), engine::element_of<T>());
  }
  /// Like write() and read_rows(), for an element type that is only known at run time. The spans are the
  /// bytes of whole rows.
  void write_bytes(std::span<const std::byte> from);
  void read_bytes(std::size_t first, std::span<std::byte> into) const;

  /// Adds rows after the last one. The dataset must be extendible (Hdf5Group::create_extendible()), and the
  /// number of values a multiple of row_values().
  template <class T>
  void append(std::span<const T> from) {
    append(from.data(), from.size(), engine::element_of<T>());
  }
  void append_bytes(std::span<const std::byte> from);
  /// Sets the number of rows of an extendible dataset: removes the last rows, or adds rows whose values are
  /// Hdf5Chunks::fill. Throws if the dataset is a single value or is not extendible.
  void resize(std::size_t rows);
  /// Hands the written data to the operating system. From then on, the data survives if the process is
  /// killed, and readers in SWMR mode (Hdf5File::start_swmr()) see it.
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

/// How HDF5 stores an extendible dataset: in blocks of equal size, called chunks.
struct Hdf5Chunks {
  std::vector<std::size_t> extent;    ///< size of a chunk along each dimension of the dataset, each above 0
  std::optional<std::uint64_t> fill;  ///< value of unwritten elements; empty: NaN for floats, else 0
};

/// A group: it contains other groups and datasets, as a folder contains folders and files.
class Hdf5Group : public Hdf5Object {
 public:
  /// Creates a group in this group. The name of a new group or dataset must not exist in this group and must
  /// not contain "/"; hdf5_name() replaces this character.
  Hdf5Group create_group(const std::string& name);
  Hdf5Group group(const std::string& name) const;
  bool has(const std::string& name) const;
  bool has_group(const std::string& name) const;
  /// The names of the groups and datasets in this group, sorted by their bytes.
  std::vector<std::string> names() const;

  /// Creates a dataset of fixed size, which write() fills.
  Hdf5Dataset create_dataset(const std::string& name, engine::Element element,
                             const std::vector<std::size_t>& extent);
  /// Creates a dataset without rows, to which append() adds rows. `row` is the extent of a row along each
  /// dimension after the first. `chunks.extent` must have one entry for each dimension, the first included.
  Hdf5Dataset create_extendible(const std::string& name, engine::Element element,
                                const std::vector<std::size_t>& row, const Hdf5Chunks& chunks);
  Hdf5Dataset dataset(const std::string& name) const;
  /// Creates a dataset of one dimension and writes these values to it.
  template <class T>
  void write(const std::string& name, std::span<const T> values) {
    create_dataset(name, engine::element_of<T>(), {values.size()}).write(values);
  }

  /// These functions write and read a dataset that is one text or a list of texts. Texts are UTF-8. They are
  /// padded with NUL to the length of the longest; the readers remove NUL characters at the end. read_text()
  /// throws if the dataset does not have exactly one text.
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

/// A file and its root group. Only one thread at a time may use a file and the objects opened from it.
/// Threads that use different files take turns inside the HDF5 library. The destructor closes the file and
/// ignores errors; close() reports them. All datasets and groups of the file must be destroyed before the
/// file.
class Hdf5File : public Hdf5Group {
 public:
  /// Creates a file, replacing an existing file of the same name. The first `user_block` bytes of the file
  /// (0, or a power of two, at least 512) belong to the caller: HDF5 does not touch them.
  static Hdf5File create(const std::filesystem::path& file, std::size_t user_block = 0);
  /// Creates a file in memory, where errors of the disk cannot damage it. image() returns its bytes. No file
  /// on the disk is created: `file` is only the name in error messages.
  static Hdf5File create_in_memory(const std::filesystem::path& file, std::size_t user_block = 0);
  /// Opens a file for reading. Throws if the file is marked as open for writing: a program is writing it, or
  /// its writer was killed.
  static Hdf5File open(const std::filesystem::path& file);
  /// Opens, for reading, a file that a program is writing in SWMR mode (see start_swmr()), or was writing in
  /// this mode when the program was killed.
  static Hdf5File open_swmr(const std::filesystem::path& file);
  /// Opens a file for reading and writing. Like open(), throws if the file is marked as open for writing.
  static Hdf5File open_to_write(const std::filesystem::path& file);

  /// Starts SWMR mode ("single writer, multiple readers"): other programs can read the file while it is being
  /// written, and flushed data survives if the writer is killed. From then on, no group, dataset or attribute
  /// can be created.
  void start_swmr();
  /// Hands all data written to the file to the operating system.
  void flush();
  /// Returns the present bytes of a file that create_in_memory() created. They begin with the user block,
  /// whose bytes are all 0.
  std::vector<std::byte> image();
  /// Writes the remaining data and closes the file. All datasets and groups of the file must have been
  /// destroyed before. Throws Hdf5Error if one of them still exists, or if writing or closing fails. Does
  /// nothing if the file is already closed or abandoned.
  void close();
  /// Gives up the file without closing it: the file on the disk stays as it is. Call this after a failed
  /// write, because on a full disk, writing the remaining data would damage the file. Datasets and groups of
  /// the file may still exist, but must not be used; they only occupy memory.
  void abandon() noexcept;

 private:
  Hdf5File(Hdf5Id id, std::filesystem::path file);
  static Hdf5File opened(const std::filesystem::path& file, unsigned flags);
};

/// Whether the program was built with the HDF5 library (the build option TROUPE_HDF5). Without it, creating
/// or opening a file throws an error that says so.
bool has_hdf5();

/// Returns a name as one step of a path in an HDF5 file. The characters "/", "%" and NUL become "%2F", "%25"
/// and "%00". The names ".", ".." and "" become "%2E", "%2E%2E" and "%".
std::string hdf5_name(std::string_view name);

}  // namespace troupe::worldio
