#include "worldio/results/hdf5_file.hpp"

#include "worldio/files.hpp"
#include "worldio/results/hdf5_heap.hpp"
#include "worldio/results/hdf5_superblock.hpp"

#include <fmt/format.h>
#define H5_USE_110_API  // use the API of HDF5 1.10, the version of Debian 12, even if the library is newer
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <limits>
#include <mutex>
#include <optional>
#include <system_error>
#include <utility>

namespace troupe::worldio {
namespace fs = std::filesystem;
namespace {

static_assert(std::is_same_v<hid_t, std::int64_t>);

/// Callback for the functions of HDF5 that iterate over attributes or links: collects the names.
template <class Info>
herr_t add_name(hid_t, const char* name, const Info*, void* names) {
  static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

/// A guard for calls of the HDF5 library. While an object of this class exists, only its thread is inside the
/// library, which is not always built to be thread-safe, and the library does not print its stack of errors.
/// Guards can be nested.
class LibraryCall {
 public:
  LibraryCall() : lock_(mutex) {
    H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~LibraryCall() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }
  LibraryCall(const LibraryCall&) = delete;
  LibraryCall& operator=(const LibraryCall&) = delete;

 private:
  static inline std::recursive_mutex mutex;
  std::lock_guard<std::recursive_mutex> lock_;
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};

Hdf5Id text_type(std::size_t size) {
  Hdf5Id type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), std::max<std::size_t>(size, 1));  // HDF5 does not allow texts of 0 bytes
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  if (size != H5T_VARIABLE) H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
  return type;
}

/// A type conversion for HDF5, from a text of variable length to the reference that the file stores for it.
/// With this conversion, HDF5 returns the reference and does not read the text; read_heap_text() reads it
/// more safely. HDF5 calls the function with the command H5T_CONV_INIT to ask whether it can convert these
/// types.
herr_t convert_to_reference(hid_t from, hid_t to, H5T_cdata_t* conversion, std::size_t, std::size_t,
                            std::size_t, void*, void*, hid_t) {
  if (conversion->command != H5T_CONV_INIT)
    return 0;  // nothing to convert: the bytes in memory are already those of the file
  conversion->need_bkg = H5T_BKG_NO;
  const bool is_this = H5Tis_variable_str(from) > 0 && H5Tget_size(from) == k_heap_reference_bytes &&
                       H5Tget_class(to) == H5T_OPAQUE && H5Tget_size(to) == k_heap_reference_bytes;
  return is_this ? 0 : -1;
}

Hdf5Id reference_type() { return {H5Tcreate(H5T_OPAQUE, k_heap_reference_bytes), H5Tclose}; }

/// Starts the library and disables its flush at the exit of the program. A file that was abandoned on a full
/// disk is still open at the exit, and the library would try to flush it for ever. Other files do not need
/// this flush, because their owners close them. Must be called before any other use of the library. Macros
/// such as H5F_ACC_RDONLY use it, too: they contain a call that starts it.
void start_library() {
  static const bool started = [] {
    H5dont_atexit();
    return H5open() >= 0 &&
           H5Tregister(H5T_PERS_SOFT, "troupe: text to reference", text_type(H5T_VARIABLE).get(),
                       reference_type().get(), convert_to_reference) >= 0;
  }();
  if (!started) throw Hdf5Error("the HDF5 library cannot be initialised: check how HDF5 is installed");
}

/// Returns properties for looking up names. With these properties, a link into another file is an error.
/// Otherwise a file of unknown origin could link to any file of the user, and continuing a recording would
/// write to that file.
hid_t within_file(hid_t access_class) {
  const hid_t properties = H5Pcreate(access_class);
  H5Pset_elink_cb(
      properties,
      [](const char*, const char*, const char*, const char*, unsigned*, hid_t, void*) { return herr_t{-1}; },
      nullptr);
  return properties;
}

/// Property lists, which are made once and exist until the library ends.
///@{
hid_t links() {
  static const hid_t properties = within_file(H5P_LINK_ACCESS);
  return properties;
}
hid_t groups() {
  static const hid_t properties = within_file(H5P_GROUP_ACCESS);
  return properties;
}
hid_t datasets() {
  static const hid_t properties = within_file(H5P_DATASET_ACCESS);
  return properties;
}
///@}

/// Checks that a dataset has its values in this file, in a layout that Troupe writes, and needs no plug-in of
/// HDF5 to decode them. HDF5 supports other files and plug-ins, but a file of unknown origin could use them
/// to read other files or to run code, and HDF5 1.10 copies values in the compact layout from a null pointer
/// if their size is 0. The error text continues a sentence about the dataset, as in "stores its values in
/// other files".
Result<> check_own(hid_t dataset) {
  const Hdf5Id creation(H5Dget_create_plist(dataset), H5Pclose);
  const H5D_layout_t layout = H5Pget_layout(creation.get());
  if (H5Pget_external_count(creation.get()) > 0 || layout == H5D_VIRTUAL)
    return Error{"stores its values in other files; all values must be in this file"};
  if (layout != H5D_CONTIGUOUS && layout != H5D_CHUNKED)
    return Error{
        "is neither stored contiguously nor in chunks: the file is damaged, or Troupe did not write it"};
  if (layout == H5D_CONTIGUOUS) {
    const Hdf5Id space(H5Dget_space(dataset), H5Sclose);
    const Hdf5Id type(H5Dget_type(dataset), H5Tclose);
    const auto values =
        static_cast<hsize_t>(std::max<hssize_t>(0, H5Sget_simple_extent_npoints(space.get())));
    const hsize_t stored = H5Dget_storage_size(dataset);  // 0 if no value was ever written
    const std::size_t size = std::max<std::size_t>(1, H5Tget_size(type.get()));
    if (stored != 0 && (stored % size != 0 || stored / size != values))
      return Error{"has another number of values than are stored: the file is damaged"};
  }
  const int filters = H5Pget_nfilters(creation.get());
  for (int i = 0; i < filters; ++i) {
    unsigned flags = 0;
    std::size_t values = 0;
    const H5Z_filter_t filter = H5Pget_filter2(creation.get(), static_cast<unsigned>(i), &flags, &values,
                                               nullptr, 0, nullptr, nullptr);
    if (filter >= H5Z_FILTER_RESERVED)
      return Error{fmt::format(
          "is compressed with filter {}, which is a plug-in of HDF5; only filters that are part of HDF5 are "
          "allowed",
          filter)};
  }
  return {};
}

/// Whether the file of a dataset is large enough for this many values of this size (bytes). A damaged file
/// may claim any number. Rows that were never written take no room in a file, but no real file consists only
/// of such rows.
bool fits(hid_t dataset, std::size_t values, std::size_t size) {
  constexpr hsize_t k_most_compression = 1032;  // deflate cannot compress a file more than to 1/1032
  const Hdf5Id file(H5Iget_file_id(dataset), H5Fclose);
  const Hdf5Id creation(H5Dget_create_plist(dataset), H5Pclose);
  hsize_t bytes = 0;
  if (H5Fget_filesize(file.get(), &bytes) < 0) return false;
  if (H5Pget_nfilters(creation.get()) > 0) bytes *= k_most_compression;
  return values <= bytes / size;
}
/// The text of the error where fits() is false.
std::string does_not_fit(std::size_t values) {
  return fmt::format("claims to hold {} values, which do not fit into the file: the file is damaged", values);
}

/// Returns the message of the deepest entry of HDF5's stack of errors, which is the cause of the failure.
std::string reason() {
  std::string deepest;
  H5Ewalk2(
      H5E_DEFAULT, H5E_WALK_UPWARD,
      [](unsigned depth, const H5E_error2_t* error, void* text) {
        if (depth == 0 && error->desc) *static_cast<std::string*>(text) = error->desc;
        return herr_t{0};
      },
      &deepest);
  // For an error of the operating system, the entry has more than its message: time, address, file
  // descriptor, ...
  constexpr std::string_view k_mark = "error message = '";
  if (const auto start = deepest.find(k_mark); start != deepest.npos) {
    const auto end = deepest.find('\'', start + k_mark.size());
    return deepest.substr(start + k_mark.size(), end - start - k_mark.size());
  }
  return deepest.empty() ? "HDF5 gives no reason" : deepest;
}

[[noreturn]] void fail_with(const fs::path& file, std::string_view message) {
  throw Hdf5Error(fmt::format("{}: error: {}", file.string(), message));
}

/// Returns what HDF5 knows of an object: its address, its kind and the sizes of its header and index.
H5O_info_t info_of(const Hdf5Object& object, hid_t id) {
  H5O_info_t info{};
  if (H5Oget_info1(id, &info) < 0)
    fail_with(object.file_name(), fmt::format("{} cannot be read: {}", object.path(), reason()));
  return info;
}

struct ElementTypes {
  hid_t in_memory;
  hid_t in_file;  ///< little-endian, so that files do not depend on the machine
};

ElementTypes types_of(engine::Element element) {
  switch (element) {
    case engine::Element::f64: return {H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE};
    case engine::Element::f32: return {H5T_NATIVE_FLOAT, H5T_IEEE_F32LE};
    case engine::Element::i64: return {H5T_NATIVE_INT64, H5T_STD_I64LE};
    case engine::Element::i32: return {H5T_NATIVE_INT32, H5T_STD_I32LE};
    case engine::Element::u64: return {H5T_NATIVE_UINT64, H5T_STD_U64LE};
    case engine::Element::u32: return {H5T_NATIVE_UINT32, H5T_STD_U32LE};
    case engine::Element::u8: break;
  }
  return {H5T_NATIVE_UINT8, H5T_STD_U8LE};
}

constexpr std::array k_elements = {engine::Element::f64, engine::Element::f32, engine::Element::i64,
                                   engine::Element::i32, engine::Element::u64, engine::Element::u32,
                                   engine::Element::u8};

std::optional<engine::Element> element_of_type(hid_t type) {
  for (const engine::Element element : k_elements)
    if (H5Tequal(type, types_of(element).in_file) > 0) return element;
  return std::nullopt;
}

/// Removes the padding of a text of fixed length.
std::string unpadded(std::string text) {
  text.resize(text.find_last_not_of('\0') + 1);
  return text;
}

Hdf5Id space_of(const std::vector<std::size_t>& extent) {
  if (extent.empty()) return {H5Screate(H5S_SCALAR), H5Sclose};
  const std::vector<hsize_t> dimensions(extent.begin(), extent.end());
  return {H5Screate_simple(static_cast<int>(dimensions.size()), dimensions.data(), nullptr), H5Sclose};
}

/// Returns properties for creating objects. They disable creation times, so that files with equal contents
/// have equal bytes.
Hdf5Id creation_properties(hid_t kind) {
  Hdf5Id properties(H5Pcreate(kind), H5Pclose);
  H5Pset_obj_track_times(properties.get(), false);
  return properties;
}

/// Limits the cache for the metadata of a file. By default, it grows to 32 MiB, with metadata that a long
/// recording has written and never needs again. With the limit, the memory of a run is constant after some
/// seconds.
constexpr std::size_t k_most_metadata_bytes = std::size_t{2} << 20;
void bound_metadata_cache(H5AC_cache_config_t& config, std::size_t most_bytes) {
  config.set_initial_size = true;
  config.initial_size = config.min_size = most_bytes / 2;
  config.max_size = most_bytes;
}

H5AC_cache_config_t metadata_cache() {
  H5AC_cache_config_t config{};
  config.version = H5AC__CURR_CACHE_CONFIG_VERSION;
  return config;
}

/// Raises the limit of the metadata cache of a file that is about to be written in SWMR mode, if many of its
/// datasets are open. In this mode, the headers and indexes of open datasets, about 1 KiB each, cannot leave
/// the cache. If they fill it, HDF5 1.10 cannot create the index of a further dataset, and may crash.
void make_room_for_open_datasets(hid_t file) {
  constexpr std::size_t k_dataset_bytes = 4096;
  constexpr std::size_t k_hdf5_limit = std::size_t{128} << 20;  // H5C__MAX_MAX_CACHE_SIZE
  const ssize_t datasets = H5Fget_obj_count(file, H5F_OBJ_DATASET);
  H5AC_cache_config_t config = metadata_cache();
  if (datasets < 0 || H5Fget_mdc_config(file, &config) < 0) return;
  const std::size_t bytes = std::min(k_dataset_bytes * static_cast<std::size_t>(datasets), k_hdf5_limit);
  if (bytes <= config.max_size) return;
  bound_metadata_cache(config, bytes);
  H5Fset_mdc_config(file, &config);
}

/// Lowers the limit again after datasets were closed, and removes their metadata from the cache. Returns
/// false if HDF5 could not write metadata. HDF5 1.10 takes much longer to remove them in H5Fclose(), a time
/// proportional to the square of their number: 15 s for 20,000 datasets.
bool remove_closed_datasets(hid_t file) {
  H5AC_cache_config_t config = metadata_cache();
  if (H5Fget_mdc_config(file, &config) < 0 || config.max_size <= k_most_metadata_bytes) return true;
  bound_metadata_cache(config, k_most_metadata_bytes);
  H5G_info_t root{};  // not used: HDF5 obeys the new limit when it next uses metadata
  return H5Fset_mdc_config(file, &config) >= 0 && H5Gget_info(file, &root) >= 0;
}

/// Returns the properties for creating or opening a file. They select the file format of HDF5 1.10, even if
/// the library is newer: SWMR mode needs at least this format, and HDF5 1.10 cannot read newer ones.
Hdf5Id access_properties() {
  Hdf5Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110);
  H5Pset_fclose_degree(access.get(), H5F_CLOSE_SEMI);  // closing a file before its objects is an error
  H5AC_cache_config_t cache = metadata_cache();
  if (H5Pget_mdc_config(access.get(), &cache) >= 0) {
    bound_metadata_cache(cache, k_most_metadata_bytes);
    H5Pset_mdc_config(access.get(), &cache);
  }
  return access;
}

