#include "engine/fields/description.hpp"

#include "engine/kinds/make_device_kind.hpp"
#include "engine/spec/world_spec.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

namespace troupe::engine::description_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

enum class Law : std::uint8_t { disc, walls };
constexpr std::array<std::string_view, 2> names_of(Law) { return {"disc", "walls"}; }

struct Inner {
  double length = 0;
  std::optional<double> width;

  static constexpr void describe(Description<Inner>& d) {
    using namespace facts;
    d.member<&Inner::length>("length", Unit::meters, above(0), required, "from end to end");
    d.member<&Inner::width>("width", Unit::meters, at_least(0), "across");
  }
  friend bool operator==(const Inner&, const Inner&) = default;
};

struct Limited {
  double above_then_at_least = 1;
  double at_least_then_above = 1;
  double above_below_at_least = 3;

  static constexpr void describe(Description<Limited>& d) {
    using namespace facts;
    d.member<&Limited::above_then_at_least>("above_then_at_least", above(0), within(-1, 9));
    d.member<&Limited::at_least_then_above>("at_least_then_above", at_least(0), above(0));
    d.member<&Limited::above_below_at_least>("above_below_at_least", above(0), at_least(2));
  }
};

/// A member of each type that there may be.
struct All {
  bool flag = true;
  std::int32_t small = -3;
  std::uint8_t byte = 200;
  std::uint64_t wide = 18446744073709551615u;
  float single = 0.25f;
  double angle = 0.5;
  std::string word = "near";
  Law law = Law::walls;
  std::vector<double> numbers{1, 2};
  std::vector<std::string> words{"a", "b"};
  std::array<float, 3> array{1, 2, 3};
  Eigen::Vector3d vector{4, 5, 6};
  Color color{0.5f, 0.25f, 0, 0.75f};
  std::vector<Color> colors{{1, 0, 0, 1}, {0, 1, 0, 1}};
  BodyId body = BodyId(7);
  Pose pose;
  Inner inner;
  std::vector<Inner> inners;
  std::optional<double> number_or_none;
  std::optional<Law> law_or_none;
  std::optional<std::string> word_or_none;
  std::optional<Color> color_or_none;
  std::optional<Pose> pose_or_none;
  std::optional<Inner> inner_or_none;
  std::vector<int> cache;

  static constexpr void describe(Description<All>& d) {
    using namespace facts;
    using enum Unit;
    d.member<&All::flag>("flag");
    d.member<&All::small>("small", at_least(-100));
    d.member<&All::byte>("byte", counts_readings);
    d.member<&All::wide>("wide");
    d.member<&All::single>("single");
    d.member<&All::angle>("angle", radians, within(-1, 1), "to the left");
    d.member<&All::word>("word", one_of({"near", "far"}));
    d.member<&All::law>("law", fixed);
    d.member<&All::numbers>("numbers", meters);
    d.member<&All::words>("words");
    d.member<&All::array>("array");
    d.member<&All::vector>("vector", meters);
    d.member<&All::color>("color");
    d.member<&All::colors>("colors");
    d.member<&All::body>("body", provenance);
    d.member<&All::pose>("pose");
    d.member<&All::inner>("inner");
    d.member<&All::inners>("inners");
    d.member<&All::number_or_none>("number_or_none", seconds);
    d.member<&All::law_or_none>("law_or_none");
    d.member<&All::word_or_none>("word_or_none");
    d.member<&All::color_or_none>("color_or_none");
    d.member<&All::pose_or_none>("pose_or_none");
    d.member<&All::inner_or_none>("inner_or_none");
    d.derived<&All::cache>();
  }
};

Value& value(Record& record, const FieldTable& table, std::string_view name) {
  return record.at(static_cast<std::size_t>(table.find(name)));
}

