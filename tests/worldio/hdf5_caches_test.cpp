// HDF5 keeps metadata of a file in a cache, which by default grows with the length of a recording.

#include "tests/support/scratch.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <gtest/gtest.h>

#if __has_include(<hdf5.h>)
#include <hdf5.h>

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace troupe::worldio::hdf5_caches_test {
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
  /// Size of the metadata that the cache contains.
  static std::size_t bytes() {
    std::size_t bytes = 0;
    EXPECT_GE(H5Fget_mdc_size(handle(), nullptr, nullptr, &bytes, nullptr), 0);
    return bytes;
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

/// H5Fclose() would take a time proportional to the square of the number of datasets.
TEST_F(Hdf5Caches, OfMetadataDoNotKeepClosedDatasets) {
  constexpr int k_datasets = 6000;
  Hdf5File file = Hdf5File::create(file_);
  std::vector<Hdf5Dataset> datasets;
  for (int i = 0; i < k_datasets; ++i)
    datasets.push_back(
        file.create_extendible(std::to_string(i), engine::Element::f64, {1}, {.extent = {16, 1}}));
  file.start_swmr();
  EXPECT_GT(most_bytes(), k_most_bytes);
  const std::vector<double> row{7};
  for (Hdf5Dataset& dataset : datasets) dataset.append(std::span<const double>(row));
  file.flush();
  datasets.clear();
  EXPECT_GT(bytes(), k_most_bytes);
  file.shrink_cache();
  EXPECT_EQ(most_bytes(), k_most_bytes);
  EXPECT_LE(bytes(), k_most_bytes);
  file.close();
  EXPECT_EQ(Hdf5File::open(file_).dataset("17").read<double>(), row);
}

}  // namespace
}  // namespace troupe::worldio::hdf5_caches_test
#endif