/// Properties for files that are written: they disable the cache of chunks. Each batch of recorded ticks is
/// appended once and as a whole, so a cache gains nothing, but HDF5 would keep up to 1 MiB of each of the
/// hundreds of datasets of a recording in memory. Readers keep the cache: in a file that was compressed
/// afterwards, they would otherwise unpack a chunk again for each recorded tick in it.
Hdf5Id writing_access_properties() {
  Hdf5Id access = access_properties();
  H5Pset_cache(access.get(), 0, 0, 0, 0);
  return access;
}

void set_fill(hid_t properties, engine::Element element, std::optional<std::uint64_t> fill) {
  if (fill) {
    H5Pset_fill_value(properties, H5T_NATIVE_UINT64, &*fill);
  } else if (element == engine::Element::f64 || element == engine::Element::f32) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    H5Pset_fill_value(properties, H5T_NATIVE_DOUBLE, &nan);
  }
}

template <class T>
T product(std::span<const T> factors) {
  T product = 1;
  for (const T factor : factors) {
    if (factor != 0 && product > std::numeric_limits<T>::max() / factor) return std::numeric_limits<T>::max();
    product *= factor;
  }
  return product;
}

}  // namespace

// ---- ids

Hdf5Id::Hdf5Id(Hdf5Id&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}

