#include "engine/fields/state_table.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cstdint>
#include <cstring>
#include <numeric>
#include <set>
#include <span>
#include <vector>

namespace troupe::engine::state_table_test {
namespace {

using Layout = StateTable::Layout;

const std::vector<StateField> k_fields{
    {"flag", Element::u8, 1, "", ""},     {"x", Element::f64, 1, "m", ""},
    {"ranges", Element::f32, 3, "m", ""}, {"count", Element::i32, 1, "", ""},
    {"small", Element::u8, 2, "", ""},    {"ticks", Element::u64, 1, "", ""},
    {"signed", Element::i64, 1, "", ""},  {"word", Element::u32, 1, "", ""}};
const std::vector<BodyId> k_ids{BodyId(4), BodyId(7), BodyId(1000)};

/// The same values into any layout: a pattern that differs from row to row and field to field.
void fill(StateTable& table) {
  for (std::size_t r = 0; r < table.rows(); ++r) {
    const int n = 10 * static_cast<int>(r) + 1;
    table.cell<std::uint8_t>(r, 0)[0] = static_cast<std::uint8_t>(n);
    table.cell<double>(r, 1)[0] = n + 0.5;
    for (int k = 0; k < 3; ++k)
      table.cell<float>(r, 2)[static_cast<std::size_t>(k)] = static_cast<float>(n + k) / 8;
    table.cell<std::int32_t>(r, 3)[0] = -n;
    table.cell<std::uint8_t>(r, 4)[1] = static_cast<std::uint8_t>(n + 1);
    table.cell<std::uint64_t>(r, 5)[0] = static_cast<std::uint64_t>(n) << 40;
    table.cell<std::int64_t>(r, 6)[0] = -n * 1'000'000'000'000;
    table.cell<std::uint32_t>(r, 7)[0] = 0xFFFFFFF0u + static_cast<unsigned>(n % 10);
  }
}

std::vector<std::uint64_t> hashes(const StateTable& table) {
  std::vector<std::uint64_t> all;
  for (std::size_t r = 0; r < table.rows(); ++r) all.push_back(table.hash_row(r));
  return all;
}

/// Fields as a struct packs them, with room between.
struct Padded {
  std::uint64_t ticks;
  std::uint8_t flag;
  std::uint8_t small[2];
  double x;
  std::int32_t count;
  std::int64_t whole;
  float ranges[3];
  std::uint32_t word;
  char rest[20];
};
std::vector<StateField> packed_fields() {
  std::vector<StateField> fields = k_fields;
  const std::size_t offsets[]{offsetof(Padded, flag),  offsetof(Padded, x),     offsetof(Padded, ranges),
                              offsetof(Padded, count), offsetof(Padded, small), offsetof(Padded, ticks),
                              offsetof(Padded, whole), offsetof(Padded, word)};
  for (std::size_t f = 0; f < fields.size(); ++f) fields[f].offset = static_cast<std::uint32_t>(offsets[f]);
  return fields;
}

TEST(FieldNamed, IsTheElementWithThisName) {
  const StateField* const found = field_named(k_fields, k_fields[2].name);
  EXPECT_EQ(found, &k_fields[2]);
  EXPECT_EQ(field_named(k_fields, "nothing"), nullptr);
  EXPECT_EQ(field_named({}, ""), nullptr);
}

TEST(StateTable, HashesAlikeInEveryLayout) {
  StateTable columns("pose", HashGroup::pose, Layout::columns, k_fields, k_ids);
  StateTable rows("pose", HashGroup::pose, Layout::rows, k_fields, k_ids);
  StateTable packed("pose", HashGroup::pose, Layout::rows, packed_fields(), k_ids, sizeof(Padded));
  // Whatever lies between the fields is no state.
  for (std::size_t r = 0; r < k_ids.size(); ++r) {
    std::memset(packed.row(r), 0xA5, sizeof(Padded));
    packed.cell<std::uint8_t>(r, 4)[0] = 0;
  }
  fill(columns);
  fill(rows);
  fill(packed);
  EXPECT_EQ(hashes(columns), hashes(rows));
  EXPECT_EQ(hashes(columns), hashes(packed));
}

TEST(StateTable, HashDoesNotDependOnTheRow) {
  StateTable table("pose", HashGroup::pose, Layout::columns, k_fields, k_ids);
  fill(table);
  // The same bodies stored the other way round.
  StateTable other("pose", HashGroup::pose, Layout::columns, k_fields, {k_ids[2], k_ids[1], k_ids[0]});
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t f = 0; f < k_fields.size(); ++f) {
      const std::size_t bytes = element_size(k_fields[f].element) * k_fields[f].columns;
      std::memcpy(other.cell<std::byte>(2 - r, f).data(), table.cell<std::byte>(r, f).data(), bytes);
    }
  }
  EXPECT_EQ(table.hash_row(0), other.hash_row(2));
  EXPECT_EQ(table.hash_row(1), other.hash_row(1));
  EXPECT_EQ(table.hash_row(2), other.hash_row(0));
}

