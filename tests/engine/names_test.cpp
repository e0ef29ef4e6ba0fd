#include "engine/spec/names.hpp"

#include "base/random.hpp"

#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::engine::names_test {
namespace {

TEST(Names, EqualTextsAreEqualNamesAndComeBackWhole) {
  const std::vector<std::string> texts{"",
                                       "r",
                                       "r0",
                                       "r00",
                                       "r07",
                                       "r7",
                                       "r17",
                                       "r1000",
                                       "r01000",
                                       "r999999999",
                                       "0",
                                       "00",
                                       "7",
                                       "007",
                                       "position:3",
                                       "4294967295",
                                       "r4294967295",
                                       "r99999999999999999999",
                                       "r1x",
                                       "r1x2",
                                       "-1",
                                       "r 1",
                                       "\xc3\xa9"
                                       "5",
                                       "r10000000000"};
  Names names;
  std::vector<Name> made;
  for (const std::string& text : texts) made.push_back(names.add(text));
  for (std::size_t i = 0; i < texts.size(); ++i) {
    EXPECT_EQ(names.text(made[i]), texts[i]);
    EXPECT_EQ(names.find(texts[i]), made[i]) << texts[i];
    EXPECT_EQ(names.add(texts[i]), made[i]) << texts[i];
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(made[i], made[j]) << texts[i] << " and " << texts[j];
  }
  EXPECT_EQ(names.add(""), Name());
}

TEST(Names, OfAPopulationIsWhoseNameContinuesInDigits) {
  Names names;
  const auto is_of = [&](std::string_view name, std::string_view population) {
    const bool as_text = is_of_population(name, population);
    EXPECT_EQ(is_of_population(names, names.add(name), population), as_text) << name << " of " << population;
    return as_text;
  };
  EXPECT_TRUE(is_of("r0", "r"));
  EXPECT_TRUE(is_of("r007", "r"));
  EXPECT_TRUE(is_of("r217", "r2"));
  EXPECT_TRUE(is_of("r217", "r"));
  EXPECT_TRUE(is_of("r99999999999999999999", "r"));
  EXPECT_TRUE(is_of("r99999999999999999999", "r9999"));
  EXPECT_TRUE(is_of("r10x20", "r10x"));
  EXPECT_FALSE(is_of("r", "r"));
  EXPECT_FALSE(is_of("r2", "r2"));
  EXPECT_FALSE(is_of("r2", "r21"));
  EXPECT_FALSE(is_of("r10x20", "r10"));
  EXPECT_FALSE(is_of("truck1", "r"));
  EXPECT_FALSE(is_of("r1x", "r"));
  EXPECT_EQ(without_number("r217"), "r");
  EXPECT_EQ(without_number("r10x20"), "r10x");
  EXPECT_EQ(without_number("r"), "r");
  EXPECT_EQ(without_number("42"), "");
}

TEST(Names, ACrowdSharesItsWord) {
  Names names;
  EXPECT_EQ(names.add("r17").word, names.add("r", 5).word);
  EXPECT_EQ(names.add("r17").number, 17u);
}

TEST(Names, ANumberBehindATextIsTheTextWithTheNumber) {
  Names names;
  for (const std::string text : {"r", "", "r1", "r0", "7", "position:"})
    for (const std::uint32_t number : {0u, 7u, 10u, 999999999u, 1000000000u, 4294967295u})
      EXPECT_EQ(names.add(text, number), names.add(text + std::to_string(number))) << text << ' ' << number;
}

TEST(Names, AWordThatWasNeverAddedIsFoundInNoName) {
  Names names;
  names.add("r1");
  EXPECT_FALSE(names.find("s1").has_value());
  EXPECT_TRUE(names.find("r2").has_value());  // it may be a name: whether a body has it, a NameMap tells
}

TEST(NameMap, FindsWhatAStandardMapFinds) {
  NameMap map;
  EXPECT_FALSE(map.find({1, 2}).valid());
  std::map<std::pair<std::uint32_t, std::uint32_t>, BodyId> oracle;
  Random random(1, 2, 3, 4);
  for (std::size_t i = 0; i < 20000; ++i) {
    const Name name{random.below(5), random.below(10) == 0 ? Name::k_no_number : random.below(4000)};
    const BodyId body(i);
    if (random.below(2) == 0) {
      map.set(name, body);
      oracle[{name.word, name.number}] = body;
    } else {
      EXPECT_EQ(map.add(name, body), oracle.emplace(std::pair(name.word, name.number), body).first->second);
    }
  }
  EXPECT_EQ(map.size(), oracle.size());
  for (std::uint32_t word = 0; word < 6; ++word)
    for (std::uint32_t number = 0; number < 4100; ++number) {
      const auto found = oracle.find({word, number});
      EXPECT_EQ(map.find({word, number}), found == oracle.end() ? BodyId() : found->second);
    }
}

TEST(Names, OfTheSameWordsAreTheSame) {
  Names names;
  const Name robot = names.add("r", 17);
  const Name odd = names.add("x007");
  const Names again(std::vector<std::string>(names.words().begin(), names.words().end()));
  EXPECT_EQ(again.text(robot), "r17");
  EXPECT_EQ(again.text(odd), "x007");
  EXPECT_EQ(again.find("r17"), robot);
  EXPECT_EQ(again.find("y"), std::nullopt);
  EXPECT_THROW(Names(std::vector<std::string>{}), std::invalid_argument);
  EXPECT_THROW(Names(std::vector<std::string>{"r"}), std::invalid_argument);
  EXPECT_THROW(Names(std::vector<std::string>{"", "r", "r"}), std::invalid_argument);
}

TEST(Names, EqualNamesGetTheNextFreeNumber) {
  UniqueNames names("~");
  EXPECT_EQ(names.add("eye"), "eye");
  EXPECT_EQ(names.add("eye~2"), "eye~2");
  EXPECT_EQ(names.add("eye"), "eye~3");
  EXPECT_EQ(names.add("eye"), "eye~4");
  EXPECT_EQ(names.add("eye~2"), "eye~2~2");
  EXPECT_EQ(names.add(""), "");
  EXPECT_EQ(names.add(""), "~2");
}

TEST(Names, ManyEqualNamesAreNumberedAtOnce) {
  constexpr int k_names = 100000;  // with a search from 2 on for each name, this would take minutes
  UniqueNames names("#");
  for (int i = 1; i < k_names; ++i) names.add("eye");
  EXPECT_EQ(names.add("eye"), "eye#100000");
}

}  // namespace
}  // namespace troupe::engine::names_test