Hdf5Id& Hdf5Id::operator=(Hdf5Id&& other) noexcept {
  if (this != &other) {
    reset();
    id_ = std::exchange(other.id_, -1);
    close_ = other.close_;
  }
  return *this;
}

bool Hdf5Id::reset() noexcept {
  if (!valid()) return true;
  const LibraryCall call;
  return close_(std::exchange(id_, -1)) >= 0;
}

// ---- attributes

Hdf5Object::Hdf5Object(Hdf5Id id, fs::path file, std::string path)
    : id_(std::move(id)), file_(std::move(file)), path_(std::move(path)) {}

void Hdf5Object::fail(std::string_view message) const {
  fail_with(file_, fmt::format("{} {}", path_, message));
}

std::int64_t Hdf5Object::check(std::int64_t result, std::string_view action) const {
  if (result < 0) fail(fmt::format("cannot be {}: {}", action, reason()));
  return result;
}

void Hdf5Object::write_attribute(const std::string& name, std::int64_t type, std::int64_t in_file,
                                 const void* value) {
  const Hdf5Id space(H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5Id attribute(H5Acreate2(id_.get(), name.c_str(), in_file, space.get(), H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose);
  check(attribute.get(), "written");
  check(H5Awrite(attribute.get(), type, value), "written");
}

void Hdf5Object::set_text(const std::string& name, std::string_view value) {
  // In this file format, the header of an object has room for 64 KiB. Longer texts are stored in the global
  // heap, which no checksum protects.
  constexpr std::size_t k_most_fixed = 60000;
  const LibraryCall call;
  const std::string text = value.empty() ? std::string(1, '\0') : std::string(value);
  if (text.size() <= k_most_fixed) {
    const Hdf5Id type = text_type(text.size());
    write_attribute(name, type.get(), type.get(), text.data());
    return;
  }
  const Hdf5Id type = text_type(H5T_VARIABLE);
  const char* const pointer = text.c_str();
  write_attribute(name, type.get(), type.get(), &pointer);
}

void Hdf5Object::set_integer(const std::string& name, std::int64_t value) {
  const LibraryCall call;
  write_attribute(name, H5T_NATIVE_INT64, H5T_STD_I64LE, &value);
}

void Hdf5Object::set_number(const std::string& name, double value) {
  const LibraryCall call;
  write_attribute(name, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE, &value);
}

std::vector<std::string> Hdf5Object::attributes() const {
  const LibraryCall call;
  std::vector<std::string> names;
  hsize_t from = 0;
  check(H5Aiterate2(id_.get(), H5_INDEX_NAME, H5_ITER_INC, &from, add_name<H5A_info_t>, &names), "read");
  std::ranges::sort(names);
  return names;
}

bool Hdf5Object::has_attribute(const std::string& name) const {
  const LibraryCall call;
  return H5Aexists(id_.get(), name.c_str()) > 0;
}

Hdf5Id Hdf5Object::open_attribute(const std::string& name) const {
  if (!has_attribute(name))
    fail(fmt::format("has no attribute \"{}\": the file is damaged, or Troupe did not write it", name));
  Hdf5Id attribute(H5Aopen(id_.get(), name.c_str(), H5P_DEFAULT), H5Aclose);
  check(attribute.get(), "read");
  const Hdf5Id space(H5Aget_space(attribute.get()), H5Sclose);
  if (const auto values = H5Sget_simple_extent_npoints(space.get()); values != 1)
    fail(
        fmt::format("has an attribute \"{}\" with {} values, but the attribute must have one value: the "
                    "file is damaged",
                    name, values));
  return attribute;
}

std::string Hdf5Object::text(const std::string& name) const {
  const LibraryCall call;
  const Hdf5Id attribute = open_attribute(name);
  const Hdf5Id type(H5Aget_type(attribute.get()), H5Tclose);
  if (H5Tget_class(type.get()) != H5T_STRING)
    fail(fmt::format("has an attribute \"{}\" that is not a string: the file is damaged", name));
  if (H5Tis_variable_str(type.get()) > 0) return variable_text(attribute.get(), name);
  const std::size_t size = H5Tget_size(type.get());
  if (size > H5Aget_storage_size(attribute.get()))
    fail(fmt::format(
        "has an attribute \"{}\" whose string is longer than the bytes stored for it: the file is damaged",
        name));
  std::string value(size, '\0');
  check(H5Aread(attribute.get(), type.get(), value.data()), "read");
  return unpadded(std::move(value));
}

/// Reads a text of variable length. Older recordings store text attributes in this form; set_text() does so
/// only for long texts.
std::string Hdf5Object::variable_text(std::int64_t attribute, const std::string& name) const {
  std::array<std::uint8_t, k_heap_reference_bytes> reference{};
  check(H5Aread(attribute, reference_type().get(), reference.data()), "read");
  const Hdf5Id open_file(H5Iget_file_id(id_.get()), H5Fclose);
  const Hdf5Id creation(H5Fget_create_plist(open_file.get()), H5Pclose);
  hsize_t user_block = 0;
  check(H5Pget_userblock(creation.get(), &user_block), "read");
  std::optional<std::string> text = read_heap_text(file_, user_block, reference);
  if (!text) fail(fmt::format("has an attribute \"{}\" whose string is missing: the file is damaged", name));
  return std::move(*text);
}

std::int64_t Hdf5Object::integer(const std::string& name) const {
  const LibraryCall call;
  const Hdf5Id attribute = open_attribute(name);
  const Hdf5Id type(H5Aget_type(attribute.get()), H5Tclose);
  std::int64_t value = 0;
  if (H5Tget_class(type.get()) != H5T_INTEGER)
    fail(fmt::format("has an attribute \"{}\" that is not an integer: the file is damaged", name));
  check(H5Aread(attribute.get(), H5T_NATIVE_INT64, &value), "read");
  return value;
}

double Hdf5Object::number(const std::string& name) const {
  const LibraryCall call;
  const Hdf5Id attribute = open_attribute(name);
  const Hdf5Id type(H5Aget_type(attribute.get()), H5Tclose);
  double value = 0;
  if (H5Tget_class(type.get()) != H5T_FLOAT)
    fail(fmt::format("has an attribute \"{}\" that is not a number: the file is damaged", name));
  check(H5Aread(attribute.get(), H5T_NATIVE_DOUBLE, &value), "read");
  return value;
}

void Hdf5Object::copy_attributes(const Hdf5Object& from) {
  const LibraryCall call;
  for (const std::string& name : from.attributes()) {
    const Hdf5Id attribute = from.open_attribute(name);
    const Hdf5Id type(H5Aget_type(attribute.get()), H5Tclose);
    switch (H5Tget_class(type.get())) {
      case H5T_STRING: set_text(name, from.text(name)); break;
      case H5T_INTEGER: set_integer(name, from.integer(name)); break;
      case H5T_FLOAT: set_number(name, from.number(name)); break;
      default: from.fail(fmt::format("has an attribute \"{}\" that is neither a text nor a number", name));
    }
  }
}

std::uint64_t Hdf5Object::bytes_in_file() const {
  const LibraryCall call;
  const H5O_info_t info = info_of(*this, id_.get());
  std::uint64_t bytes = info.hdr.space.total;
  for (const H5_ih_info_t& more : {info.meta_size.obj, info.meta_size.attr})
    bytes += more.index_size + more.heap_size;
  if (info.type == H5O_TYPE_DATASET) bytes += H5Dget_storage_size(id_.get());
  return bytes;
}

// ---- datasets

Hdf5Dataset::Hdf5Dataset(Hdf5Id id, fs::path file, std::string path)
    : Hdf5Object(std::move(id), std::move(file), std::move(path)) {
  const Hdf5Id type(H5Dget_type(id_.get()), H5Tclose);
  const std::optional<engine::Element> element = element_of_type(type.get());
  if (!element) fail("has elements of an unknown type; known: numbers of 32 or 64 bits, and bytes");
  element_ = *element;
  const Hdf5Id space(H5Dget_space(id_.get()), H5Sclose);
  std::vector<hsize_t> dimensions(
      static_cast<std::size_t>(check(H5Sget_simple_extent_ndims(space.get()), "read")));
  check(H5Sget_simple_extent_dims(space.get(), dimensions.data(), nullptr), "read");
  extent_.assign(dimensions.begin(), dimensions.end());
}

std::size_t Hdf5Dataset::row_values() const {
  return extent_.empty() ? 1 : product(std::span<const std::size_t>(extent_).subspan(1));
}

std::size_t Hdf5Dataset::values() const {
  const std::size_t values = product(std::span<const std::size_t>(extent_));
  const LibraryCall call;
  if (!fits(id_.get(), values, engine::element_size(element_))) fail(does_not_fit(values));
  return values;
}

void Hdf5Dataset::check_element(engine::Element element) const {
  if (element != element_)
    fail(fmt::format("holds values of type {}, but must hold values of type {}",
                     engine::element_name(element_), engine::element_name(element)));
}

/// Returns the selection of rows in the file, and an array in memory that has room for these rows.
std::pair<Hdf5Id, Hdf5Id> Hdf5Dataset::select_rows(std::size_t first, std::size_t rows,
                                                   std::string_view action) const {
  std::vector<hsize_t> start(extent_.size(), 0);
  std::vector<hsize_t> size(extent_.begin(), extent_.end());
  start[0] = first;
  size[0] = rows;
  Hdf5Id in_file(H5Dget_space(id_.get()), H5Sclose);
  check(H5Sselect_hyperslab(in_file.get(), H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr),
        action);
  Hdf5Id in_memory(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), H5Sclose);
  return {std::move(in_file), std::move(in_memory)};
}

void Hdf5Dataset::write_rows(std::size_t first, std::size_t rows, const void* from, std::size_t values,
                             engine::Element element) {
  check_element(element);
  if (values != rows * row_values())
    fail(
        fmt::format("takes exactly {} values, but {} were given (internal error, not an error of your input: "
                    "please report it)",
                    rows * row_values(), values));
  if (values == 0) return;
  const LibraryCall call;
  const hid_t type = types_of(element).in_memory;
  if (first == 0 && rows == this->rows()) {
    check(H5Dwrite(id_.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, from), "written");
    return;
  }
  const auto [in_file, in_memory] = select_rows(first, rows, "written");
  check(H5Dwrite(id_.get(), type, in_memory.get(), in_file.get(), H5P_DEFAULT, from), "written");
}

void Hdf5Dataset::write_bytes(std::span<const std::byte> from) {
  write_rows(0, rows(), from.data(), from.size() / engine::element_size(element_), element_);
}

void Hdf5Dataset::append(const void* from, std::size_t values, engine::Element element) {
  check_element(element);
  const std::size_t row = std::max<std::size_t>(row_values(), 1);
  if (values % row != 0)
    fail(
        fmt::format("has rows of {} values: {} values are not a whole number of rows (internal error, not an "
                    "error of your input: please report it)",
                    row, values));
  const std::size_t first = rows();
  resize(first + values / row);
  write_rows(first, values / row, from, values, element);
}

void Hdf5Dataset::append_bytes(std::span<const std::byte> from) {
  append(from.data(), from.size() / engine::element_size(element_), element_);
}

void Hdf5Dataset::resize(std::size_t rows) {
  if (extent_.empty()) fail("is a single value, but must have rows: the file is damaged");
  const LibraryCall call;
  std::vector<hsize_t> extent(extent_.begin(), extent_.end());
  extent[0] = rows;
  check(H5Dset_extent(id_.get(), extent.data()), "written");
  extent_[0] = rows;
}

void Hdf5Dataset::read_rows(std::size_t first, void* into, std::size_t values,
                            engine::Element element) const {
  check_element(element);
  if (values == 0) return;
  const std::size_t row = std::max<std::size_t>(row_values(), 1);
  const std::size_t count = values / row;
  if (values % row != 0 || first > rows() || count > rows() - first)
    fail(fmt::format(
        "has {} rows of {} values; cannot read {} values from row {} on (rows are counted from 0): read "
        "whole rows, at most up to the last row",
        rows(), row, values, first));
  const LibraryCall call;
  const hid_t type = types_of(element).in_memory;
  if (count == rows()) {
    check(H5Dread(id_.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, into), "read");
    return;
  }
  const auto [in_file, in_memory] = select_rows(first, count, "read");
  check(H5Dread(id_.get(), type, in_memory.get(), in_file.get(), H5P_DEFAULT, into), "read");
}

void Hdf5Dataset::read_bytes(std::size_t first, std::span<std::byte> into) const {
  read_rows(first, into.data(), into.size() / engine::element_size(element_), element_);
}

void Hdf5Dataset::flush() {
  const LibraryCall call;
  check(H5Dflush(id_.get()), "written");
}

// ---- groups

Hdf5Group::Hdf5Group(Hdf5Id id, fs::path file, std::string path)
    : Hdf5Object(std::move(id), std::move(file), std::move(path)) {}

std::string Hdf5Group::path_of(const std::string& name) const {
  return path_ == "/" ? path_ + name : fmt::format("{}/{}", path_, name);
}

Hdf5Group Hdf5Group::create_group(const std::string& name) {
  const LibraryCall call;
  const Hdf5Id properties = creation_properties(H5P_GROUP_CREATE);
  Hdf5Group made(
      Hdf5Id(H5Gcreate2(id_.get(), name.c_str(), H5P_DEFAULT, properties.get(), H5P_DEFAULT), H5Gclose),
      file_, path_of(name));
  made.check(made.id_.get(), "written");
  return made;
}

Hdf5Group Hdf5Group::group(const std::string& name) const {
  const LibraryCall call;
  if (!has_group(name))
    fail_with(file_, fmt::format("there is no group {}: the file is damaged, or Troupe did not write it",
                                 path_of(name)));
  Hdf5Group found(Hdf5Id(H5Gopen2(id_.get(), name.c_str(), groups()), H5Gclose), file_, path_of(name));
  found.check(found.id_.get(), "read");
  return found;
}

bool Hdf5Group::has(const std::string& name) const {
  const LibraryCall call;
  return H5Lexists(id_.get(), name.c_str(), links()) > 0 &&
         H5Oexists_by_name(id_.get(), name.c_str(), links()) > 0;
}

bool Hdf5Group::has_group(const std::string& name) const {
  if (!has(name)) return false;
  const LibraryCall call;
  const Hdf5Id object(H5Oopen(id_.get(), name.c_str(), links()), H5Oclose);
  return object.valid() && H5Iget_type(object.get()) == H5I_GROUP;
}

std::vector<std::string> Hdf5Group::names() const {
  const LibraryCall call;
  std::vector<std::string> names;
  hsize_t from = 0;
  check(H5Literate(id_.get(), H5_INDEX_NAME, H5_ITER_INC, &from, add_name<H5L_info_t>, &names), "read");
  std::ranges::sort(names);
  return names;
}

Hdf5Object Hdf5Group::object(const std::string& name) const {
  const LibraryCall call;
  Hdf5Object found(Hdf5Id(H5Oopen(id_.get(), name.c_str(), links()), H5Oclose), file_, path_of(name));
  found.check(found.id_.get(), "read");
  return found;
}

/// The largest number of groups in one another.
constexpr auto k_most_steps = 16;

std::vector<std::uint64_t> Hdf5Group::header_addresses() const {
  std::set<std::uint64_t> addresses;
  add_header_addresses(0, addresses);
  return {addresses.begin(), addresses.end()};
}

void Hdf5Group::add_header_addresses(std::size_t depth, std::set<std::uint64_t>& addresses) const {
  if (depth > k_most_steps) return;
  for (const std::string& name : names()) {
    const LibraryCall call;
    H5L_info_t link{};
    if (H5Lget_info(id_.get(), name.c_str(), &link, H5P_DEFAULT) < 0 || link.type != H5L_TYPE_HARD ||
        !addresses.insert(link.u.address).second)
      continue;
    if (has_group(name)) group(name).add_header_addresses(depth + 1, addresses);
  }
}

std::vector<std::string> Hdf5Group::paths() const {
  const LibraryCall call;
  std::set<std::uint64_t> seen{info_of(*this, id_.get()).addr};
  std::vector<std::string> paths;
  add_paths("", seen, paths);
  return paths;
}

/// Adds the paths of all objects in this group, each with a prefix. `seen` has the addresses of the objects
/// that have a path already.
void Hdf5Group::add_paths(const std::string& prefix, std::set<std::uint64_t>& seen,
                          std::vector<std::string>& paths) const {
  if (std::ranges::count(prefix, '/') > k_most_steps) fail("is nested too deep: the file is damaged");
  for (const std::string& name : names()) {
    const Hdf5Object object = this->object(name);
    if (!seen.insert(info_of(object, object.id_.get()).addr).second)
      object.fail("has a second path: the file is damaged");
    paths.push_back(prefix + name);
    if (has_group(name)) group(name).add_paths(prefix + name + "/", seen, paths);
  }
}

void Hdf5Group::copy_content(const Hdf5Group& from) {
  for (const std::string& path : from.paths()) {
    if (from.has_group(path)) {
      create_group(path).copy_attributes(from.group(path));
    } else {
      copy_dataset(from, path);
    }
  }
}

/// Adds a copy of a dataset of another file, with its attributes. HDF5 copies the values; the attributes are
/// copied one by one, because HDF5 must not read texts of variable length (see read_heap_text()).
void Hdf5Group::copy_dataset(const Hdf5Group& from, const std::string& name) {
  const LibraryCall call;
  const Hdf5Object source = from.object(name);
  const Hdf5Id type(H5Dget_type(source.id_.get()), H5Tclose);
  if (H5Tdetect_class(type.get(), H5T_VLEN) != 0 || H5Tis_variable_str(type.get()) != 0)
    source.fail("has values of variable length, or none: the file is damaged, or Troupe did not write it");
  if (const Result<> own = check_own(source.id_.get()); !own) source.fail(own.error().text);
  const Hdf5Id properties(H5Pcreate(H5P_OBJECT_COPY), H5Pclose);
  H5Pset_copy_object(properties.get(), H5O_COPY_WITHOUT_ATTR_FLAG);
  source.check(H5Ocopy(from.id_.get(), name.c_str(), id_.get(), name.c_str(), properties.get(), H5P_DEFAULT),
               "copied");
  object(name).copy_attributes(source);
}

void Hdf5Group::fail_to_create(const std::string& name) const {
  fail_with(file_, fmt::format("the dataset {} cannot be created: {}", path_of(name), reason()));
}

Hdf5Id Hdf5Group::make_dataset(const std::string& name, std::int64_t type, const Hdf5Id& space,
                               const Hdf5Id& properties) {
  Hdf5Id made(
      H5Dcreate2(id_.get(), name.c_str(), type, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
      H5Dclose);
  if (!made.valid()) fail_to_create(name);
  return made;
}

Hdf5Dataset Hdf5Group::create_dataset(const std::string& name, engine::Element element,
                                      const std::vector<std::size_t>& extent) {
  const LibraryCall call;
  const Hdf5Id properties = creation_properties(H5P_DATASET_CREATE);
  const Hdf5Id space = space_of(extent);
  return {make_dataset(name, types_of(element).in_file, space, properties), file_, path_of(name)};
}

Hdf5Dataset Hdf5Group::create_extendible(const std::string& name, engine::Element element,
                                         const std::vector<std::size_t>& row, const Hdf5Chunks& chunks) {
  const LibraryCall call;
  std::vector<hsize_t> extent{0};
  std::vector<hsize_t> most{H5S_UNLIMITED};
  for (const std::size_t size : row) {
    extent.push_back(size);
    most.push_back(size == 0 ? H5S_UNLIMITED : size);  // a chunk must not exceed a fixed extent
  }
  const Hdf5Id space(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), most.data()), H5Sclose);
  const Hdf5Id properties = creation_properties(H5P_DATASET_CREATE);
  const std::vector<hsize_t> chunk(chunks.extent.begin(), chunks.extent.end());
  H5Pset_chunk(properties.get(), static_cast<int>(chunk.size()), chunk.data());
  set_fill(properties.get(), element, chunks.fill);
  return {make_dataset(name, types_of(element).in_file, space, properties), file_, path_of(name)};
}