TEST(StateTable, RowsMoveWithTheirBodies) {
  for (const Layout layout : {Layout::columns, Layout::rows}) {
    StateTable table("thing", HashGroup::sensor, layout, k_fields, k_ids);
    fill(table);
    const std::vector<std::uint64_t> before = hashes(table);
    table.move_rows(std::vector<std::uint32_t>{2, 0, 1});
    EXPECT_EQ(table.ids()[0], k_ids[1]);
    EXPECT_EQ(table.ids()[1], k_ids[2]);
    EXPECT_EQ(table.ids()[2], k_ids[0]);
    EXPECT_EQ(hashes(table), (std::vector<std::uint64_t>{before[1], before[2], before[0]}));
    EXPECT_EQ(table.cell<double>(2, 1)[0], 1.5);
  }
}

TEST(StateTable, HashSeesEveryBitOfEveryField) {
  for (const Layout layout : {Layout::columns, Layout::rows}) {
    StateTable table("pose", HashGroup::pose, layout, k_fields, k_ids);
    fill(table);
    const std::vector<std::uint64_t> before = hashes(table);
    std::set<std::uint64_t> seen{before[1]};
    for (std::size_t f = 0; f < k_fields.size(); ++f) {
      for (std::size_t byte = 0; byte < element_size(k_fields[f].element) * k_fields[f].columns; ++byte) {
        for (int bit = 0; bit < 8; ++bit) {
          std::byte& b = table.cell<std::byte>(1, f).data()[byte];
          b ^= std::byte(1 << bit);
          EXPECT_TRUE(seen.insert(table.hash_row(1)).second)
              << k_fields[f].name << ", byte " << byte << ", bit " << bit;
          EXPECT_EQ(table.hash_row(0), before[0]);
          EXPECT_EQ(table.hash_row(2), before[2]);
          b ^= std::byte(1 << bit);
        }
      }
    }
    EXPECT_EQ(hashes(table), before);
  }
}

