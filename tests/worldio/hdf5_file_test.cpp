#include "worldio/results/hdf5_file.hpp"

#include "tests/support/message_of.hpp"
#include "tests/support/scratch.hpp"
#include "worldio/results/descriptor.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <numeric>
#include <string>
#include <utility>

namespace troupe::worldio::hdf5_file_test {
namespace {

namespace fs = std::filesystem;
using engine::Element;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

class Hdf5 : public test::ScratchTest {
 protected:
  void SetUp() override {
    if (!has_hdf5()) GTEST_SKIP() << "built without HDF5";
  }
  template <class Call>
  static std::string error_of(Call&& call) {
    return test::message_of<Hdf5Error>(std::forward<Call>(call));
  }

  fs::path file_ = folder_ / "a.h5";
};

template <class T>
std::vector<T> counted(std::size_t n) {
  std::vector<T> values(n);
  std::iota(values.begin(), values.end(), T(0));
  return values;
}

template <class T>
void write_and_read(Hdf5Group group, const std::string& name) {
  const std::vector<T> values = counted<T>(12);
  Hdf5Dataset dataset = group.create_dataset(name, engine::element_of<T>(), {3, 4});
  dataset.write(std::span<const T>(values));
  EXPECT_EQ(dataset.element(), engine::element_of<T>());
  EXPECT_THAT(dataset.extent(), ElementsAre(3, 4));
  EXPECT_EQ(group.dataset(name).read<T>(), values);
  std::vector<T> row(4);
  group.dataset(name).read_rows(1, std::span<T>(row));
  EXPECT_THAT(row, ElementsAre(T(4), T(5), T(6), T(7)));
}

TEST_F(Hdf5, EveryElementTypeComesBackAsItWent) {
  Hdf5File file = Hdf5File::create(file_);
  Hdf5Group group = file.create_group("numbers");
  write_and_read<double>(file.group("numbers"), "f64");
  write_and_read<float>(file.group("numbers"), "f32");
  write_and_read<std::int64_t>(file.group("numbers"), "i64");
  write_and_read<std::int32_t>(file.group("numbers"), "i32");
  write_and_read<std::uint64_t>(file.group("numbers"), "u64");
  write_and_read<std::uint32_t>(file.group("numbers"), "u32");
  write_and_read<std::uint8_t>(file.group("numbers"), "u8");
  EXPECT_THAT(group.names(), ElementsAre("f32", "f64", "i32", "i64", "u32", "u64", "u8"));
  EXPECT_TRUE(file.has_group("numbers"));
  EXPECT_FALSE(group.has_group("f64"));
  EXPECT_FALSE(group.has("f16"));
}

TEST_F(Hdf5, BitsOfNumbersStay) {
  const std::vector<std::uint64_t> bits = {0x7ff8000000000123, 0x8000000000000000, 1, 0xfff0000000000000};
  std::vector<double> values(bits.size());
  std::memcpy(values.data(), bits.data(), bits.size() * 8);
  {
    Hdf5File file = Hdf5File::create(file_);
    file.write("values", std::span<const double>(values));
    file.close();
  }
  const std::vector<double> back = Hdf5File::open(file_).dataset("values").read<double>();
  EXPECT_EQ(std::memcmp(back.data(), bits.data(), bits.size() * 8), 0);
}

TEST_F(Hdf5, BytesOfAnElementThatIsKnownAtRunTime) {
  const std::vector<float> values = counted<float>(6);
  Hdf5File file = Hdf5File::create(file_);
  Hdf5Dataset dataset = file.create_dataset("v", Element::f32, {3, 2});
  dataset.write_bytes(std::as_bytes(std::span(values)));
  std::vector<float> last(2);
  dataset.read_bytes(2, std::as_writable_bytes(std::span(last)));
  EXPECT_THAT(last, ElementsAre(4, 5));
}

TEST_F(Hdf5, AttributesAndTexts) {
  const std::vector<std::string> names = {"r0", "", "a robot with a long name", "grün"};
  {
    Hdf5File file = Hdf5File::create(file_);
    file.set_text("version", "troupe 1");
    file.set_text("empty", "");
    file.set_text("set /populations/0/count", "5");
    file.set_integer("layout", -3);
    file.set_number("tick_s", 0.1);
    file.write_text("world", "{\"a\": 1}");
    file.write_texts("names", names);
    file.write_texts("none", {});
    file.close();
  }
  const Hdf5File file = Hdf5File::open(file_);
  EXPECT_EQ(file.text("version"), "troupe 1");
  EXPECT_EQ(file.text("empty"), "");
  EXPECT_EQ(file.text("set /populations/0/count"), "5");
  EXPECT_EQ(file.integer("layout"), -3);
  EXPECT_EQ(file.number("tick_s"), 0.1);
  EXPECT_THAT(file.attributes(),
              ElementsAre("empty", "layout", "set /populations/0/count", "tick_s", "version"));
  EXPECT_EQ(file.read_text("world"), "{\"a\": 1}");
  EXPECT_EQ(file.read_texts("names"), names);
  EXPECT_THAT(file.read_texts("none"), IsEmpty());
  EXPECT_THAT(error_of([&] { file.text("seed"); }), HasSubstr("a.h5: error: / has no attribute \"seed\""));
  EXPECT_THAT(error_of([&] { file.text("layout"); }), HasSubstr("that is not a string"));
  EXPECT_THAT(error_of([&] { file.integer("tick_s"); }), HasSubstr("that is not an integer"));
  EXPECT_THAT(error_of([&] { file.number("layout"); }), HasSubstr("that is not a number"));
  EXPECT_THAT(error_of([&] { file.read_text("names"); }), HasSubstr("/names must contain one string, but "
                                                                    "contains "));
}

TEST_F(Hdf5, RowsAreAppendedAndCutOff) {
  {
    Hdf5File file = Hdf5File::create(file_);
    Hdf5Dataset x = file.create_extendible("x", Element::f64, {2, 1}, {.extent = {4, 2, 1}});
    Hdf5Dataset tick = file.create_extendible("tick", Element::u64, {}, {.extent = {4}, .fill = ~0ull});
    const std::vector<double> values = counted<double>(10);
    x.append(std::span<const double>(values).first(4));
    x.append(std::span<const double>(values).subspan(4));
    EXPECT_THAT(x.extent(), ElementsAre(5, 2, 1));
    x.resize(4);
    x.resize(6);
    tick.append(std::span<const std::uint64_t>());
    tick.resize(2);
    EXPECT_THAT(error_of([&] { x.append(std::span<const double>(values).first(3)); }),
                HasSubstr("/x has rows of 2 values: 3 values are not a whole number of rows"));
  }
  const Hdf5File file = Hdf5File::open(file_);
  std::vector<double> row(2);
  file.dataset("x").read_rows(3, std::span<double>(row));
  EXPECT_THAT(row, ElementsAre(6, 7));
  file.dataset("x").read_rows(4, std::span<double>(row));
  EXPECT_TRUE(std::isnan(row[0]) && std::isnan(row[1]));
  EXPECT_THAT(file.dataset("tick").read<std::uint64_t>(), ElementsAre(~0ull, ~0ull));
}

TEST_F(Hdf5, NothingIsAnArrayToo) {
  Hdf5File file = Hdf5File::create(file_);
  Hdf5Dataset none = file.create_extendible("none", Element::f64, {0, 1}, {.extent = {4, 1, 1}});
  none.append(std::span<const double>());
  none.resize(3);
  EXPECT_EQ(none.values(), 0u);
  EXPECT_THAT(file.create_dataset("zero", Element::u8, {0}).read<std::uint8_t>(), IsEmpty());
}

TEST_F(Hdf5, AReaderFollowsAWriter) {
  Hdf5File file = Hdf5File::create(file_);
  Hdf5Dataset x = file.create_extendible("x", Element::u32, {}, {.extent = {16}});
  file.start_swmr();
  const std::vector<std::uint32_t> values = counted<std::uint32_t>(1000);
  for (std::size_t i = 0; i < 1000; i += 100) {
    x.append(std::span<const std::uint32_t>(values).subspan(i, 100));
    x.flush();
    const Hdf5File copy = [&] {
      // A copy is what a killed writer leaves; the file itself cannot be opened twice in one process.
      fs::copy_file(file_, folder_ / "copy.h5", fs::copy_options::overwrite_existing);
      return Hdf5File::open_swmr(folder_ / "copy.h5");
    }();
    std::vector<std::uint32_t> read(i + 100);
    copy.dataset("x").read_rows(0, std::span<std::uint32_t>(read));
    EXPECT_TRUE(std::equal(read.begin(), read.end(), values.begin())) << i;
  }
}

TEST_F(Hdf5, EqualContentsAreEqualBytes) {
  const auto made = [&](const char* name) {
    Hdf5File file = Hdf5File::create(folder_ / name);
    Hdf5Group group = file.create_group("group");
    group.set_integer("one", 1);
    group.write("v", std::span<const float>(counted<float>(100)));
    file.write_text("world", "{}");
    Hdf5Dataset x = group.create_extendible("x", Element::u32, {}, {.extent = {16}});
    x.append(std::span<const std::uint32_t>(counted<std::uint32_t>(100)));
    std::ifstream stream(folder_ / name, std::ios::binary);
    return folder_ / name;
  };
  const auto bytes = [](const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  EXPECT_EQ(bytes(made("one.h5")), bytes(made("two.h5")));
}

TEST_F(Hdf5, AUserBlockIsLeftAlone) {
  { Hdf5File::create(file_, 512).write("v", std::span<const float>(counted<float>(3))); }
  std::fstream(file_, std::ios::binary | std::ios::in | std::ios::out) << "troupe";
  EXPECT_THAT(Hdf5File::open(file_).dataset("v").read<float>(), ElementsAre(0, 1, 2));
}

TEST_F(Hdf5, AFileThatIsOpenElsewhereIsLocked) {
  Hdf5File::create(file_).close();
  const Descriptor other(file_, O_RDONLY);
  const std::string locked = file_.string() +
                             ": error: is locked, because it is open elsewhere, for example "
                             "in a notebook: close it there";
  ASSERT_EQ(flock(other.get(), LOCK_SH), 0);  // as a reader
  Hdf5File::open(file_).close();
  EXPECT_EQ(error_of([&] { Hdf5File::open_to_write(file_); }), locked);
  ASSERT_EQ(flock(other.get(), LOCK_EX), 0);  // as a writer
  EXPECT_EQ(error_of([&] { Hdf5File::open(file_); }), locked);
}

TEST_F(Hdf5, ErrorsNameTheFileAndTheReason) {
  const fs::path none = folder_ / "none.h5";
  EXPECT_EQ(error_of([&] { Hdf5File::open(none); }), none.string() + ": error: there is no such file");
  EXPECT_THAT(error_of([&] { Hdf5File::create(folder_ / "no" / "folder.h5"); }),
              AllOf(StartsWith((folder_ / "no" / "folder.h5").string() + ": error: cannot be written: "),
                    HasSubstr("there is no folder " + (folder_ / "no").string())));
  std::ofstream(none) << "no HDF5 at all";
  EXPECT_THAT(error_of([&] { Hdf5File::open(none); }), HasSubstr("none.h5: error: cannot be read: "));

  Hdf5File file = Hdf5File::create(file_);
  file.write("v", std::span<const float>(counted<float>(3)));
  EXPECT_THAT(error_of([&] { file.dataset("w"); }), HasSubstr("a.h5: error: there is no dataset /w"));
  EXPECT_THAT(error_of([&] { file.group("v"); }), HasSubstr("there is no group /v"));
  EXPECT_THAT(error_of([&] { file.dataset("v").read<double>(); }),
              HasSubstr("/v holds values of type float32, but must hold values of type float64"));
  std::vector<float> four(4);
  EXPECT_THAT(
      error_of([&] { file.dataset("v").read_rows(0, std::span<float>(four)); }),
      HasSubstr("/v has 3 rows of 1 values; cannot read 4 values from row 0 on (rows are counted from 0)"));
  EXPECT_THAT(error_of([&] { file.create_group("v"); }), HasSubstr("/v cannot be written"));
}

TEST_F(Hdf5, ADatasetThatCannotBeTrueIsNotAllocated) {
  Hdf5File file = Hdf5File::create(file_);
  Hdf5Dataset x = file.create_extendible("x", Element::f64, {}, {.extent = {16}});
  x.resize(std::size_t{1} << 40);
  EXPECT_THAT(error_of([&] { x.read<double>(); }),
              HasSubstr("/x claims to hold 1099511627776 values, which do not fit into the file"));
}

std::size_t resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::size_t total = 0;
  std::size_t resident = 0;
  statm >> total >> resident;
  return resident * 4096;
}

// What was written stays in no cache: HDF5's own would hold 1 MiB of each dataset.
TEST_F(Hdf5, WritingForLongTakesNoMoreMemory) {
  constexpr std::size_t k_datasets = 60;
  constexpr std::size_t k_row_bytes = 8192;
  Hdf5File file = Hdf5File::create(file_);
  std::vector<Hdf5Dataset> datasets;
  for (std::size_t d = 0; d < k_datasets; ++d)
    datasets.push_back(
        file.create_extendible(std::to_string(d), Element::u8, {k_row_bytes}, {.extent = {1, k_row_bytes}}));
  file.start_swmr();
  const std::vector<std::uint8_t> row(k_row_bytes, 7);
  const auto write = [&](int rows) {
    for (int r = 0; r < rows; ++r)
      for (Hdf5Dataset& dataset : datasets) {
        dataset.append(std::span<const std::uint8_t>(row));
        dataset.flush();
      }
  };
  write(10);
  const std::size_t before = resident_bytes();
  write(100);  // 48 MB
  EXPECT_LT(resident_bytes(), before + (std::size_t{12} << 20));
}

TEST_F(Hdf5, NamesAreOneStep) {
  EXPECT_EQ(hdf5_name("ranger:0"), "ranger:0");
  EXPECT_EQ(hdf5_name("/x%"), "%2Fx%25");
  EXPECT_EQ(hdf5_name("."), "%2E");
  EXPECT_EQ(hdf5_name(""), "%");
  for (const char* text : {"ranger:0", "/x%", "a%2Fb", ".", "..", "", "a.b"})
    EXPECT_EQ(text_of_hdf5_name(hdf5_name(text)), text);
  EXPECT_EQ(text_of_hdf5_name("x%2"), "x%2") << "a name that hdf5_name() does not return is unchanged";
}

TEST_F(Hdf5, ACopyHasTheContentWithoutTheSpaceOfRemovedRows) {
  constexpr std::size_t k_rows = 50000;
  const std::string long_text(70000, 'x');  // is stored with variable length
  {
    Hdf5File file = Hdf5File::create(file_);
    Hdf5Group group = file.create_group("state");
    group.set_text("kind", "a group");
    Hdf5Dataset rows =
        group.create_group("pose").create_extendible("x", Element::u64, {2}, {.extent = {100, 2}});
    rows.set_text("long", long_text);
    rows.set_integer("count", -3);
    rows.set_number("share", 0.25);
    const std::vector<std::uint64_t> values = counted<std::uint64_t>(2 * k_rows);
    rows.append(std::span<const std::uint64_t>(values));
    file.flush();
    rows.resize(10);
    file.write_texts("names", std::vector<std::string>{"one", "three"});
  }
  const Hdf5File file = Hdf5File::open(file_);
  EXPECT_THAT(file.paths(), ElementsAre("names", "state", "state/pose", "state/pose/x"));
  EXPECT_GT(file.unused_bytes(), 16 * k_rows / 2);
  const fs::path copy = folder_ / "copy.h5";
  Hdf5File::create(copy).copy_content(file);

  const Hdf5File copied = Hdf5File::open(copy);
  EXPECT_LT(copied.unused_bytes(), 100000u);
  EXPECT_LT(fs::file_size(copy), 200000u);
  EXPECT_EQ(copied.paths(), file.paths());
  EXPECT_EQ(copied.group("state").text("kind"), "a group");
  const Hdf5Dataset rows = copied.dataset("state/pose/x");
  EXPECT_EQ(rows.read<std::uint64_t>(), counted<std::uint64_t>(20));
  EXPECT_EQ(rows.text("long"), long_text);
  EXPECT_EQ(rows.integer("count"), -3);
  EXPECT_EQ(rows.number("share"), 0.25);
  EXPECT_THAT(copied.read_texts("names"), ElementsAre("one", "three"));
}

}  // namespace
}  // namespace troupe::worldio::hdf5_file_test