void Hdf5Group::fail_about(const std::string& name, std::string_view message) const {
  fail_with(file_, fmt::format("{} {}", path_of(name), message));
}

Hdf5Id Hdf5Group::open_dataset(const std::string& name) const {
  if (!has(name) || has_group(name))
    fail_with(file_, fmt::format("there is no dataset {}: the file is damaged, or Troupe did not write it",
                                 path_of(name)));
  Hdf5Id found(H5Dopen2(id_.get(), name.c_str(), datasets()), H5Dclose);
  if (!found.valid()) fail_about(name, fmt::format("cannot be read: {}", reason()));
  if (const Result<> own = check_own(found.get()); !own) fail_about(name, own.error().text);
  return found;
}

Hdf5Dataset Hdf5Group::dataset(const std::string& name) const {
  const LibraryCall call;
  return {open_dataset(name), file_, path_of(name)};
}

void Hdf5Group::write_text(const std::string& name, std::string_view text) {
  const LibraryCall call;
  const Hdf5Id space(H5Screate(H5S_SCALAR), H5Sclose);
  write_padded(name, text.empty() ? std::string(1, '\0') : std::string(text), text_type(text.size()), space);
}

void Hdf5Group::write_texts(const std::string& name, std::span<const std::string> texts) {
  const LibraryCall call;
  std::size_t longest = 1;
  for (const std::string& text : texts) longest = std::max(longest, text.size());
  std::string padded(longest * texts.size(), '\0');
  for (std::size_t i = 0; i < texts.size(); ++i) texts[i].copy(padded.data() + i * longest, longest);
  write_padded(name, padded, text_type(longest), space_of({texts.size()}));
}