TEST(Description, FieldsSayWhatWasSaidOfTheMembers) {
  const FieldTable& table = described<All>();
  EXPECT_EQ(table.fields.size(), 24u);  // all but the derived one, in the order of the description
  EXPECT_EQ(table.fields.front().name, "flag");
  EXPECT_EQ(table.fields.back().name, "inner_or_none");
  EXPECT_THROW(table.at("cache"), std::out_of_range) << "a derived member";
  const engine::Field& angle = table.at("angle");
  EXPECT_EQ(angle.type, FieldType::number);
  EXPECT_EQ(angle.unit, Unit::radians);
  EXPECT_EQ(angle.min, -1);
  EXPECT_EQ(angle.max, 1);
  EXPECT_EQ(angle.text, "to the left");
  EXPECT_EQ(angle.fallback, Value(0.5));
  EXPECT_TRUE(table.at("law").fixed);
  EXPECT_TRUE(table.at("byte").counts_readings);
  EXPECT_TRUE(table.at("body").provenance);
  EXPECT_THAT(table.at("law").choices, testing::ElementsAre("disc", "walls"));
  EXPECT_EQ(table.at("law").fallback, Value("walls"));
  EXPECT_THAT(table.at("word").choices, testing::ElementsAre("near", "far"));
  EXPECT_EQ(table.at("vector").columns, 3u);
  EXPECT_EQ(table.at("vector").type, FieldType::numbers);
  EXPECT_EQ(table.at("pose").record, &pose_fields());
  EXPECT_TRUE(described<Inner>().at("length").above_min);
}

TEST(Description, LimitsAreNoWiderThanTheMember) {
  const FieldTable& table = described<All>();
  EXPECT_EQ(table.at("small").min, -100);
  EXPECT_EQ(table.at("small").max, 2147483647);
  EXPECT_EQ(table.at("byte").min, 0);
  EXPECT_EQ(table.at("byte").max, 255);
  EXPECT_EQ(table.at("single").max, std::numeric_limits<float>::max());
  EXPECT_EQ(table.at("angle").max, 1);
}

TEST(Description, ALimitThatIsExcludedStaysExcluded) {
  const FieldTable& table = described<Limited>();
  EXPECT_EQ(table.at("above_then_at_least").min, 0);
  EXPECT_TRUE(table.at("above_then_at_least").above_min);
  EXPECT_EQ(table.at("above_then_at_least").max, 9);
  EXPECT_TRUE(table.at("at_least_then_above").above_min);
  EXPECT_EQ(table.at("above_below_at_least").min, 2);
  EXPECT_FALSE(table.at("above_below_at_least").above_min);
}

TEST(Description, WhatHasNoDefaultIsRequiredOrOptional) {
  const FieldTable& table = described<All>();
  EXPECT_FALSE(table.at("angle").required());
  EXPECT_TRUE(described<Inner>().at("length").required());
  EXPECT_FALSE(described<Inner>().at("length").optional);
  EXPECT_TRUE(described<Inner>().at("width").optional);
  EXPECT_FALSE(described<Inner>().at("width").required());
  EXPECT_FALSE(table.at("inner_or_none").required());
  // A block that is not given has the defaults of its fields, of which one may be required.
  const Record defaults = table.defaults();
  Record of_table = defaults;
  EXPECT_FALSE(value(of_table, table, "inner").records().front().front().given());
  EXPECT_FALSE(value(of_table, table, "inner_or_none").given());
}

TEST(Description, ARecordAndItsStructSayTheSame) {
  All given;
  given.flag = false;
  given.angle = -0.0;
  given.law = Law::disc;
  given.inners = {{1, {}}, {2, 3}};
  given.number_or_none = 0.25;
  given.law_or_none = Law::disc;
  given.word_or_none = "";
  given.color_or_none = Color{0, 0, 1, 0};
  given.pose_or_none = Pose{1, 2, 3, 4};
  given.inner_or_none = Inner{5, 6};
  const Record record = to_record(given);
  const All back = from_record<All>(record);
  EXPECT_EQ(to_record(back), record);
  EXPECT_EQ(back.wide, given.wide);
  EXPECT_EQ(back.law, Law::disc);
  EXPECT_TRUE(std::signbit(back.angle));
  EXPECT_EQ(back.inners, given.inners);
  EXPECT_EQ(back.color, given.color);
  EXPECT_EQ(back.colors, given.colors);
  EXPECT_EQ(back.body, given.body);
  EXPECT_EQ(back.vector, given.vector);
  EXPECT_EQ(back.pose_or_none, given.pose_or_none);
  EXPECT_EQ(back.inner_or_none, given.inner_or_none);
  EXPECT_EQ(back.color_or_none, given.color_or_none);
}