TEST(StateTable, HashSeesIdAndComponent) {
  std::set<std::uint64_t> seen;
  for (const char* component : {"pose", "pos", "velocity", ""}) {
    for (const std::size_t id : {0, 1, 2, 256, 70'000}) {
      const StateTable table(component, HashGroup::pose, Layout::columns, k_fields, {BodyId(id)});
      EXPECT_TRUE(seen.insert(table.hash_row(0)).second) << component << ' ' << id;
    }
  }
  // Groups are columns of the log, no part of the state.
  const StateTable pose("pose", HashGroup::pose, Layout::columns, k_fields, k_ids);
  const StateTable memory("pose", HashGroup::memory, Layout::columns, k_fields, k_ids);
  EXPECT_EQ(hashes(pose), hashes(memory));
}

TEST(StateTable, ASparseFieldThatIsZeroIsAsIfItWereNotThere) {
  for (const Layout layout : {Layout::columns, Layout::rows}) {
    std::vector<StateField> fields = k_fields;
    fields.push_back({"mode", Element::u8, 1, "", ""});
    fields.push_back({"goal", Element::f64, 2, "m", ""});
    for (std::size_t f = k_fields.size(); f < fields.size(); ++f) fields[f].sparse = true;
    StateTable without("command", HashGroup::velocity, layout, k_fields, k_ids);
    StateTable with("command", HashGroup::velocity, layout, fields, k_ids);
    fill(without);
    fill(with);
    const std::vector<std::uint64_t> before = hashes(without);
    EXPECT_EQ(hashes(with), before);
    // Every bit of it counts, for its own row alone; -0 is not zero.
    std::set<std::uint64_t> seen{before[1]};
    for (std::size_t f = k_fields.size(); f < fields.size(); ++f)
      for (std::size_t byte = 0; byte < element_size(fields[f].element) * fields[f].columns; ++byte)
        for (int bit = 0; bit < 8; ++bit) {
          std::byte& b = with.cell<std::byte>(1, f).data()[byte];
          b = std::byte(1 << bit);
          EXPECT_TRUE(seen.insert(with.hash_row(1)).second) << fields[f].name << " bit " << bit;
          EXPECT_EQ(with.hash_rows(0, 3), before[0] + with.hash_row(1) + before[2]);
          b = std::byte{0};
        }
    EXPECT_EQ(hashes(with), before);
  }
}

TEST(StateTable, RowsOfASparseComponentThatAreAllZeroAddNothing) {
  for (const Layout layout : {Layout::columns, Layout::rows}) {
    StateTable table("charge", HashGroup::memory, layout, sparse(k_fields), k_ids);
    EXPECT_EQ(table.hash_rows(0, 3), 0u);
    table.cell<float>(1, 2)[1] = 1;
    const std::uint64_t second = table.hash_row(1);
    EXPECT_NE(second, 0u);
    EXPECT_EQ(table.hash_rows(0, 3), second);
    // The same value of another row, and of another field, is another hash.
    table.cell<float>(1, 2)[1] = 0;
    table.cell<float>(2, 2)[1] = 1;
    EXPECT_NE(table.hash_row(2), second);
    table.clear();
    table.cell<float>(1, 2)[2] = 1;
    EXPECT_NE(table.hash_row(1), second);
    table.clear();
    EXPECT_EQ(table.hash_rows(0, 3), 0u);
  }
  const StateTable empty("charge", HashGroup::memory, Layout::columns, sparse(k_fields), {});
  EXPECT_EQ(empty.hash_rows(0, 0), 0u);
}

TEST(StateTable, StartsAtZeroAndCountsItsRows) {
  for (const Layout layout : {Layout::columns, Layout::rows}) {
    const StateTable table("pose", HashGroup::sensor, layout, k_fields, k_ids);
    EXPECT_EQ(table.rows(), 3u);
    EXPECT_EQ(table.component(), "pose");
    EXPECT_EQ(table.group(), HashGroup::sensor);
    for (std::size_t f = 0; f < k_fields.size(); ++f)
      for (std::size_t r = 0; r < 3; ++r) {
        ASSERT_EQ(table.cell<std::byte>(r, f).size(), k_fields[f].columns);
        EXPECT_EQ(table.cell<std::byte>(r, f)[0], std::byte{0});
      }
    const StateTable empty("pose", HashGroup::sensor, layout, k_fields, {});
    EXPECT_EQ(empty.rows(), 0u);
    EXPECT_EQ(empty.bytes(), 0u);
  }
}

TEST(StateTable, FieldsOfARowDoNotShareBytesAndAreAligned) {
  for (const Layout layout : {Layout::columns, Layout::rows}) {
    StateTable table("pose", HashGroup::pose, layout, k_fields, k_ids);
    std::set<const std::byte*> taken;
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t f = 0; f < k_fields.size(); ++f) {
        const std::byte* start = table.cell<std::byte>(r, f).data();
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(start) % element_size(k_fields[f].element), 0u)
            << k_fields[f].name;
        for (std::size_t b = 0; b < element_size(k_fields[f].element) * k_fields[f].columns; ++b)
          EXPECT_TRUE(taken.insert(start + b).second);
      }
    }
    EXPECT_LE(taken.size(), table.bytes());
  }
}