/// Creates a dataset of texts of equal length and writes it. padded: all texts, one after another
void Hdf5Group::write_padded(const std::string& name, const std::string& padded, const Hdf5Id& type,
                             const Hdf5Id& space) {
  const Hdf5Id made = make_dataset(name, type.get(), space, creation_properties(H5P_DATASET_CREATE));
  if (!padded.empty() && H5Dwrite(made.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()) < 0)
    fail_to_create(name);
}

std::vector<std::string> Hdf5Group::read_texts(const std::string& name) const {
  const LibraryCall call;
  const Hdf5Id found = open_dataset(name);
  const Hdf5Id type(H5Dget_type(found.get()), H5Tclose);
  const Hdf5Id space(H5Dget_space(found.get()), H5Sclose);
  if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) != 0)
    fail_about(name,
               "is not a string of fixed length: the file is damaged, or Troupe did not write the file");
  const std::size_t length = H5Tget_size(type.get());
  const auto count = static_cast<std::size_t>(check(H5Sget_simple_extent_npoints(space.get()), "read"));
  if (!fits(found.get(), count, length)) fail_about(name, does_not_fit(count));
  std::string padded(length * count, '\0');
  if (count > 0 && H5Dread(found.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()) < 0)
    fail_about(name, fmt::format("cannot be read: {}", reason()));
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < count; ++i) texts.push_back(unpadded(padded.substr(i * length, length)));
  return texts;
}