TEST(Description, WhatARecordDoesNotGiveStaysAsItIs) {
  const FieldTable& table = described<All>();
  Record record(table.fields.size());
  value(record, table, "small") = 9;
  const All all = from_record<All>(record);
  EXPECT_EQ(all.small, 9);
  EXPECT_EQ(all.byte, 200);
  EXPECT_EQ(all.words.size(), 2u);
  EXPECT_FALSE(all.inner_or_none);
  // A list that is given is what it is now; what its records do not give is as in new structs.
  All other;
  other.inners = {{7, 8}};
  value(record, table, "inners") = std::vector<Record>{Record{Value(), Value(1.0)}};
  fill(table, &other, record);
  EXPECT_EQ(other.inners, (std::vector<Inner>{{0, 1}}));
  other.number_or_none = 3;
  set(table.at("number_or_none"), &other, Value());
  EXPECT_FALSE(other.number_or_none);
}

TEST(Description, WhatAMemberCannotHoldIsRefused) {
  const FieldTable& table = described<All>();
  const auto refused = [&](std::string_view name, Value given) -> std::string {
    Record record(table.fields.size());
    value(record, table, name) = std::move(given);
    try {
      from_record<All>(record);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_EQ(refused("byte", 256), "\"byte\" must be from 0 to 255, found 256");
  EXPECT_EQ(refused("byte", -1), "\"byte\" must be from 0 to 255, found -1");
  EXPECT_EQ(refused("law", "mesh"), "\"law\" must be one of disc, walls, found \"mesh\"");
  EXPECT_EQ(refused("vector", std::vector<double>{1, 2}), "\"vector\" needs 3 numbers, found 2");
  EXPECT_EQ(refused("color", std::vector<double>{1, 2, 3}), "\"color\" needs 4 numbers, found 3");
  EXPECT_EQ(refused("byte", 255), "");
  Record record(table.fields.size());
  value(record, table, "angle") = "left";
  EXPECT_THROW(from_record<All>(record), std::bad_variant_access);
}

struct Wholes {
  std::array<std::uint8_t, 2> bytes{1, 2};
  std::array<bool, 2> flags{true, false};
  std::array<std::int16_t, 1> small{};
  std::array<std::int64_t, 1> wide{};
  std::array<std::uint64_t, 1> unsigned_wide{};
  std::optional<std::array<std::uint8_t, 1>> byte_or_none;
  std::vector<std::array<std::uint8_t, 2>> pairs;

  static constexpr void describe(Description<Wholes>& d) {
    d.member<&Wholes::bytes>("bytes");
    d.member<&Wholes::flags>("flags");
    d.member<&Wholes::small>("small");
    d.member<&Wholes::wide>("wide");
    d.member<&Wholes::unsigned_wide>("unsigned_wide");
    d.member<&Wholes::byte_or_none>("byte_or_none");
    d.member<&Wholes::pairs>("pairs");
  }
};

TEST(Description, IntegersOfAnArrayAreWholeAndInTheirRange) {
  const FieldTable& table = described<Wholes>();
  Wholes wholes;
  const auto refused = [&](std::string_view name, std::vector<double> given) -> std::string {
    try {
      set(table.at(name), &wholes, std::move(given));
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_EQ(refused("bytes", {7, 300}), "\"bytes\" must be from 0 to 255, found 300");
  EXPECT_EQ(wholes.bytes, (std::array<std::uint8_t, 2>{1, 2})) << "no element is set";
  EXPECT_EQ(refused("bytes", {-1, 0}), "\"bytes\" must be from 0 to 255, found -1");
  EXPECT_EQ(refused("bytes", {1e30, 0}), "\"bytes\" must be from 0 to 255, found 1e+30");
  EXPECT_EQ(refused("bytes", {std::nan(""), 0}), "\"bytes\" must be from 0 to 255, found nan");
  EXPECT_EQ(refused("bytes", {1.5, 0}), "\"bytes\" must be a whole number, found 1.5");
  EXPECT_EQ(refused("bytes", {1 + 1e-12, 0}), "\"bytes\" must be a whole number, found 1.000000000001");
  EXPECT_EQ(refused("flags", {0, 2}), "\"flags\" must be from 0 to 1, found 2");
  EXPECT_EQ(refused("flags", {0.5, 1}), "\"flags\" must be a whole number, found 0.5");
  EXPECT_EQ(refused("small", {-32769}), "\"small\" must be from -32768 to 32767, found -32769");
  EXPECT_EQ(refused("wide", {0x1p63}),
            "\"wide\" must be from -9223372036854775808 to 9223372036854775807, found 9.223372037e+18");
  EXPECT_EQ(refused("unsigned_wide", {0x1p64}),
            "\"unsigned_wide\" must be from 0 to 18446744073709551615, found 1.844674407e+19");
  EXPECT_EQ(refused("unsigned_wide", {-1}),
            "\"unsigned_wide\" must be from 0 to 18446744073709551615, found -1");
  EXPECT_EQ(refused("byte_or_none", {256}), "\"byte_or_none\" must be from 0 to 255, found 256");
  EXPECT_EQ(refused("bytes", {0, 255}), "");
  EXPECT_EQ(refused("flags", {0, 1}), "");
  EXPECT_EQ(refused("small", {-32768}), "");
  EXPECT_EQ(refused("wide", {-0x1p63}), "");
  EXPECT_EQ(refused("unsigned_wide", {0x1p63}), "");
  EXPECT_EQ(wholes.bytes, (std::array<std::uint8_t, 2>{0, 255}));
  EXPECT_EQ(wholes.flags, (std::array<bool, 2>{false, true}));
  EXPECT_EQ(wholes.wide.front(), std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(wholes.unsigned_wide.front(), std::uint64_t{1} << 63);
  EXPECT_EQ(table.at("bytes").max, 255) << "readers of files refuse it with the place in the file";
  EXPECT_EQ(table.at("small").min, -32768);
  EXPECT_EQ(table.at("wide").max, 0x1p53 - 1) << "a double holds no larger integer exactly";
  EXPECT_EQ(table.at("wide").min, -(0x1p53 - 1));
  EXPECT_EQ(table.at("unsigned_wide").min, 0);
  EXPECT_TRUE(has_whole_numbers(table.at("flags")));
  EXPECT_FALSE(has_whole_numbers(described<All>().at("vector")));
}

struct Outer {
  std::int32_t first = 1;
  Inner inner{.length = 4, .width = {}};
  bool last = false;

  static constexpr void describe(Description<Outer>& d) {
    d.member<&Outer::first>("first");
    d.part<&Outer::inner>();
    d.member<&Outer::last>("last");
  }
};

TEST(Description, FieldsOfAPartStandAmongThoseOfItsStruct) {
  const FieldTable& table = described<Outer>();
  ASSERT_EQ(table.fields.size(), 4u);
  EXPECT_EQ(table.fields[1].name, "length");
  EXPECT_TRUE(table.fields[1].required());
  EXPECT_EQ(table.fields[3].name, "last");
  const Outer outer = from_record<Outer>({2, 5.0, 6.0, true});
  EXPECT_EQ(outer.first, 2);
  EXPECT_EQ(outer.inner, (Inner{5, 6}));
  EXPECT_TRUE(outer.last);
  EXPECT_EQ(to_record(outer), (Record{2, 5.0, 6.0, true}));
}

struct Motion {
  double speed = 0.5;

  static constexpr void describe(Description<Motion>& d) { d.member<&Motion::speed>("speed"); }
};
struct Fast {
  Motion motion{.speed = 2};
  Motion block{.speed = 3};

  static constexpr void describe(Description<Fast>& d) {
    d.part<&Fast::motion>();
    d.member<&Fast::block>("block");
  }
};

TEST(Description, DefaultsAreThoseOfTheOuterStruct) {
  const Record defaults = described<Fast>().defaults();
  EXPECT_EQ(defaults, (Record{2.0, std::vector<Record>{{3.0}}}));
}

template <class T>
std::string contradiction() {
  try {
    described<T>();
  } catch (const std::logic_error& error) {
    return error.what();
  }
  return {};
}
struct SameNames {
  bool a = false;
  bool b = false;
  static constexpr void describe(Description<SameNames>& d) {
    d.member<&SameNames::a>("a");
    d.member<&SameNames::b>("a");
  }
};
struct NoNumber {
  bool a = false;
  static constexpr void describe(Description<NoNumber>& d) { d.member<&NoNumber::a>("a", Unit::meters); }
};
struct NoLimits {
  std::string a;
  static constexpr void describe(Description<NoLimits>& d) {
    d.member<&NoLimits::a>("a", facts::at_least(1));
  }
};
struct NoText {
  double a = 0;
  static constexpr void describe(Description<NoText>& d) {
    d.member<&NoText::a>("a", facts::one_of({"left", "right"}));
  }
};
struct NoCount {
  double a = 0;
  static constexpr void describe(Description<NoCount>& d) {
    d.member<&NoCount::a>("a", facts::counts_readings);
  }
};
struct NothingBetween {
  std::uint8_t a = 0;
  static constexpr void describe(Description<NothingBetween>& d) {
    d.member<&NothingBetween::a>("a", facts::at_least(256));
  }
};
struct RequiredOptional {
  std::optional<double> a;
  static constexpr void describe(Description<RequiredOptional>& d) {
    d.member<&RequiredOptional::a>("a", facts::required);
  }
};
struct OtherColumns {
  std::array<double, 3> a{};
  static constexpr void describe(Description<OtherColumns>& d) {
    d.member<&OtherColumns::a>("a", facts::columns(2));
  }
};
struct DefaultedOptional {
  std::optional<double> a = 1;
  static constexpr void describe(Description<DefaultedOptional>& d) { d.member<&DefaultedOptional::a>("a"); }
};

TEST(Description, FactsThatContradictOneAnotherAreTold) {
  EXPECT_THAT(contradiction<SameNames>(), HasSubstr("description of \"a\" gives this name to two members"));
  EXPECT_THAT(contradiction<NoNumber>(), HasSubstr("gives a unit to a member that is not a number"));
  EXPECT_THAT(contradiction<NoLimits>(), HasSubstr("gives limits to a member without numbers"));
  EXPECT_THAT(contradiction<NoText>(), HasSubstr("gives choices to a member that is not a text"));
  EXPECT_THAT(contradiction<NoCount>(), HasSubstr("counts readings with a member that is not an integer"));
  EXPECT_THAT(contradiction<NothingBetween>(), HasSubstr("has a lower limit above its upper limit"));
  EXPECT_THAT(contradiction<RequiredOptional>(), HasSubstr("makes an optional member required"));
  EXPECT_THAT(contradiction<OtherColumns>(), HasSubstr("contradicts the number of columns of its type"));
  EXPECT_THAT(contradiction<DefaultedOptional>(), HasSubstr("gives a default to an optional member"));
}

struct State {
  double heading = 1;
  std::array<float, 2> pair{};
  std::uint8_t lit = 0;

  static constexpr void describe(Description<State>& d) {
    using namespace facts;
    d.member<&State::heading>("heading", Unit::radians, is_sparse, "to the north");
    d.member<&State::pair>("two", Unit::meters_per_second);
    d.member<&State::lit>("lit", is_appearance, "1: it shines");
  }
};
struct Listed {
  double heading = 1;
  std::array<float, 2> two{};
  std::uint8_t lit = 0;
  TROUPE_FIELDS(heading, two, lit)
};

TEST(Description, StateHasUnitsAndTextsAndThePlacesOfItsMembers) {
  const std::vector<StateField> fields = memory_fields<State>();
  const std::vector<StateField> listed = memory_fields<Listed>();
  ASSERT_EQ(fields.size(), 3u);
  for (std::size_t f = 0; f < fields.size(); ++f) {
    EXPECT_EQ(fields[f].name, listed[f].name);
    EXPECT_EQ(fields[f].element, listed[f].element);
    EXPECT_EQ(fields[f].columns, listed[f].columns);
    EXPECT_EQ(fields[f].offset, listed[f].offset);
    EXPECT_EQ(listed[f].unit + listed[f].text, "");
  }
  EXPECT_EQ(fields[0].unit, "rad");
  EXPECT_EQ(fields[0].text, "to the north");
  EXPECT_TRUE(fields[0].sparse);
  EXPECT_EQ(fields[1].unit, "m/s");
  EXPECT_TRUE(fields[2].appearance);
  EXPECT_FALSE(fields[2].sparse);
}

struct Flags {
  bool on = false;
  std::array<bool, 2> sides{};
  std::uint8_t count = 0;
  std::array<std::uint8_t, 2> counts{};
  TROUPE_FIELDS(on, sides, count, counts)
};
struct DescribedFlags {
  bool on = false;
  std::array<bool, 2> sides{};
  std::uint8_t count = 0;
  std::array<std::uint8_t, 2> counts{};
  static constexpr void describe(Description<DescribedFlags>& d) {
    d.member<&DescribedFlags::on>("on", "");
    d.member<&DescribedFlags::sides>("sides", "");
    d.member<&DescribedFlags::count>("count", "");
    d.member<&DescribedFlags::counts>("counts", "");
  }
};

TEST(Description, StateKnowsItsBools) {
  const std::vector<StateField> fields = memory_fields<Flags>();
  for (const std::vector<StateField>& known : {fields, memory_fields<DescribedFlags>()}) {
    std::vector<bool> are_bools;
    for (const StateField& field : known) are_bools.push_back(field.is_bool);
    EXPECT_THAT(are_bools, ElementsAre(true, true, false, false));
  }
  StateTable table("flags", HashGroup::sensor, StateTable::Layout::rows, fields, {BodyId(0), BodyId(1)},
                   sizeof(Flags));
  table.cell<std::uint8_t>(1, 1)[1] = 1;
  table.cell<std::uint8_t>(1, 2)[0] = 200;
  EXPECT_TRUE(table.bools_hold());
  table.cell<std::uint8_t>(1, 1)[1] = 2;
  EXPECT_FALSE(table.bools_hold());
}

// ---- kinds of classes

struct Lamp {
  struct Params {
    double intensity = 2;
    static constexpr void describe(Description<Params>& d) { d.member<&Params::intensity>("intensity"); }
  };
  using State = description_test::State;
  struct Command {
    std::uint8_t on = 0;
    TROUPE_FIELDS(on)
  };
  static constexpr bool shows_color = true;

  Params params;
  double height = 0;

  static Lamp make(const Params& params, const Pose& pose) { return {params, pose.z}; }
  void start(State& row) const { row.heading = params.intensity + height; }
  bool is_spent(const StateTable& state, std::size_t slot) const {
    return state.as<State>(slot).heading > params.intensity;
  }
  Result<> bind_part(const TypeSpec&, std::uint32_t) {
    height = 9;
    return {};
  }
  void lint(const LintView&) const {}
};

TEST(DeviceKinds, AreMadeOfTheHooksThatAClassHas) {
  const DeviceKind kind = make_device_kind<Lamp>("lamp", "shines");
  EXPECT_EQ(kind.name, "lamp");
  EXPECT_EQ(kind.text, "shines");
  EXPECT_EQ(kind.params.fields.front().name, "intensity");
  EXPECT_TRUE(kind.shows_color);
  EXPECT_FALSE(kind.carries);
  EXPECT_EQ(kind.sense, nullptr);
  EXPECT_EQ(kind.act, nullptr);
  EXPECT_EQ(kind.apply, nullptr);
  EXPECT_EQ(kind.bind_world, nullptr);
  EXPECT_NE(kind.lint, nullptr);

  DeviceKind::Prepared prepared = kind.prepare({5.0}, {0, 0, 0.5, 0});
  EXPECT_EQ(prepared.percepts.size(), 3u);
  EXPECT_EQ(prepared.percept_bytes, sizeof(State));
  EXPECT_EQ(prepared.commands.size(), 1u);
  EXPECT_EQ(prepared.command_bytes, 1u);
  StateTable table("lamp", HashGroup::sensor, StateTable::Layout::rows, prepared.percepts, {BodyId(0)},
                   prepared.percept_bytes);
  kind.start(prepared.data, table, 0);
  EXPECT_EQ(table.as<State>(0).heading, 5.5);
  EXPECT_TRUE(kind.is_spent(prepared.data, table, 0));
  EXPECT_TRUE(kind.bind_part(prepared.data, TypeSpec(), 0));
  EXPECT_EQ(std::any_cast<Lamp>(prepared.data).height, 9);
}

struct Stranger {
  static DeviceKind::Prepared prepare(const Pose&) { return {.data = 1}; }
};

TEST(DeviceKinds, RefuseDataOfAnotherType) {
  const DeviceKind kind = make_device_kind<Stranger>("stranger", "");
  EXPECT_TRUE(kind.params.fields.empty());
  EXPECT_EQ(kind.lint, nullptr);
  EXPECT_THROW(kind.prepare({}, {}), std::logic_error);
}

}  // namespace
}  // namespace troupe::engine::description_test
