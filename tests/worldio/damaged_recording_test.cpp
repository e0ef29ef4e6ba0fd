#ifdef TROUPE_HAS_HDF5

#include "base/diagnostics.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/scratch.hpp"
#include "tests/worldio/recording_by_hand.hpp"
#include "worldio/results/recording_reader.hpp"
#include "worldio/results/recording_repair.hpp"
#include "worldio/results/replay_data.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#define H5_USE_110_API
#include <hdf5.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace troupe::worldio::damaged_recording_test {
namespace {

namespace fs = std::filesystem;

/// Gives an object's attributes of fixed length the type that they had in older files: texts of variable
/// length.
herr_t make_texts_variable(hid_t root, const char* path, const H5O_info_t*, void*) {
  const hid_t object = H5Oopen(root, path, H5P_DEFAULT);
  std::vector<std::string> names;
  hsize_t from = 0;
  H5Aiterate2(
      object, H5_INDEX_NAME, H5_ITER_INC, &from,
      [](hid_t, const char* name, const H5A_info_t*, void* list) {
        static_cast<std::vector<std::string>*>(list)->emplace_back(name);
        return herr_t{0};
      },
      &names);
  const hid_t variable = H5Tcopy(H5T_C_S1);
  H5Tset_size(variable, H5T_VARIABLE);
  H5Tset_cset(variable, H5T_CSET_UTF8);
  const hid_t space = H5Screate(H5S_SCALAR);
  for (const std::string& name : names) {
    hid_t attribute = H5Aopen(object, name.c_str(), H5P_DEFAULT);
    const hid_t type = H5Aget_type(attribute);
    const bool is_fixed = H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0;
    std::string text(H5Tget_size(type) + 1, '\0');
    if (is_fixed) H5Aread(attribute, type, text.data());
    H5Tclose(type);
    H5Aclose(attribute);
    if (!is_fixed) continue;
    H5Adelete(object, name.c_str());
    attribute = H5Acreate2(object, name.c_str(), variable, space, H5P_DEFAULT, H5P_DEFAULT);
    const char* const pointer = text.c_str();
    H5Awrite(attribute, variable, &pointer);
    H5Aclose(attribute);
  }
  H5Sclose(space);
  H5Tclose(variable);
  H5Oclose(object);
  return 0;
}

void make_older(const fs::path& file) {
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
  const hid_t hdf5 = H5Fopen(file.c_str(), H5F_ACC_RDWR, access);
  ASSERT_GE(hdf5, 0);
  H5Ovisit2(hdf5, H5_INDEX_NAME, H5_ITER_INC, make_texts_variable, nullptr, H5O_INFO_BASIC);
  H5Fclose(hdf5);
  H5Pclose(access);
}

/// Everything that is done with a recording. What is wrong with it is an exception.
void use(const fs::path& file) {
  try {
    const RecordingReader recording(file);
    static_cast<void>(recording.world_json());
    static_cast<void>(recording.scene());
    for (const RecordingReader::Array& array : recording.arrays()) {
      std::vector<std::byte> frame(array.bodies.size() * array.row_bytes());
      for (std::size_t f = 0; f < recording.frames(); ++f) recording.read(array, f, frame);
      static_cast<void>(recording.has(array));
    }
    static_cast<void>(replay_data(recording, {}));
  } catch (const Hdf5Error&) {
  } catch (const InputError&) {
  }
  try {
    repair_recording(file);
  } catch (const std::runtime_error&) {
  }
}

class DamagedRecording : public test::ScratchTest {
 protected:
  /// The signal that ends a process that uses these bytes; 0: none does.
  int signal_of(const std::string& bytes) const {
    const fs::path file = write("flipped.h5", bytes);
    const pid_t child = fork();
    if (child == 0) {
      alarm(240);  // a hang is none of the answers either
      use(file);
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  }
  static std::string flipped(std::string bytes, std::size_t bit) {
    bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ (1 << bit % 8));
    return bytes;
  }

  fs::path file_ = folder_ / "run.h5";
};

TEST_F(DamagedRecording, NoFlippedBitEndsTheProgram) {
  RecordingByHand().write(file_);
  std::string bytes = content(file_);
  EXPECT_EQ(bytes.find("GCOL"), bytes.npos) << "texts lie where no checksum protects them";
  std::mt19937 random(1);
  for (int i = 0; i < 100; ++i) {
    const std::size_t bit = random() % (8 * bytes.size());
    EXPECT_EQ(signal_of(flipped(bytes, bit)), 0) << "bit " << bit;
  }
}

TEST_F(DamagedRecording, NoFlippedBitOfAnOlderOneDoesEither) {
  RecordingByHand().write(file_);
  make_older(file_);
  const std::string bytes = content(file_);
  const std::size_t heap = bytes.find("GCOL");
  ASSERT_NE(heap, bytes.npos);
  for (std::size_t bit = 8 * heap; bit < 8 * heap + 4000;
       bit += 29)  // the heads of its texts, and some texts
    EXPECT_EQ(signal_of(flipped(bytes, bit)), 0) << "bit " << bit;
  EXPECT_EQ(signal_of(bytes.substr(0, heap + 100)), 0);
}

TEST_F(DamagedRecording, AnOlderOneIsReadAsItWas) {
  RecordingByHand().write(file_);
  make_older(file_);
  const RecordingReader recording(file_);
  EXPECT_EQ(recording.meta().at("seed"), "5");
  EXPECT_EQ(recording.meta().at("kind"), "troupe recording");
  ASSERT_EQ(recording.arrays().size(), 2u);
  EXPECT_EQ(recording.arrays()[1].field.unit, "m");
  EXPECT_EQ(recording.arrays()[1].field.text, "a number");
}

TEST_F(DamagedRecording, LongTextsAndThoseBehindAUserBlock) {
  const std::string longer(100000, 'x');
  {
    Hdf5File file = Hdf5File::create_in_memory(file_, 512);  // as checkpoints are made
    file.set_text("short", "s");
    file.set_text("longer", longer);
    const std::vector<std::byte> image = file.image();
    write("run.h5", {reinterpret_cast<const char*>(image.data()), image.size()});
  }
  const Hdf5File file = Hdf5File::open(file_);
  EXPECT_EQ(file.text("short"), "s");
  EXPECT_EQ(file.text("longer"), longer);
}

TEST_F(DamagedRecording, ATextThatIsNotThereIsAnError) {
  RecordingByHand().write(file_);
  make_older(file_);
  std::string bytes = content(file_);
  bytes[bytes.find("GCOL")] = 'X';
  write("run.h5", bytes);
  EXPECT_THAT(test::message_of<Hdf5Error>([&] { RecordingReader recording(file_); }),
              ::testing::HasSubstr("whose string is missing: the file is damaged"));
}

}  // namespace
}  // namespace troupe::worldio::damaged_recording_test

#endif
