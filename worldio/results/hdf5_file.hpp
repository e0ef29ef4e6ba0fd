#pragma once

#include "engine/fields/state_table.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::worldio {

/// Thrown if a file cannot be read or written, or if its content is not what the reader expects. The message
/// has the name of the file and the reason: `run.h5: error: ...`. If the HDF5 library cannot be initialised,
/// the message names no file. The HDF5 library itself prints no messages.
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
/// even "/". On failure, all functions except has_attribute() throw an Hdf5Error that names the file and the
/// object. has_attribute() returns false on failure.
class Hdf5Object {
 public:
  /// The path of the object in the file, such as "/state/pose".
  const std::string& path() const { return path_; }
  const std::filesystem::path& file_name() const { return file_; }

  /// set_text(), set_integer() and set_number() add an attribute. The object must not have an attribute of
  /// this name yet.
  ///
  /// Texts are UTF-8. A text is stored with a fixed length in the header of the object, which has a checksum;
  /// h5py reads such a text as bytes. A text of more than 60,000 bytes does not fit into the header. It is
  /// stored with variable length elsewhere in the file, without a checksum.
  void set_text(const std::string& name, std::string_view value);
  void set_integer(const std::string& name, std::int64_t value);
  void set_number(const std::string& name, double value);
  /// The names of the attributes, sorted by their bytes.
  std::vector<std::string> attributes() const;
  bool has_attribute(const std::string& name) const;
  /// text(), integer() and number() return the value of an attribute. They throw if the attribute does not
  /// exist or has another type. NUL characters at the end of a text are lost.
  std::string text(const std::string& name) const;
  std::int64_t integer(const std::string& name) const;
  double number(const std::string& name) const;
  /// Adds copies of all attributes of another object, which is in another file. Throws if one of them is not
  /// a text, integer or number.
  void copy_attributes(const Hdf5Object& from);

  /// The space that the object takes in the file, bytes: its header with its attributes, its index and the
  /// values of a dataset. Not counted are the objects in a group, and texts that are stored with variable
  /// length.
  std::uint64_t bytes_in_file() const;

  /// Throws an Hdf5Error about this object. The argument is a predicate: fail("is larger than the file")
  /// gives the message `run.h5: error: /frames/tick is larger than the file`.
  [[noreturn]] void fail(std::string_view message) const;

 protected:
  friend class Hdf5Group;
  Hdf5Object() = default;
  Hdf5Object(Hdf5Id id, std::filesystem::path file, std::string path);
  /// Checks `result`, which a function of the HDF5 library has returned, and returns it. If it is negative,
  /// throws an Hdf5Error: `run.h5: error: /frames/tick cannot be ACTION: ...`, with the reason that HDF5
  /// gives. `action` is a participle, such as "read".
  std::int64_t check(std::int64_t result, std::string_view action) const;
  void write_attribute(const std::string& name, std::int64_t type, std::int64_t file_type, const void* value);
  Hdf5Id open_attribute(const std::string& name) const;
  std::string variable_text(std::int64_t attribute, const std::string& name) const;

  Hdf5Id id_;
  std::filesystem::path file_;
  std::string path_;
};

/// An array of numbers of one type. The first dimension counts the rows: an array with the extent [5, 3] has
/// 5 rows of 3 values. An array without dimensions has one row with one value. Values are read and written in
/// row-major order.
class Hdf5Dataset : public Hdf5Object {
 public:
  Hdf5Dataset() = default;  ///< refers to no dataset
  engine::Element element() const { return element_; }
  /// The size along each dimension; empty if the array has no dimensions.
  const std::vector<std::size_t>& extent() const { return extent_; }
  std::size_t rows() const { return extent_.empty() ? 1 : extent_.front(); }
  std::size_t row_values() const;
  /// The number of all values: rows() * row_values(). Throws if the file is too small to contain this many
  /// values. (Otherwise, a damaged file could make the caller allocate terabytes.)
  std::size_t values() const;

  /// write() writes all values; read() reads them. T must be the C++ type of element(), or bool if element()
  /// is Element::u8; otherwise the functions throw. The span must have rows() * row_values() elements;
  /// write() throws for any other number.
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
  /// Reads rows, beginning with the row of index `first`, until the span is full. The size of the span must
  /// be a multiple of row_values(). Throws if the dataset has too few rows.
  template <class T>
  void read_rows(std::size_t first, std::span<T> into) const {
    read_rows(first, into.data(), into.size(), engine::element_of<T>());
  }
  /// write_bytes() is like write(), and read_bytes() is like read_rows(), for an element type that is only
  /// known at run time. The spans contain the bytes of whole rows, as they are in memory.
  void write_bytes(std::span<const std::byte> from);
  void read_bytes(std::size_t first, std::span<std::byte> into) const;