std::string Hdf5Group::read_text(const std::string& name) const {
  std::vector<std::string> texts = read_texts(name);
  if (texts.size() != 1)
    fail_about(name,
               fmt::format("must contain one string, but contains {}: the file is damaged", texts.size()));
  return std::move(texts.front());
}

// ---- files

namespace {

Hdf5Id made(const fs::path& file, std::size_t user_block, hid_t access) {
  const Hdf5Id creation = creation_properties(H5P_FILE_CREATE);
  H5Pset_userblock(creation.get(), user_block);
  Hdf5Id made(H5Fcreate(file.c_str(), H5F_ACC_TRUNC, creation.get(), access), H5Fclose);
  if (!made.valid()) fail_with(file, fmt::format("cannot be written: {}", write_failure(file, reason())));
  return made;
}

}  // namespace

Hdf5File::Hdf5File(Hdf5Id id, fs::path file) : Hdf5Group(std::move(id), std::move(file), "/") {}

Hdf5File Hdf5File::create(const fs::path& file, std::size_t user_block) {
  start_library();
  const LibraryCall call;
  const Hdf5Id access = writing_access_properties();
  return {made(file, user_block, access.get()), file};
}

Hdf5File Hdf5File::create_in_memory(const fs::path& file, std::size_t user_block) {
  constexpr std::size_t k_piece = 1 << 20;  // step, in bytes, by which the memory grows
  start_library();
  const LibraryCall call;
  const Hdf5Id access = access_properties();
  H5Pset_fapl_core(access.get(), k_piece, false);
  // Newer superblocks have a checksum, and a flag that says that the file is open for writing.
  // H5Fget_file_image() clears the flag, but does not update the checksum.
  H5Pset_libver_bounds(access.get(), H5F_LIBVER_EARLIEST, H5F_LIBVER_V110);
  return {made(file, user_block, access.get()), file};
}

