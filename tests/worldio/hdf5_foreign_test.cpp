// HDF5 can store values in other files, and read them with the code of HDF5 plug-ins. A file of unknown
// origin must use neither: it could read any file of the user, and write it if the recording continues.

#include "tests/support/message_of.hpp"
#include "tests/support/scratch.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#if __has_include(<hdf5.h>)
#include <hdf5.h>

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

namespace troupe::worldio::hdf5_foreign_test {
namespace {

using ::testing::HasSubstr;

class ForeignHdf5 : public test::ScratchTest {
 protected:
  void SetUp() override {
    std::ofstream(other_) << "eight by";
    const hid_t file = H5Fcreate(file_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    const hsize_t extent = 1;
    const hid_t space = H5Screate_simple(1, &extent, nullptr);

    const hid_t external = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_external(external, other_.c_str(), 0, 8);
    H5Dclose(H5Dcreate2(file, "external", H5T_STD_U64LE, space, H5P_DEFAULT, external, H5P_DEFAULT));
    const hid_t text = H5Tcopy(H5T_C_S1);
    H5Tset_size(text, 8);
    H5Dclose(H5Dcreate2(file, "external_text", text, space, H5P_DEFAULT, external, H5P_DEFAULT));

    const hid_t virtual_layout = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_virtual(virtual_layout, space, (folder_ / "other.h5").c_str(), "/x", space);
    H5Dclose(H5Dcreate2(file, "virtual", H5T_STD_U64LE, space, H5P_DEFAULT, virtual_layout, H5P_DEFAULT));

    // A filter that is not HDF5's own, optional so that the dataset can be made without it.
    const hid_t filtered = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(filtered, 1, &extent);
    H5Pset_filter(filtered, 32000, H5Z_FLAG_OPTIONAL, 0, nullptr);
    H5Dclose(H5Dcreate2(file, "filtered", H5T_STD_U64LE, space, H5P_DEFAULT, filtered, H5P_DEFAULT));

    const hid_t other = H5Fcreate((folder_ / "other.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    H5Dclose(H5Dcreate2(other, "x", H5T_STD_U64LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    H5Gclose(H5Gcreate2(other, "group", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    H5Fclose(other);
    H5Lcreate_external("other.h5", "/x", file, "linked", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_external("other.h5", "/group", file, "linked_group", H5P_DEFAULT, H5P_DEFAULT);
    for (const hid_t properties : {external, virtual_layout, filtered}) H5Pclose(properties);
    H5Tclose(text);
    H5Sclose(space);
    H5Fclose(file);
  }
  template <class Call>
  std::string error_of(Call&& call) {
    try {
      call(Hdf5File::open(file_));
    } catch (const Hdf5Error& error) {
      return error.what();
    }
    return "no error";
  }

  const std::filesystem::path other_ = folder_ / "other.txt";
  const std::filesystem::path file_ = folder_ / "a.h5";
};

TEST_F(ForeignHdf5, ObjectsHaveOnePath) {
  const std::filesystem::path looped = folder_ / "looped.h5";
  const hid_t file = H5Fcreate(looped.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t group = H5Gcreate2(file, "group", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Lcreate_hard(file, "/", group, "again", H5P_DEFAULT, H5P_DEFAULT);
  H5Gclose(group);
  H5Fclose(file);
  EXPECT_THAT(test::message_of<Hdf5Error>([&] { Hdf5File::open(looped).paths(); }),
              HasSubstr("/group/again has a second path: the file is damaged"));
}

/// A visit of each path would take years: there are 10^16 of them.
TEST_F(ForeignHdf5, HeadersOfAGroupThatContainsItselfAreListedOnce) {
  const std::filesystem::path looped = folder_ / "looped.h5";
  const hid_t file = H5Fcreate(looped.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t group = H5Gcreate2(file, "group", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  for (int i = 0; i < 10; ++i)
    H5Lcreate_hard(file, "/group", group, std::to_string(i).c_str(), H5P_DEFAULT, H5P_DEFAULT);
  H5Gclose(group);
  H5Fclose(file);
  EXPECT_EQ(Hdf5File::open(looped).header_addresses().size(), 1u);
}

TEST_F(ForeignHdf5, ValuesOfVariableLengthAreNotCopied) {
  const std::filesystem::path texts = folder_ / "texts.h5";
  const hid_t file = H5Fcreate(texts.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, H5T_VARIABLE);
  const hid_t space = H5Screate(H5S_SCALAR);
  H5Dclose(H5Dcreate2(file, "text", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  H5Sclose(space);
  H5Tclose(type);
  H5Fclose(file);
  const Hdf5File from = Hdf5File::open(texts);
  EXPECT_THAT(test::message_of<Hdf5Error>(
                  [&] { Hdf5File::create_in_memory(folder_ / "copy.h5").copy_content(from); }),
              HasSubstr("/text has values of variable length"));
}

TEST_F(ForeignHdf5, ValuesInOtherFilesAreNotRead) {
  EXPECT_THAT(error_of([](const Hdf5File& file) { file.dataset("external"); }),
              HasSubstr("/external stores its values in other files"));
  EXPECT_THAT(error_of([](const Hdf5File& file) { file.read_texts("external_text"); }),
              HasSubstr("/external_text stores its values in other files"));
  EXPECT_THAT(error_of([](const Hdf5File& file) { file.dataset("virtual"); }),
              HasSubstr("/virtual stores its values in other files"));
}

TEST_F(ForeignHdf5, PlugInsOfHdf5AreNotLoaded) {
  EXPECT_THAT(error_of([](const Hdf5File& file) { file.dataset("filtered"); }),
              HasSubstr("/filtered is compressed with filter 32000"));
}

// A user may compress a recording, for example with the program h5repack.
TEST_F(ForeignHdf5, CompressedValuesMayNeedMoreBytesThanTheirFileHas) {
  const std::vector<std::uint64_t> zeros(1 << 20);
  const hid_t file = H5Fcreate(file_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hsize_t extent = zeros.size();
  const hid_t space = H5Screate_simple(1, &extent, nullptr);
  const hid_t compressed = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(compressed, 1, &extent);
  H5Pset_deflate(compressed, 9);
  const hid_t x = H5Dcreate2(file, "x", H5T_STD_U64LE, space, H5P_DEFAULT, compressed, H5P_DEFAULT);
  H5Dwrite(x, H5T_NATIVE_UINT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, zeros.data());
  H5Dclose(x);
  H5Pclose(compressed);
  H5Sclose(space);
  H5Fclose(file);
  ASSERT_LT(std::filesystem::file_size(file_), zeros.size() / 10);
  EXPECT_EQ(Hdf5File::open(file_).dataset("x").read<std::uint64_t>(), zeros);
}

TEST_F(ForeignHdf5, LinksEndInTheFile) {
  EXPECT_THAT(error_of([](const Hdf5File& file) { file.dataset("linked"); }),
              HasSubstr("there is no dataset /linked"));
  EXPECT_THAT(error_of([](const Hdf5File& file) { file.group("linked_group"); }),
              HasSubstr("there is no group /linked_group"));
}

}  // namespace
}  // namespace troupe::worldio::hdf5_foreign_test
#endif