  /// Adds rows after the last row. The dataset must be extendible (Hdf5Group::create_extendible()). Throws if
  /// the number of values is not a multiple of row_values(), or if T is not the type of element().
  template <class T>
  void append(std::span<const T> from) {
    append(from.data(), from.size(), engine::element_of<T>());
  }
  void append_bytes(std::span<const std::byte> from);
  /// Sets the number of rows of an extendible dataset. Removes rows at the end, or adds rows at the end,
  /// whose values are Hdf5Chunks::fill. Throws if the dataset has no dimensions or is not extendible.
  void resize(std::size_t rows);
  /// Hands the written data to the operating system. The data is then kept even if the process is killed, and
  /// readers in SWMR mode (Hdf5File::start_swmr()) can see it.
  void flush();

 private:
  friend class Hdf5Group;
  Hdf5Dataset(Hdf5Id id, std::filesystem::path file, std::string path);
  void append(const void* from, std::size_t values, engine::Element element);
  void write_rows(std::size_t first, std::size_t rows, const void* from, std::size_t values,
                  engine::Element element);
  void read_rows(std::size_t first, void* into, std::size_t values, engine::Element element) const;
  std::pair<Hdf5Id, Hdf5Id> select_rows(std::size_t first, std::size_t rows, std::string_view action) const;
  void check_element(engine::Element element) const;

  engine::Element element_ = engine::Element::f64;
  std::vector<std::size_t> extent_;
};

/// How HDF5 stores an extendible dataset: in blocks of equal size, called chunks.
struct Hdf5Chunks {
  std::vector<std::size_t> extent;    ///< size of a chunk along each dimension of the dataset, each above 0
  std::optional<std::uint64_t> fill;  ///< value of unwritten elements; empty: NaN for floats, else 0
};

/// A group: it contains other groups and datasets, as a folder contains folders and files. A new group or
/// dataset must have a name that does not exist in the group yet and that does not contain "/". hdf5_name()
/// converts any text to a name without this character.
class Hdf5Group : public Hdf5Object {
 public:
  Hdf5Group create_group(const std::string& name);
  Hdf5Group group(const std::string& name) const;
  bool has(const std::string& name) const;
  bool has_group(const std::string& name) const;
  /// The names of the groups and datasets in this group, sorted by their bytes.
  std::vector<std::string> names() const;
  /// The paths of the groups and datasets in this group and in the groups inside it, as in "pose/x_m", which
  /// group() and dataset() accept. A group comes before its content, and names are sorted by their bytes.
  /// Throws if groups are nested more than 16 deep, or if an object has two paths: a group of a damaged file
  /// may contain itself.
  std::vector<std::string> paths() const;
  /// The addresses in the file of the headers of all objects in this group and in the groups inside it, each
  /// once and in ascending order, also of objects that cannot be opened because their header is damaged.
  /// Groups that are nested more than 16 deep and objects behind soft links are left out.
  std::vector<std::uint64_t> header_addresses() const;

  /// Creates a dataset of a fixed size. `extent` is the size along each dimension. Hdf5Dataset::write() sets
  /// the values.
  Hdf5Dataset create_dataset(const std::string& name, engine::Element element,
                             const std::vector<std::size_t>& extent);
  /// Creates a dataset without rows, to which append() adds rows. `row` has the sizes of the dimensions after
  /// the first, and chunks.extent has one entry for each dimension, including the first. For rows of 3
  /// values, for example, `row` is {3}, and chunks.extent can be {1000, 3}.
  Hdf5Dataset create_extendible(const std::string& name, engine::Element element,
                                const std::vector<std::size_t>& row, const Hdf5Chunks& chunks);
  Hdf5Dataset dataset(const std::string& name) const;
  /// Adds copies of all groups and datasets of another group, which is in another file, with their
  /// attributes. Throws as paths() and copy_attributes() do, and if a dataset contains texts of variable
  /// length.
  void copy_content(const Hdf5Group& from);
  /// Creates a dataset of one dimension and writes `values` to it.
  template <class T>
  void write(const std::string& name, std::span<const T> values) {
    create_dataset(name, engine::element_of<T>(), {values.size()}).write(values);
  }

  /// write_text() and read_text() are for a dataset with one text, write_texts() and read_texts() for a
  /// dataset with a list of texts. Texts are UTF-8. All texts of a dataset are stored with the length of the
  /// longest, padded with NUL characters. The readers remove all NUL characters at the end of a text.
  /// read_text() throws if the dataset does not have exactly one text.
  void write_text(const std::string& name, std::string_view text);
  std::string read_text(const std::string& name) const;
  void write_texts(const std::string& name, std::span<const std::string> texts);
  std::vector<std::string> read_texts(const std::string& name) const;