/// In SWMR mode, HDF5 reads metadata again if the checksum is wrong, because the writer may be overwriting it
/// at this moment. Before the n-th attempt, it waits 2^n ns. By default, there are 100 attempts, so that HDF5
/// would wait for ever for a writer that was killed. 30 attempts take a second.
void bound_read_attempts(hid_t access) { H5Pset_metadata_read_attempts(access, 30); }

Hdf5File Hdf5File::opened(const fs::path& file, unsigned flags) {
  const LibraryCall call;
  if (const Result<> readable = check_readable(file); !readable) fail_with(file, readable.error().text);
  const Hdf5Id access = (flags & H5F_ACC_RDWR) != 0 ? writing_access_properties() : access_properties();
  if ((flags & H5F_ACC_SWMR_READ) != 0) bound_read_attempts(access.get());
  Hdf5Id found(H5Fopen(file.c_str(), flags, access.get()), H5Fclose);
  if (!found.valid()) {
    const std::string why = reason();  // before other calls of the library
    // HDF5 locks the files that it opens.
    if (why == std::generic_category().message(EAGAIN))
      fail_with(file, "is locked, because it is open elsewhere, for example in a notebook: close it there");
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(file, error);
    if (const auto head = read_superblock(file); head && !error && bytes < head->end)
      fail_with(file, fmt::format(
                          "is incomplete: it has {} of {} bytes, as after an interrupted copy, and cannot be "
                          "repaired: copy the file again",
                          bytes, head->end));
    fail_with(file, fmt::format("cannot be read: {}", why));
  }
  return {std::move(found), file};
}

