#include "apps/csv.hpp"

#include "apps/outputs.hpp"
#include "tests/support/scratch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace troupe::apps {
namespace {

using ::testing::HasSubstr;

using Csv = test::ScratchTest;

TEST_F(Csv, NumbersAreTheShortestThatAreReadBackAlike) {
  const std::filesystem::path file = folder_ / "t.csv";
  CsvFile csv(file, "tick,a");
  csv.add(std::uint64_t{18446744073709551615u}).add(0.1).add(0.1 + 0.2).add(12.0).add(-0.0).add(1e-300);
  csv.add(-std::numeric_limits<double>::denorm_min()).add(std::nextafter(1.0, 2.0));
  csv.add(std::nan("")).add(-std::nan("")).add(std::numeric_limits<double>::infinity());
  csv.end_line();
  csv.flush(0);
  EXPECT_EQ(
      content(file),
      "tick,a\n18446744073709551615,0.1,0.30000000000000004,12,-0,1e-300,-5e-324,1.0000000000000002,nan,"
      "nan,inf\n");
}

TEST_F(Csv, TextsStandInQuotesWhereTheyNeedThem) {
  EXPECT_EQ(csv_cell("r17.left:0"), "r17.left:0");
  EXPECT_EQ(csv_cell("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_cell("say \"hi\""), "\"say \"\"hi\"\"\"");
  EXPECT_EQ(csv_cell("two\nlines"), "\"two\nlines\"");
  EXPECT_EQ(csv_cell(""), "");
}

/// The table after it was gone on with from a tick, with one more line.
class GoneOnWith : public Csv {
 protected:
  std::string table(const std::string& before, std::uint64_t keep_before) {
    const std::filesystem::path file = write("t.csv", before);
    CsvFile csv(file, "tick,a", keep_before);
    csv.add(keep_before).add(0.5).end_line();
    csv.flush(keep_before);
    return content(file);
  }
};

TEST_F(GoneOnWith, LinesFromTheTickOnAreDropped) {
  EXPECT_EQ(table("tick,a\n0,1\n5,2\n10,3\n15,4\n", 10), "tick,a\n0,1\n5,2\n10,0.5\n");
  EXPECT_EQ(table("tick,a\n0,1\n5,2\n", 10), "tick,a\n0,1\n5,2\n10,0.5\n");
  EXPECT_EQ(table("tick,a\n12,1\n", 10), "tick,a\n10,0.5\n");
  EXPECT_EQ(table("tick,a\n", 10), "tick,a\n10,0.5\n");
}

TEST_F(GoneOnWith, ALineThatWasCutOffIsDropped) {
  EXPECT_EQ(table("tick,a\n0,1\n5,2.3", 10), "tick,a\n0,1\n10,0.5\n");
  EXPECT_EQ(table("tick,a\n0,1\n1", 10), "tick,a\n0,1\n10,0.5\n");
}

TEST_F(GoneOnWith, WhatIsNotThereIsMade) {
  const std::filesystem::path file = folder_ / "new.csv";
  CsvFile csv(file, "tick,a", 7);
  csv.flush(7);
  EXPECT_EQ(content(file), "tick,a\n");
}

TEST_F(GoneOnWith, AnotherTableIsRefusedAndLeftAsItIs) {
  for (const char* other : {"tick,b\n0,1\n", "", "tick,a", "tick,a\nx,1\n"}) {
    const std::filesystem::path file = write("t.csv", other);
    try {
      const CsvFile csv(file, "tick,a", 10);
      ADD_FAILURE() << other;
    } catch (const OutputError& error) {
      EXPECT_THAT(
          error.what(),
          HasSubstr(
              "t.csv: error: cannot be written: this table cannot be continued after the checkpoint, "));
    }
    EXPECT_EQ(content(file), other);
  }
}

}  // namespace
}  // namespace troupe::apps