 protected:
  Hdf5Group() = default;
  Hdf5Group(Hdf5Id id, std::filesystem::path file, std::string path);
  Hdf5Object object(const std::string& name) const;

 private:
  std::string path_of(const std::string& name) const;
  /// Throws Hdf5Error. The message continues a sentence about the object `name` of this group.
  [[noreturn]] void fail_about(const std::string& name, std::string_view message) const;
  [[noreturn]] void fail_to_create(const std::string& name) const;
  Hdf5Id open_dataset(const std::string& name) const;
  Hdf5Id make_dataset(const std::string& name, std::int64_t type, const Hdf5Id& space,
                      const Hdf5Id& properties);
  void write_padded(const std::string& name, const std::string& padded, const Hdf5Id& type,
                    const Hdf5Id& space);
  void add_paths(const std::string& prefix, std::set<std::uint64_t>& seen,
                 std::vector<std::string>& paths) const;
  void add_header_addresses(std::size_t depth, std::set<std::uint64_t>& addresses) const;
  void copy_dataset(const Hdf5Group& from, const std::string& name);
};

/// A file and its root group. Only one thread at a time may use a file and the objects opened from it.
/// Threads that use different files take turns inside the HDF5 library. All datasets and groups of the file
/// must be destroyed before the file. The destructor closes the file and ignores errors; close() reports
/// them.
class Hdf5File : public Hdf5Group {
 public:
  /// Creates a file, replacing an existing file of the same name. `user_block` is the number of bytes at the
  /// beginning of the file that HDF5 does not touch, so that the caller can use them: 0, or a power of two
  /// that is at least 512.
  static Hdf5File create(const std::filesystem::path& file, std::size_t user_block = 0);
  /// Creates a file in memory, not on the disk. image() returns its bytes. `file` is only the name in error
  /// messages. `user_block` is as for create().
  static Hdf5File create_in_memory(const std::filesystem::path& file, std::size_t user_block = 0);
  /// Opens a file for reading. Throws if the file is marked as open for writing: a program is writing it, or
  /// its writer was killed.
  static Hdf5File open(const std::filesystem::path& file);
  /// Opens a file for reading that a program is writing in SWMR mode (see start_swmr()). The program may also
  /// have been killed while it wrote the file in this mode.
  static Hdf5File open_swmr(const std::filesystem::path& file);
  /// Opens a file for reading and writing. Like open(), throws if the file is marked as open for writing.
  static Hdf5File open_to_write(const std::filesystem::path& file);

  /// Starts SWMR mode ("single writer, multiple readers"): other programs can read the file while this
  /// program writes it, and flushed data is kept if this program is killed. After this call, no group,
  /// dataset or attribute can be created.
  void start_swmr();
  /// Hands all data written to the file to the operating system.
  void flush();
  /// The size of the file without the space that its groups and datasets take (bytes_in_file()), bytes. Most
  /// of this space was taken by values that were removed: HDF5 does not use it again.
  std::uint64_t unused_bytes() const;
  /// Returns the present bytes of a file that create_in_memory() created. They begin with the user block,
  /// whose bytes are all 0.
  std::vector<std::byte> image();
  /// Removes the metadata of closed datasets from the memory of HDF5. start_swmr() lets this memory grow with
  /// the number of datasets. close() calls this function.
  void shrink_cache();
  /// Writes the remaining data and closes the file. All datasets and groups of the file must have been
  /// destroyed before. Throws Hdf5Error if one of them still exists, or if writing or closing fails. Does
  /// nothing if the file is already closed, or after abandon().
  void close();
  /// Gives up the file without writing the remaining data, so that the file on the disk stays as it is. Call
  /// this function after a failed write: on a full disk, a further attempt to write would damage the file.
  /// Datasets and groups of the file need not be destroyed before the call, but must not be used after it.
  void abandon() noexcept;

 private:
  Hdf5File(Hdf5Id id, std::filesystem::path file);
  static Hdf5File opened(const std::filesystem::path& file, unsigned flags);
};

/// Whether the program was built with the HDF5 library (the build option TROUPE_HDF5). If it was not,
/// creating or opening a file throws an error that says so.
bool has_hdf5();
/// Throws Hdf5Error, as creating the file does, if the program was built without the HDF5 library.
void require_hdf5(const std::filesystem::path& file);

/// Converts a text to a name for a group or dataset. Replaces the characters "/", "%" and NUL with "%2F",
/// "%25" and "%00". The texts ".", ".." and "" become "%2E", "%2E%2E" and "%".
std::string hdf5_name(std::string_view name);
/// Returns the text that hdf5_name() converted to `name`.
std::string text_of_hdf5_name(std::string_view name);

}  // namespace troupe::worldio