Hdf5File Hdf5File::open(const fs::path& file) {
  start_library();
  return opened(file, H5F_ACC_RDONLY);
}

Hdf5File Hdf5File::open_swmr(const fs::path& file) {
  start_library();
  return opened(file, H5F_ACC_RDONLY | H5F_ACC_SWMR_READ);
}

Hdf5File Hdf5File::open_to_write(const fs::path& file) {
  start_library();
  return opened(file, H5F_ACC_RDWR);
}

void Hdf5File::start_swmr() {
  const LibraryCall call;
  make_room_for_open_datasets(id_.get());
  if (H5Fstart_swmr_write(id_.get()) < 0)
    fail_with(file_, fmt::format("the SWMR mode of HDF5, in which other programs can read the file while it "
                                 "is written, cannot be started: {}",
                                 reason()));
}

void Hdf5File::flush() {
  const LibraryCall call;
  if (H5Fflush(id_.get(), H5F_SCOPE_GLOBAL) < 0)
    fail_with(file_, fmt::format("cannot be written: {}", reason()));
}

std::uint64_t Hdf5File::unused_bytes() const {
  const LibraryCall call;
  hsize_t size = 0;
  check(H5Fget_filesize(id_.get(), &size), "read");
  std::uint64_t used = bytes_in_file();
  for (const std::string& path : paths()) used += object(path).bytes_in_file();
  return size - std::min<std::uint64_t>(size, used);
}

std::vector<std::byte> Hdf5File::image() {
  flush();
  const LibraryCall call;
  const Hdf5Id creation(H5Fget_create_plist(id_.get()), H5Pclose);
  hsize_t user_block = 0;
  H5Pget_userblock(creation.get(), &user_block);
  const auto size = static_cast<std::size_t>(check(H5Fget_file_image(id_.get(), nullptr, 0), "copied"));
  // The library's image begins after the user block.
  std::vector<std::byte> bytes(user_block + size);
  check(H5Fget_file_image(id_.get(), bytes.data() + user_block, size), "copied");
  return bytes;
}

void Hdf5File::shrink_cache() {
  const LibraryCall call;
  if (!remove_closed_datasets(id_.get())) fail_with(file_, fmt::format("cannot be written: {}", reason()));
}

void Hdf5File::close() {
  if (!id_.valid()) return;
  const LibraryCall call;
  shrink_cache();
  if (!id_.reset()) fail_with(file_, fmt::format("cannot be closed: {}", reason()));
}

void Hdf5File::abandon() noexcept { id_.release(); }

bool has_hdf5() { return true; }

void require_hdf5(const std::filesystem::path& /*file*/) {}

}  // namespace troupe::worldio
