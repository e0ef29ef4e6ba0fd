#include "apps/csv.hpp"

#include "apps/outputs.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/small_stack.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <limits>
#include <stdexcept>
#include <string>

namespace troupe::apps::csv_test {
namespace {

using ::testing::HasSubstr;

using Csv = test::ScratchTest;

TEST_F(Csv, NumbersAreTheShortestThatAreReadBackAlike) {
  const std::filesystem::path file = folder_ / "t.csv";
  CsvFile csv(file, "tick,a");
  csv.open();
  csv.add(std::uint64_t{18446744073709551615u}).add(0.1).add(0.1 + 0.2).add(12.0).add(-0.0).add(1e-300);
  csv.add(-std::numeric_limits<double>::denorm_min()).add(std::nextafter(1.0, 2.0)).add(1e5).add(0.0001);
  csv.add(std::nan("")).add(-std::nan("")).add(std::numeric_limits<double>::infinity());
  csv.end_line();
  csv.flush(0);
  EXPECT_EQ(content(file),
            "tick,a\n18446744073709551615,0.1,0.30000000000000004,12,-0,1e-300,-5e-324,1.0000000000000002,"
            "100000,0.0001,nan,nan,inf\n");
}

TEST_F(Csv, TimesAreRounded) {
  EXPECT_EQ(time_cell(3 * 0.1), "0.3");
  EXPECT_EQ(time_cell(120), "120");
}

TEST_F(Csv, AFullDiskLeavesWholeLines) {
  const std::filesystem::path file = folder_ / "t.csv";
  CsvFile csv(file, "tick,a");
  csv.open();
  csv.add(std::uint64_t{0}).add(1.0).end_line();
  csv.flush(0);
  const CsvFile::Start start = csv.before(1);
  for (int i = 0; i < 5000; ++i) csv.add(std::uint64_t{5}).add(2.0).end_line();
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1001, old.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  std::string error;
  try {
    csv.flush(5);
  } catch (const std::runtime_error& thrown) {
    error = thrown.what();
  }
  setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_EQ(error, file.string() + ": error: writing failed at tick 5: File too large");
  EXPECT_EQ(content(file), "tick,a\n0,1\n");
  EXPECT_EQ(csv.before(6), start);
  EXPECT_THROW(csv.flush(6), std::runtime_error);
  EXPECT_EQ(content(file), "tick,a\n0,1\n");
}

TEST_F(Csv, TextsStandInQuotesWhereTheyNeedThem) {
  EXPECT_EQ(csv_cell("r17.left:0"), "r17.left:0");
  EXPECT_EQ(csv_cell("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_cell("say \"hi\""), "\"say \"\"hi\"\"\"");
  EXPECT_EQ(csv_cell("two\nlines"), "\"two\nlines\"");
  EXPECT_EQ(csv_cell(""), "");
}

/// A table of two lines, and its start before the second line.
class GoneOnWith : public Csv {
 protected:
  GoneOnWith() {
    CsvFile csv(file_, "tick,a");
    csv.open();
    csv.add(std::uint64_t{0}).add(1.0).end_line();
    csv.flush(0);
    csv.add(std::uint64_t{5}).add(2.0).end_line();
    csv.flush(5);
    start_ = csv.before(5);
    whole_ = csv.before(6);
  }
  /// The table after one more line behind a start of it.
  std::string table(const CsvFile::Start& start) {
    const std::string before_opening = content(file_);
    CsvFile csv(file_, "tick,a", start);
    EXPECT_EQ(content(file_), before_opening);
    csv.open();
    csv.add(std::uint64_t{7}).add(0.5).end_line();
    csv.flush(7);
    return content(file_);
  }

  const std::filesystem::path file_ = folder_ / "t.csv";
  CsvFile::Start start_, whole_;
};

TEST_F(GoneOnWith, KeepsTheStartAndDropsTheRest) {
  const std::string before = content(file_);
  EXPECT_EQ(table(whole_), before + "7,0.5\n");
  EXPECT_EQ(table(start_), "tick,a\n0,1\n7,0.5\n");
  write("t.csv", before + "6,3\n12,0.");
  EXPECT_EQ(table(whole_), before + "7,0.5\n");
  EXPECT_EQ(table(CsvFile::Start()), "tick,a\n7,0.5\n");
}

TEST_F(GoneOnWith, IsReadOnASmallStack) {
  test::on_small_stack([&] { EXPECT_EQ(CsvFile(file_, "tick,a", whole_).before(0), whole_); });
}

TEST_F(GoneOnWith, HasTheStartThatItHadWithoutABreak) {
  {
    CsvFile csv(file_, "tick,a", start_);
    csv.open();
    csv.add(std::uint64_t{5}).add(2.0).end_line();
    csv.flush(5);
    EXPECT_EQ(csv.before(5), start_);
    EXPECT_EQ(csv.before(6), whole_);
  }
  EXPECT_NE(start_, whole_);
}

TEST_F(GoneOnWith, AnotherTableIsRefusedAndLeftAsItIs) {
  const auto refused = [&](const std::string& other, const std::optional<CsvFile::Start>& start,
                           const std::string& reason) {
    write("t.csv", other);
    try {
      const CsvFile csv(file_, "tick,a", start);
      ADD_FAILURE() << other;
    } catch (const OutputError& error) {
      EXPECT_THAT(error.what(),
                  HasSubstr("t.csv: error: cannot be written: this table cannot be continued after the "
                            "checkpoint, because " +
                            reason + ": choose another file"));
    }
    EXPECT_EQ(content(file_), other);
  };
  for (const char* other : {"tick,b\n0,1\n", "", "tick,a"})
    refused(other, start_, "its first line is not \"tick,a\"");
  refused("tick,a\n0,1\n", std::nullopt, "the checkpoint was saved by a run without this table");
  for (const char* other : {"tick,a\n0,3\n", "tick,a\n0,", "tick,a\n"})
    refused(other, start_, "it is not the table that the run had written when the checkpoint was saved");
}

}  // namespace
}  // namespace troupe::apps::csv_test
