// HDF5 keeps metadata of a file in a cache, which by default grows with the length of a recording.

#include "tests/support/scratch.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <gtest/gtest.h>

#if __has_include(<hdf5.h>)
#include <hdf5.h>

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace troupe::worldio {
namespace {

constexpr std::size_t k_most_bytes = std::size_t{2} << 20;

class Hdf5Caches : public test::ScratchTest {
 protected:
  void SetUp() override {
    if (!has_hdf5()) GTEST_SKIP() << "built without HDF5";
  }
  /// HDF5's own handle of the only open file.
  static hid_t handle() {
    hid_t id = H5I_INVALID_HID;
    EXPECT_EQ(H5Fget_obj_ids(static_cast<hid_t>(H5F_OBJ_ALL), H5F_OBJ_FILE, 1, &id), 1);
    return id;
  }
  static std::size_t most_bytes() {
    H5AC_cache_config_t config{};
    config.version = H5AC__CURR_CACHE_CONFIG_VERSION;
    EXPECT_GE(H5Fget_mdc_config(handle(), &config), 0);
    EXPECT_LE(config.initial_size, config.max_size);
    return config.max_size;
  }

  const std::filesystem::path file_ = folder_ / "a.h5";
};

TEST_F(Hdf5Caches, OfMetadataAreBoundedInEveryWayToOpenAFile) {
  const std::vector<std::pair<std::string, std::function<Hdf5File()>>> ways{
      {"create", [&] { return Hdf5File::create(file_); }},
      {"create_in_memory", [&] { return Hdf5File::create_in_memory(file_); }},
      {"open", [&] { return Hdf5File::open(file_); }},
      {"open_to_write", [&] { return Hdf5File::open_to_write(file_); }}};
  for (const auto& [name, open] : ways) {
    Hdf5File file = open();
    EXPECT_EQ(most_bytes(), k_most_bytes) << name;
    file.close();
  }
}

}  // namespace
}  // namespace troupe::worldio
#endif