TEST(StateTable, RoomFollowsTheRows) {
  std::vector<BodyId> ids;
  for (std::uint32_t i = 0; i < 1000; ++i) ids.emplace_back(3 * i);
  for (const Layout layout : {Layout::columns, Layout::rows}) {
    std::vector<StateField> fields = k_fields;
    fields[3].sparse = true;
    StateTable table("pose", HashGroup::pose, layout, fields, ids);
    fill(table);
    const std::vector<std::uint64_t> expected = hashes(table);
    const std::size_t bytes = table.bytes();
    const auto expect_first = [&](std::size_t count) {
      ASSERT_EQ(table.rows(), count);
      for (std::size_t r = 0; r < count; ++r) EXPECT_EQ(table.hash_row(r), expected[r]) << "row " << r;
      EXPECT_EQ(table.hash_rows(0, count), std::accumulate(expected.begin(), expected.begin() + count, 0ull));
    };
    table.change_capacity(1000);
    EXPECT_EQ(table.bytes(), bytes) << "enough room";
    table.keep_rows(700);
    table.change_capacity(700);
    EXPECT_EQ(table.bytes(), bytes) << "little would be freed";
    table.keep_rows(100);
    table.change_capacity(100);
    EXPECT_LT(table.bytes(), bytes / 8);
    expect_first(100);

    table.change_capacity(400);
    EXPECT_LT(table.bytes(), bytes / 2);
    table.add_rows(std::span(ids).subspan(100, 300));
    for (std::size_t f = 0; f < fields.size(); ++f)
      for (const std::byte byte : table.cell<std::byte>(399, f)) EXPECT_EQ(byte, std::byte{0});
    fill(table);
    expect_first(400);

    table.keep_rows(0);
    table.change_capacity(0);
    EXPECT_EQ(table.bytes(), 0u);
    table.change_capacity(1000);
    table.add_rows(ids);
    fill(table);
    expect_first(1000);
  }
}

TEST(StateTable, AColumnIsOneSpan) {
  StateTable table("pose", HashGroup::pose, Layout::columns, k_fields, k_ids);
  fill(table);
  EXPECT_EQ(table.column<double>(1).size(), 3u);
  EXPECT_EQ(table.column<double>(1)[2], 21.5);
  EXPECT_EQ(table.column<float>(2).size(), 9u);
  EXPECT_EQ(table.column<float>(2)[5], 13.0f / 8);
}

// A row of many columns, larger than what is gathered on the stack.
RC_GTEST_PROP(StateTable, HashesWideRows, (std::vector<float> values)) {
  values.push_back(1);
  for (const std::size_t columns : {values.size(), values.size() + 1000}) {
    const std::vector<StateField> fields{
        {"ranges", Element::f32, static_cast<std::uint32_t>(columns), "m", ""}};
    StateTable a("ranger/r", HashGroup::sensor, Layout::columns, fields, {BodyId(1)});
    StateTable b("ranger/r", HashGroup::sensor, Layout::rows, fields, {BodyId(1)});
    std::memcpy(a.cell<float>(0, 0).data(), values.data(), values.size() * sizeof(float));
    std::memcpy(b.cell<float>(0, 0).data(), values.data(), values.size() * sizeof(float));
    RC_ASSERT(a.hash_row(0) == b.hash_row(0));
    b.cell<float>(0, 0)[columns - 1] += 1;
    RC_ASSERT(a.hash_row(0) != b.hash_row(0));
  }
}

TEST(Element, NamesAreThoseOfNumpy) {
  EXPECT_EQ(element_name(Element::f64), "float64");
  EXPECT_EQ(element_name(Element::u8), "uint8");
  EXPECT_EQ(element_name(element_of<float>()), "float32");
  EXPECT_EQ(element_name(element_of<std::int64_t>()), "int64");
  EXPECT_EQ(element_name(element_of<std::int32_t>()), "int32");
  EXPECT_EQ(element_name(element_of<std::uint64_t>()), "uint64");
  EXPECT_EQ(element_name(element_of<std::uint32_t>()), "uint32");
  EXPECT_EQ(element_name(element_of<bool>()), "uint8");
  EXPECT_EQ(element_size(element_of<bool>()), sizeof(bool));
}

TEST(StateTable, ComponentsOfDevicesHaveTheNamesThatTheWorldGives) {
  EXPECT_EQ(given_name("pose"), "pose");
  EXPECT_EQ(given_name("ranger/eye"), "eye");
  EXPECT_EQ(given_name("led/lamp/command"), "lamp/command");
  EXPECT_EQ(given_name("sensors/minibot/eye"), "eye");
  EXPECT_EQ(given_name("wander/0"), "wander/0");
  for (const char* name : {"ranger/eye", "ranger", "eye"}) EXPECT_TRUE(selects(name, "ranger/eye")) << name;
  for (const char* name : {"ranger/ey", "eyes", "", "ranger/"})
    EXPECT_FALSE(selects(name, "ranger/eye")) << name;
  EXPECT_FALSE(selects("0", "wander/0"));
}

}  // namespace
}  // namespace troupe::engine::state_table_test
