#pragma once

#include "base/color.hpp"
#include "base/ids.hpp"
#include "base/limits.hpp"
#include "base/pose.hpp"
#include "engine/fields/fields.hpp"
#include "engine/fields/state_table.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

/// A struct, such as the parameters of a kind (a sort of sensor, drive or controller), describes its members
/// once, in a function `describe`. The result is a FieldTable: a list of fields, each with the name, type,
/// default, limits and unit of a member. Parsing, validation and storage use this table. Example:
///
///     enum class Law : std::uint8_t { disc, walls };
///     constexpr std::array<std::string_view, 2> names_of(Law) { return {"disc", "walls"}; }
///
///     struct Transducer {
///       Pose pose;
///       double range_max = 5;
///       std::int64_t samples = 1;
///       Law law = Law::disc;
///       std::optional<double> gain;
///
///       static constexpr void describe(engine::Description<Transducer>& d) {
///         using namespace engine::facts;
///         using enum engine::Unit;
///         d.member<&Transducer::pose>("pose", "pose of the transducer in the sensor's frame");
///         d.member<&Transducer::range_max>("range_max", meters, above(0), at_most(10'000), "beam length");
///         d.member<&Transducer::samples>("samples", within(1, 100'000), counts_readings, "number of beams");
///         d.member<&Transducer::law>("law", "shape of the obstacles");
///         d.member<&Transducer::gain>("gain", at_least(0), "default: the gain of the sensor");
///       }
///     };
///
/// `described<Transducer>()` returns the table. A *record* is a list of values, one per field of a table, in
/// the order of the fields (engine/fields/fields.hpp). `from_record<Transducer>(record)` makes the struct
/// from a record, and `to_record(transducer)` makes a record from the struct.
///
/// structs   The struct must have no constructors, and at most 128 members. `describe` must describe each
///           member exactly once; otherwise the code does not compile. The fields have the order in which
///           `describe` describes them. A struct that is declared elsewhere, such as Pose, can be described
///           by a free function instead: `constexpr void describe(Description<Pose>&)` in namespace
///           troupe::engine.
///
/// members   A member has one of these types:
///           - bool, integer types, float, double, std::string, Color, Id;
///           - an enum whose values count from 0; a function names_of(Enum) must return the names of the
///             values, in their order;
///           - std::array or Eigen vector of numbers;
///           - std::vector of double, std::string or Color;
///           - a described struct, such as Pose, and std::vector of a described struct;
///           - a list of lists of numbers: std::vector of std::array or Eigen vectors, std::vector of such
///             lists, and so on. A struct with such a member cannot be made from a record, so the parameters
///             of kinds cannot have one: use a std::vector of a described struct instead;
///           - Record, if only the code that reads the struct knows the table of this record;
///           - std::optional of any of these types, except std::vector of described structs and lists of
///             lists.
///
/// defaults  The default of a member is its value in T{}, where T is the struct. A `required` member has no
///           default. A std::optional member has no default either: a file may omit it, and it must be empty
///           in T{}.
///
/// limits    A member has the limits of its description, and also those of its type. The readers of files
///           report a value outside the limits as an error.
///
/// state     A struct that is part of the state of a world (a controller's memory, a device's state or
///           commands) is described in the same way. Its members must be numbers, bools or arrays of these.
///           memory_fields() in engine/kinds/controller.hpp makes the list of its state fields. Recordings
///           store the units and texts of the description.

namespace troupe::engine {

// Templates that are instantiated for a type have hidden visibility. Two plug-ins in one process may have
// different types of the same name, and the dynamic linker would otherwise merge their instances.
#define TROUPE_OF_TYPE [[gnu::visibility("hidden")]]

template <class T>
class Description;
template <class T>
TROUPE_OF_TYPE const FieldTable& described();

/// One fact about a described member: a unit, a limit, a text or another property of its Field. The functions
/// and constants in the namespace `facts` make facts. In addition, a string and a Unit convert to a fact
/// implicitly. "State" means the state of a world, which is hashed, saved and recorded.
class Fact {
 public:
  /// What the fact specifies.
  enum class Kind : std::uint8_t {
    text,             ///< sets Field::text to the member `words`
    unit,             ///< sets Field::unit to the member `unit`
    at_least,         ///< narrows the limits to `number` (lower) and `high` (upper), both allowed
    above,            ///< raises the lower limit to `number`, which is itself not allowed
    at_most,          ///< lowers the upper limit to `number`, which is itself allowed
    choices,          ///< sets Field::choices to the member `choices`
    columns,          ///< sets Field::columns to the member `number`
    mirror,           ///< sets Field::mirror to the member `words`
    in_json,          ///< sets Field::in_json to the member `number`
    required,         ///< the described member has no default
    counts_readings,  ///< sets Field::counts_readings
    fixed,            ///< sets Field::fixed
    used_if,          ///< sets Field::used_if: the field `words` has the value `value`
    used_unless,      ///< sets Field::used_if: the field `words` has another value than `value`
    provenance,       ///< sets Field::provenance
    sparse,           ///< sets Field::sparse
    appearance,       ///< sets Field::appearance
  };

  /// Sets Field::text. The characters must live as long as the field; those of a string literal do.
  ///@{
  constexpr Fact(const char* text) : kind(Kind::text), words(text) {}
  constexpr Fact(std::string_view text) : kind(Kind::text), words(text) {}
  ///@}
  constexpr Fact(Unit u) : kind(Kind::unit), unit(u) {}  ///< sets Field::unit
  /// Makes a fact of kind k with `number` x and `high` y. Kind::at_least needs both; the other kinds ignore
  /// y.
  constexpr explicit Fact(Kind k, double x = 0, double y = 0) : kind(k), number(x), high(y) {}
  /// Sets the allowed values, Field::choices. The list must live until the call that takes the fact, such as
  /// Description::member(), returns. The characters of the values must live as long as the field.
  constexpr explicit Fact(std::span<const std::string_view> list) : kind(Kind::choices), choices(list) {}
  /// Makes a fact of kind k with `words` and `value`, whose characters must live as long as the field.
  constexpr Fact(Kind k, std::string_view text, std::string_view of = {}) : kind(k), words(text), value(of) {}

  Kind kind;               ///< what the fact specifies
  Unit unit = Unit::none;  ///< the unit, for Kind::unit
  double number = 0;       ///< the number, for Kind::at_least, above, at_most, columns and in_json
  double high = std::numeric_limits<double>::infinity();  ///< upper limit, for Kind::at_least
  std::string_view words;  ///< the text or name, for Kind::text, mirror, used_if and used_unless
  std::string_view value;  ///< the value, for Kind::used_if and used_unless
  std::span<const std::string_view> choices;  ///< the allowed values, for Kind::choices
};

/// The facts that a description can give, in addition to units.
namespace facts {

/// Limits of a number, or of each number of a list, in SI units. at_least() and above() give a lower limit,
/// at_most() an upper limit, and within() both. The number may equal a limit, except that of above(). If a
/// member has several lower limits, including that of its type, the highest one counts; of several upper
/// limits, the lowest one counts.
///@{
constexpr Fact at_least(double min) {
  return Fact(Fact::Kind::at_least, min, std::numeric_limits<double>::infinity());
}
constexpr Fact above(double min) { return Fact(Fact::Kind::above, min); }  ///< `min` itself is not allowed
constexpr Fact at_most(double max) { return Fact(Fact::Kind::at_most, max); }
constexpr Fact within(double min, double max) { return Fact(Fact::Kind::at_least, min, max); }
///@}
/// Allowed values of a std::string; without this fact, any text is allowed. An enum does not need this fact:
/// its allowed values are those of names_of().
constexpr Fact one_of(std::initializer_list<std::string_view> choices) {
  return Fact(std::span<const std::string_view>(choices.begin(), choices.size()));
}
/// Allowed values of a std::string, from an existing list. The list must live until the call that takes the
/// fact, such as Description::member(), returns. The characters of the values must live as long as the field.
constexpr Fact one_of(std::span<const std::string_view> choices) { return Fact(choices); }
/// Required length of a std::vector<double>; without this fact, any length is allowed. The lengths of arrays
/// and Eigen vectors follow from their types.
constexpr Fact columns(std::size_t n) { return Fact(Fact::Kind::columns, static_cast<double>(n)); }
/// The member is one of two limits, a lower and an upper one, and `other` is the name of the field of the
/// other (Field::mirror). The defaults of the two must have different signs.
constexpr Fact mirrors(std::string_view other) { return Fact(Fact::Kind::mirror, other); }
/// A world file in JSON that lacks the member gives it this value instead of its default, in SI units
/// (Field::in_json). Only for numbers and bools (1: true).
constexpr Fact in_json(double value) { return Fact(Fact::Kind::in_json, value); }
/// The member has no default: a file must give it. Not allowed for a std::optional or a struct.
inline constexpr Fact required{Fact::Kind::required};
/// The member gives a number of readings of a sensor (Field::counts_readings). Only for integers.
inline constexpr Fact counts_readings{Fact::Kind::counts_readings};
/// The member cannot change while the world runs, neither by an intervention (a change that the world file
/// lists) nor by World::set(). The fact has an effect only on the parameters of drives and devices
/// (Field::fixed).
inline constexpr Fact fixed{Fact::Kind::fixed};
/// The member has an effect only if the field `other` has the value `value`, which is written as in JSON, but
/// without quotes. While it has none, its limits do not count (Field::used_if).
constexpr Fact used_if(std::string_view other, std::string_view value) {
  return {Fact::Kind::used_if, other, value};
}
/// As used_if(), for a member that has an effect unless `other` has the value `value`.
constexpr Fact used_unless(std::string_view other, std::string_view value) {
  return {Fact::Kind::used_unless, other, value};
}
/// The member tells where the data come from, for example the file and the line. It is stored, but ignored
/// when two structs are compared (Field::provenance).
inline constexpr Fact provenance{Fact::Kind::provenance};
/// For members of a struct that is state: the member adds nothing to the hash of the state while it is zero
/// (StateField::sparse). For members of other structs: a stored record may lack the field of the member, and
/// the member then has its default.
inline constexpr Fact is_sparse{Fact::Kind::sparse};
/// For members of a struct that is state: the appearance of a body depends on the member, so recordings of
/// poses contain it (StateField::appearance).
inline constexpr Fact is_appearance{Fact::Kind::appearance};
}  // namespace facts

/// Describes one type that members can have, such as std::vector<double>. Generic code reads and writes a
/// member of this type through a `void` pointer: the argument `member` of the functions.
struct MemberType {
  FieldType type = FieldType::number;  ///< type of the field that describes such a member
  std::size_t columns = 0;             ///< length of a fixed array; 0: not a fixed array
  /// Smallest number that the type can hold. Set for float, Id, integers except std::int64_t, and fixed
  /// arrays of float, integers or bools. For all other types, -infinity. In an array of 64-bit integers, the
  /// absolute value is at most 2^53 - 1, because a Value holds the elements as doubles.
  double min = -std::numeric_limits<double>::infinity();
  /// Largest number that the type can hold. Set for the same types as `min`, except std::uint64_t. For all
  /// other types, infinity.
  double max = std::numeric_limits<double>::infinity();
  bool optional = false;           ///< whether the member is a std::optional
  bool is_unsigned = false;        ///< true: std::uint64_t; a Value stores its bits in a std::int64_t
  bool is_bool = false;            ///< whether the member is a bool or a fixed array of bools
  bool has_whole_numbers = false;  ///< whether the member is a fixed array of integers or bools
  std::span<const std::string_view> choices = {};  ///< for enums: the names of the values
  /// Returns described<T>(), if the member is a described struct T, or a std::optional or std::vector of T.
  /// Null for all other members.
  const FieldTable& (*table)() = nullptr;
  /// Returns the value of a member. For an empty std::optional, the result has no value: Value::given() is
  /// false. Null if `table` is not null.
  Value (*get)(const void* member) = nullptr;
  /// Sets a member to a value. Throws std::bad_variant_access if the value has another type than the member.
  /// Throws std::invalid_argument if the member cannot hold the value, such as a number that is too large for
  /// an integer type. The limits of floating-point types are not checked. Null if `table` or `each` is not
  /// null.
  void (*set)(void* member, const Value& value) = nullptr;
  /// Functions that access the elements of a member. The elements are structs if `table` is not null, and
  /// inner lists if `each` is not null. A struct has one element, itself; a std::optional has none or one; a
  /// std::vector has any number. The functions are null for all other members.
  ///@{
  std::size_t (*size)(const void* member) = nullptr;  ///< number of elements of a member
  /// Sets the number of elements to n. New structs have their default values; new inner lists must be set by
  /// the caller. Null: the number is always 1.
  void (*resize)(void* member, std::size_t n) = nullptr;
  void* (*block)(void* member, std::size_t i) = nullptr;  ///< address of element i, which must exist
  ///@}
  /// For lists of lists of numbers: the type of an inner list. get() then returns the numbers of all inner
  /// lists in one list, and `set` is null. Null for all other members.
  const MemberType* each = nullptr;
  bool is_state = false;           ///< whether the member can be part of a struct that is state
  Element element = Element::f64;  ///< type of the number, or of the numbers of an array, if is_state is true
};

/// Whether each number of a field must be a whole number, because its member is an array of integers or
/// bools.
inline bool has_whole_numbers(const Field& field) {
  return field.member != nullptr && field.member->has_whole_numbers;
}

namespace detail {

/// Stands for an initialiser of any type in member_count(). Its conversion is never executed.
struct Anything {
  template <class T>
  operator T() const {
    throw std::logic_error("internal error: a conversion that is never executed");
  }
};

// A concept, not an expression in takes(): clang's tools walk through the bodies of all templates, and need
// time quadratic in the number of non-dependent expressions such as Any{}.
template <class T, class Any, std::size_t... I>
concept Takes = requires {
  T{(static_cast<void>(I), Any{})...};
};

template <class T, class Any, std::size_t... I>
constexpr bool takes(std::index_sequence<I...>) {
  return Takes<T, Any, I...>;
}

/// Returns the number of members of an aggregate T (a struct without constructors): the largest number of
/// initialisers that T accepts. A base class counts as one member.
///
/// Any       a type that converts to the type of each member
/// Low       a number of initialisers that T accepts
/// High      a number that T does not accept, or 0: not known yet
template <class T, class Any = Anything, std::size_t Low = 0, std::size_t High = 0>
constexpr std::size_t member_count() {
  constexpr std::size_t n = High == 0 ? 2 * Low + 4 : (Low + High) / 2;
  if constexpr (n == Low)
    return Low;
  else if constexpr (takes<T, Any>(std::make_index_sequence<n>{}))
    return member_count<T, Any, n, High>();
  else
    return member_count<T, Any, Low, n>();
}

/// Whether an aggregate T has N members. For a known N, this is much less work than member_count().
template <class T, std::size_t N>
constexpr bool has_members() {
  return takes<T, Anything>(std::make_index_sequence<N>{}) &&
         !takes<T, Anything>(std::make_index_sequence<N + 1>{});
}

/// The part of a Description that does not depend on the described struct. A description without a table
/// collects the described members in it.
class MemberList {
 public:
  /// Number of members described so far. This function and those below are only for a description without a
  /// table.
  constexpr std::size_t members() const { return count_; }
  /// Whether any member was described more than once.
  constexpr bool repeats() const { return repeats_; }
  /// Whether a struct that is state may have all the members described so far. Each must be a bool, a number
  /// of one of the types listed at Element (engine/fields/state_table.hpp), or an array of these.
  constexpr bool is_state() const { return is_state_; }
  /// Whether any of the members described so far is, or contains, a list of lists of numbers.
  constexpr bool nests_lists() const { return nests_lists_; }

 protected:
  /// Adds a member, which tag() identifies.
  constexpr void count(std::string_view tag, bool can_be_state, bool nests_lists = false) {
    for (std::size_t i = 0; i < count_; ++i) repeats_ = repeats_ || seen_[i] == tag;
    seen_[count_++] = tag;
    is_state_ = is_state_ && can_be_state;
    nests_lists_ = nests_lists_ || nests_lists;
  }

 private:
  static constexpr std::size_t k_most_members = 128;

  std::size_t count_ = 0;
  bool repeats_ = false;
  bool is_state_ = true;
  bool nests_lists_ = false;
  std::array<std::string_view, k_most_members> seen_{};
};

template <class T>
concept HasOwnDescription = requires(Description<T>& d) {
  T::describe(d);
};
template <class T>
concept Described = HasOwnDescription<T> || requires(Description<T>& d) {
  describe(d);
};

template <class T>
constexpr void describe_members(Description<T>& d) {
  if constexpr (HasOwnDescription<T>)
    T::describe(d);
  else
    describe(d);
}

/// Returns a text that identifies a member. Constant expressions compare the texts of two members to tell
/// whether they are the same member. They do not compare addresses, because gcc rejects this in builds with
/// -fsanitize=undefined.
///
/// k_member: pointer to the member
template <auto k_member>
constexpr std::string_view tag() {
  return __PRETTY_FUNCTION__;
}

/// Gives the class C and the member type M of a pointer to member `M C::*`.
template <class M>
struct Pointed;
template <class C, class M>
struct Pointed<M C::*> {
  using Class = C;
  using Type = M;
};

Value numbers_value(const double* numbers, std::size_t count);
/// Returns the numbers of a value that is a list of numbers; valid as long as the value. Throws
/// std::bad_variant_access if the value has another type, and std::invalid_argument if it does not have
/// exactly `count` numbers.
std::span<const double> numbers_of(const Value& value, std::size_t count);
std::int64_t integer_of(const Value& value, std::int64_t least, std::int64_t most);
/// Throws std::invalid_argument if `number` is not a whole number from `least` to `most`. Called for each
/// element of an array of integers, because the elements of such an array are doubles in a Value.
void check_integer(double number, std::int64_t least, std::uint64_t most);
std::size_t choice_of(const Value& value, std::span<const std::string_view> choices);
Value color_value(const Color& color);
void set_color(Color& color, const Value& value);
Value colors_value(const std::vector<Color>& colors);
void set_colors(std::vector<Color>& colors, const Value& value);

template <class E>
TROUPE_OF_TYPE inline constexpr auto k_names = names_of(E{});

/// Properties of a fixed array type M (std::array or Eigen column vector): Element is the type of its
/// elements, and `size` is their number. For all other types, `size` is 0 and Element is not defined.
template <class M>
struct Fixed {
  static constexpr std::size_t size = 0;
};
template <class E, std::size_t N>
struct Fixed<std::array<E, N>> {
  using Element = E;
  static constexpr std::size_t size = N;
};
template <class E, int N>
struct Fixed<Eigen::Matrix<E, N, 1>> {
  using Element = E;
  static constexpr std::size_t size = N;
};

template <class M>
inline constexpr bool k_is_id = false;
template <class K>
inline constexpr bool k_is_id<Id<K>> = true;

template <class M>
concept StateNumber = std::is_same_v<M, double> || std::is_same_v<M, float> || std::is_same_v<M, bool> ||
    std::is_same_v<M, std::int64_t> || std::is_same_v<M, std::int32_t> || std::is_same_v<M, std::uint64_t> ||
    std::is_same_v<M, std::uint32_t> || std::is_same_v<M, std::uint8_t>;

template <class E>
constexpr void set_float_limits(MemberType& type) {
  if constexpr (std::is_same_v<E, float>) {
    type.min = std::numeric_limits<float>::lowest();
    type.max = std::numeric_limits<float>::max();
  }
}

template <class M>
constexpr MemberType plain_type() {
  MemberType type;
  if constexpr (StateNumber<M>) {
    type.is_state = true;
    type.element = element_of<M>();
    type.is_bool = std::is_same_v<M, bool>;
  }
  if constexpr (std::is_same_v<M, bool>) {
    type.type = FieldType::boolean;
    type.get = [](const void* m) { return Value(*static_cast<const bool*>(m)); };
    type.set = [](void* m, const Value& value) { *static_cast<bool*>(m) = value.boolean(); };
  } else if constexpr (std::is_integral_v<M>) {
    // Unsigned 64-bit integers keep their bits: the integer of a Value is signed.
    constexpr bool k_wide = sizeof(M) == sizeof(std::int64_t);
    constexpr auto k_least = k_wide ? std::numeric_limits<std::int64_t>::min()
                                    : static_cast<std::int64_t>(std::numeric_limits<M>::min());
    constexpr auto k_most = k_wide ? std::numeric_limits<std::int64_t>::max()
                                   : static_cast<std::int64_t>(std::numeric_limits<M>::max());
    type.type = FieldType::integer;
    type.is_unsigned = k_wide && std::is_unsigned_v<M>;
    if (!k_wide) {
      type.min = static_cast<double>(k_least);
      type.max = static_cast<double>(k_most);
    } else if (type.is_unsigned) {
      type.min = 0;
    }
    type.get = [](const void* m) { return Value(static_cast<std::int64_t>(*static_cast<const M*>(m))); };
    type.set = [](void* m, const Value& value) {
      *static_cast<M*>(m) = static_cast<M>(integer_of(value, k_least, k_most));
    };
  } else if constexpr (std::is_floating_point_v<M>) {
    type.type = FieldType::number;
    set_float_limits<M>(type);
    type.get = [](const void* m) { return Value(static_cast<double>(*static_cast<const M*>(m))); };
    type.set = [](void* m, const Value& value) { *static_cast<M*>(m) = static_cast<M>(value.number()); };
  } else if constexpr (std::is_same_v<M, std::string>) {
    type.type = FieldType::text;
    type.get = [](const void* m) { return Value(*static_cast<const std::string*>(m)); };
    type.set = [](void* m, const Value& value) { *static_cast<std::string*>(m) = value.text(); };
  } else if constexpr (std::is_enum_v<M>) {
    type.type = FieldType::text;
    type.choices = k_names<M>;
    type.get = [](const void* m) {
      return Value(std::string(k_names<M>[static_cast<std::size_t>(*static_cast<const M*>(m))]));
    };
    type.set = [](void* m, const Value& value) {
      *static_cast<M*>(m) = static_cast<M>(choice_of(value, k_names<M>));
    };
  } else if constexpr (k_is_id<M>) {
    type.type = FieldType::integer;
    type.min = 0;
    type.max = std::numeric_limits<std::uint32_t>::max();
    type.get = [](const void* m) { return Value(std::int64_t{static_cast<const M*>(m)->value}); };
    type.set = [](void* m, const Value& value) {
      constexpr std::int64_t k_most = std::numeric_limits<std::uint32_t>::max();
      *static_cast<M*>(m) = M(static_cast<std::size_t>(integer_of(value, 0, k_most)));
    };
  } else if constexpr (std::is_same_v<M, std::vector<double>>) {
    type.type = FieldType::numbers;
    type.get = [](const void* m) { return Value(*static_cast<const std::vector<double>*>(m)); };
    type.set = [](void* m, const Value& value) { *static_cast<std::vector<double>*>(m) = value.numbers(); };
  } else if constexpr (std::is_same_v<M, std::vector<std::string>>) {
    type.type = FieldType::texts;
    type.get = [](const void* m) { return Value(*static_cast<const std::vector<std::string>*>(m)); };
    type.set = [](void* m, const Value& value) {
      *static_cast<std::vector<std::string>*>(m) = value.texts();
    };
  } else if constexpr (std::is_same_v<M, Record>) {
    type.type = FieldType::record;
    type.get = [](const void* m) { return Value(std::vector<Record>{*static_cast<const Record*>(m)}); };
    type.set = [](void* m, const Value& value) { *static_cast<Record*>(m) = value.records().at(0); };
  } else if constexpr (std::is_same_v<M, Color>) {
    type.type = FieldType::color;
    type.get = [](const void* m) { return color_value(*static_cast<const Color*>(m)); };
    type.set = [](void* m, const Value& value) { set_color(*static_cast<Color*>(m), value); };
  } else if constexpr (std::is_same_v<M, std::vector<Color>>) {
    type.type = FieldType::colors;
    type.get = [](const void* m) { return colors_value(*static_cast<const std::vector<Color>*>(m)); };
    type.set = [](void* m, const Value& value) { set_colors(*static_cast<std::vector<Color>*>(m), value); };
  } else if constexpr (Fixed<M>::size > 0) {
    using E = typename Fixed<M>::Element;
    static_assert(std::is_arithmetic_v<E>, "a described array must have numbers as elements");
    constexpr std::size_t k_size = Fixed<M>::size;
    type.type = FieldType::numbers;
    type.columns = k_size;
    if constexpr (StateNumber<E>) {
      type.is_state = true;
      type.element = element_of<E>();
      type.is_bool = std::is_same_v<E, bool>;
    }
    type.has_whole_numbers = std::is_integral_v<E>;
    if constexpr (std::is_integral_v<E>) {
      // A Value stores the elements as doubles, in which larger integers would be rounded.
      constexpr double k_exact = 9007199254740991;  // 2^53 - 1
      type.min = std::max(static_cast<double>(std::numeric_limits<E>::min()), -k_exact);
      type.max = std::min(static_cast<double>(std::numeric_limits<E>::max()), k_exact);
    } else {
      set_float_limits<E>(type);
    }
    type.get = [](const void* m) {
      std::array<double, k_size> numbers;
      const E* from = static_cast<const M*>(m)->data();
      for (std::size_t i = 0; i < k_size; ++i) numbers[i] = static_cast<double>(from[i]);
      return numbers_value(numbers.data(), k_size);
    };
    type.set = [](void* m, const Value& value) {
      const std::span<const double> numbers = numbers_of(value, k_size);
      if constexpr (std::is_integral_v<E>)
        for (const double number : numbers)
          check_integer(number, std::numeric_limits<E>::min(), std::numeric_limits<E>::max());
      E* to = static_cast<M*>(m)->data();
      for (std::size_t i = 0; i < k_size; ++i) to[i] = static_cast<E>(numbers[i]);
    };
  } else {
    static_assert(Described<M>,
                  "a member must have a type that can be described: see engine/fields/description.hpp");
    type.type = FieldType::record;
    if constexpr (std::is_same_v<M, Pose>)
      type.table = pose_fields;  // a single table, whose address identifies poses
    else
      type.table = described<M>;
    type.size = [](const void*) { return std::size_t{1}; };
    type.block = [](void* m, std::size_t) { return m; };
  }
  return type;
}

template <class M>
struct TROUPE_OF_TYPE TypeOf {
  static constexpr MemberType value = plain_type<M>();
};

/// Whether std::vector<M> is a list of lists of numbers. This holds if M is a fixed array of numbers, a
/// std::vector of such arrays, a std::vector of such vectors, and so on.
template <class M>
inline constexpr bool k_is_listed = Fixed<M>::size > 0;
template <class M>
inline constexpr bool k_is_listed<std::vector<M>> = k_is_listed<M>;

Value all_numbers(const MemberType& lists, const void* member);

template <class T>
constexpr MemberList described_members();
template <class M>
constexpr bool members_nest_lists() {
  if constexpr (std::is_aggregate_v<M> && Described<M>)
    return described_members<M>().nests_lists();
  else
    return false;
}
/// Whether a member of type M is, or contains, a list of lists of numbers.
template <class M>
inline constexpr bool k_nests_lists = members_nest_lists<M>();
template <class M>
inline constexpr bool k_nests_lists<std::vector<M>> = k_is_listed<M> || k_nests_lists<M>;
template <class M>
inline constexpr bool k_nests_lists<std::optional<M>> = k_nests_lists<M>;

template <class M>
requires k_is_listed<M>
struct TypeOf<std::vector<M>> {
  static constexpr MemberType value{
      .type = FieldType::numbers,
      .get = [](const void* m) { return all_numbers(TypeOf<std::vector<M>>::value, m); },
      .size = [](const void* m) { return static_cast<const std::vector<M>*>(m)->size(); },
      .resize = [](void* m, std::size_t n) { static_cast<std::vector<M>*>(m)->resize(n); },
      .block = [](void* m, std::size_t i) -> void* { return &(*static_cast<std::vector<M>*>(m))[i]; },
      .each = &TypeOf<M>::value};
};
template <class M>
requires Described<M>
struct TROUPE_OF_TYPE TypeOf<std::vector<M>> {
  static constexpr MemberType value{
      .type = FieldType::records,
      .table = plain_type<M>().table,
      .size = [](const void* m) { return static_cast<const std::vector<M>*>(m)->size(); },
      .resize = [](void* m, std::size_t n) { static_cast<std::vector<M>*>(m)->resize(n); },
      .block = [](void* m, std::size_t i) -> void* { return &(*static_cast<std::vector<M>*>(m))[i]; }};
};
template <class M>
constexpr MemberType optional_type() {
  MemberType type = TypeOf<M>::value;
  static_assert(TypeOf<M>::value.type != FieldType::records, "a list cannot be optional: use an empty list");
  type.optional = true;
  type.is_state = false;
  if constexpr (TypeOf<M>::value.type == FieldType::record && !std::is_same_v<M, Record>) {
    type.size = [](const void* m) {
      return std::size_t{static_cast<const std::optional<M>*>(m)->has_value()};
    };
    type.resize = [](void* m, std::size_t n) {
      auto& member = *static_cast<std::optional<M>*>(m);
      if (n == 0)
        member.reset();
      else if (!member)
        member.emplace();
    };
    type.block = [](void* m, std::size_t) -> void* { return &**static_cast<std::optional<M>*>(m); };
  } else {
    static_assert(TypeOf<M>::value.each == nullptr, "a list of lists cannot be optional: use an empty list");
    type.get = [](const void* m) {
      const auto& member = *static_cast<const std::optional<M>*>(m);
      return member ? TypeOf<M>::value.get(&*member) : Value();
    };
    type.set = [](void* m, const Value& value) {
      auto& member = *static_cast<std::optional<M>*>(m);
      if (!value.given()) return member.reset();
      if (!member) member.emplace();
      TypeOf<M>::value.set(&*member, value);
    };
  }
  return type;
}
template <class M>
struct TROUPE_OF_TYPE TypeOf<std::optional<M>> {
  static constexpr MemberType value = optional_type<M>();
};

/// Appends the field of a member to a table. Throws std::logic_error if the facts contradict one another or
/// the type, or if the table already has a field with the name `name`.
///
/// type: the type of the member; must outlive the table
/// object: address of the struct with its default values
/// member: address of the member in `object`
void add_field(FieldTable& table, std::string_view name, const MemberType& type, const void* object,
               const void* member, std::initializer_list<Fact> facts);
/// Appends a field for a member that generic code cannot read or write (Description::apart()): Field::member
/// is null. Throws std::logic_error if the table already has a field with the name `name`.
void add_apart(FieldTable& table, std::string_view name);
/// Appends the fields of a member that is itself a described struct (Description::part()). They are copies of
/// the fields of `part`, with two changes. Their offsets are relative to `object`. Their defaults, if they
/// have any, are the values in the struct `member`; fields of type record always count as having a default.
/// Throws std::logic_error if `table` already has a field with the name of a new field.
///
/// table: the table of the outer struct
/// part: the table of the member's struct
/// object: address of the outer struct with its default values
/// member: address of the member in `object`
void add_part(FieldTable& table, const FieldTable& part, const void* object, const void* member);
/// Returns the table to which `describe` has added its fields.
FieldTable described_table(void (*describe)(FieldTable& fields));

}  // namespace detail

/// The argument of the function `describe` of a struct T (see the top of this file). For each member of T,
/// `describe` calls one of the functions member(), part(), derived() and apart().
template <class T>
class Description : public detail::MemberList {
 public:
  /// Makes a description without a table, which only counts the described members. For use in constant
  /// expressions.
  constexpr Description() = default;
  /// Makes a description that appends a field to `table` for each described member. `example` is T{}, whose
  /// values become the defaults. `table` and `example` must outlive the description.
  constexpr Description(FieldTable& table, const T& example) : table_(&table), example_(&example) {}

  /// Describes a member as a field with the name `name`. The characters of the name must live as long as the
  /// program or the plug-in; those of a string literal do. The facts may have any order. Throws
  /// std::logic_error if the facts contradict one another or the type of the member, or if the table already
  /// has a field of this name.
  template <auto k_member, class... Facts>
  [[gnu::cold]] constexpr void member(std::string_view name, Facts... facts) {
    using Type = typename detail::Pointed<decltype(k_member)>::Type;
    if (std::is_constant_evaluated())
      count(detail::tag<k_member>(), detail::TypeOf<Type>::value.is_state, detail::k_nests_lists<Type>);
    else
      detail::add_field(*table_, name, detail::TypeOf<Type>::value, example_, &(example_->*k_member),
                        {Fact(facts)...});
  }
  /// Describes a member that is itself a described struct. The fields of that struct become fields of T, at
  /// this position in the table. Their names must differ from those of the other fields of T. Kinds use this
  /// to extend the parameters of another kind. Not for structs that are state.
  template <auto k_member>
  [[gnu::cold]] constexpr void part() {
    using Type = typename detail::Pointed<decltype(k_member)>::Type;
    if (std::is_constant_evaluated())
      count(detail::tag<k_member>(), false, detail::k_nests_lists<Type>);
    else
      detail::add_part(*table_, described<Type>(), example_, &(example_->*k_member));
  }
  /// Marks a member that gets no field, and so is neither stored nor compared, for example because it can be
  /// computed from the other members. Not for structs that are state.
  template <auto k_member>
  constexpr void derived() {
    if (std::is_constant_evaluated()) count(detail::tag<k_member>(), false);
  }

  /// Describes a member that generic code cannot read or write. Its field has a name and a position in the
  /// table, but Field::member is null, and get() and set() throw std::logic_error. Functions that visit all
  /// fields, for example to store or compare them, need code of their own for such a member. Not for structs
  /// that are state.
  template <auto k_member>
  [[gnu::cold]] constexpr void apart(std::string_view name) {
    if (std::is_constant_evaluated())
      count(detail::tag<k_member>(), false);
    else
      detail::add_apart(*table_, name);
  }

 private:
  FieldTable* table_ = nullptr;
  const T* example_ = nullptr;
};

namespace detail {
/// Runs the description of T without a table, to count and check the members that it describes.
template <class T>
constexpr MemberList described_members() {
  Description<T> d;
  describe_members(d);
  return d;
}
}  // namespace detail

/// Returns the fields of a described struct, in the order of its description. The table has static storage.
/// Thread-safe.
///
/// The first call builds the table. It throws std::logic_error if the description contradicts itself:
/// - two fields have the same name;
/// - a lower limit is above an upper limit;
/// - a std::optional has a default or is `required`;
/// - a unit, a limit, one_of(), columns(), counts_readings or `required` does not suit the type of the
/// member.
template <class T>
TROUPE_OF_TYPE const FieldTable& described() {
  static_assert(std::is_aggregate_v<T>,
                "a described struct must have no constructors: give its members initial values");
  static_assert(detail::has_members<T, detail::described_members<T>().members()>(),
                "describe() must describe every member");
  static_assert(!detail::described_members<T>().repeats(), "describe() describes a member twice");
  static const FieldTable table = detail::described_table([](FieldTable& fields) {
    const T example{};
    Description<T> d(fields, example);
    detail::describe_members(d);
  });
  return table;
}

/// Describes a pose. x, y and z are from -100 km to 100 km, and the heading is up to ten turns in either
/// direction. Each is 0 by default. pose_fields() returns the resulting table.
constexpr void describe(Description<Pose>& d) {
  using namespace facts;
  using enum Unit;
  constexpr Fact k_coordinate = within(-k_world_reach_m, k_world_reach_m);
  constexpr double k_turns = 20 * k_pi;  // more than ten turns is probably a wrong unit
  d.member<&Pose::x>("x", meters, k_coordinate, "along x: forward, if the frame is a body's");
  d.member<&Pose::y>("y", meters, k_coordinate, "along y: left, if the frame is a body's");
  d.member<&Pose::z>("z", meters, k_coordinate, "up");
  d.member<&Pose::heading>("heading", radians, within(-k_turns, k_turns), "counter-clockwise from +x");
}

/// Returns the values of the struct at `object`, which `table` describes, as a record: one value per field.
/// An empty std::optional gives a value whose given() is false. Throws std::logic_error if generic code
/// cannot read one of the members (Description::apart()).
Record record_of(const FieldTable& table, const void* object);
/// Sets the members of the struct at `object`, which `table` describes. The record has one value per field.
/// Members for which it has no value (Value::given() is false) stay as they are. A std::vector of structs and
/// a std::optional struct are replaced by new structs, in which members without a value have their defaults.
/// The limits of the table are not checked. Throws
/// - std::bad_variant_access if a value has another type than its member. This includes any value of a list
///   of lists of numbers (MemberType::each), which this function cannot set;
/// - std::invalid_argument if a member cannot hold its value, such as 300 for a std::uint8_t;
/// - std::logic_error if there is a value for a member that generic code cannot write (Description::apart()).
///
/// After an exception, the members before the one with the error are set.
///
/// If a reader of files has checked the record against the table, a value can cause one of the first two
/// exceptions only if it belongs to a list of lists of numbers.
void fill(const FieldTable& table, void* object, const Record& record);

/// Returns the value of one member of the struct at `object`. For an empty std::optional, Value::given() is
/// false. Throws std::logic_error if generic code cannot read the member (Description::apart()).
Value get(const Field& field, const void* object);
/// Sets one member of the struct at `object`. If `value` has no value (Value::given() is false), a
/// std::optional becomes empty, and any other member stays as it is. Throws the exceptions of fill().
void set(const Field& field, void* object, const Value& value);

/// Returns a T with the values of a record, which has one value per field of described<T>(). Members for
/// which the record has no value have the defaults of T{}. Throws the exceptions of fill(). Does not compile
/// if a member of T is, or contains, a list of lists of numbers.
template <class T>
T from_record(const Record& record) {
  static_assert(
      !detail::described_members<T>().nests_lists(),
      "a parameter of a kind cannot be a list of lists of numbers: use a std::vector of a described "
      "struct");
  T object{};
  fill(described<T>(), &object, record);
  return object;
}
/// Returns the values of a struct as a record: one value per field of described<T>(). Throws the exceptions
/// of record_of().
template <class T>
Record to_record(const T& object) {
  return record_of(described<T>(), &object);
}

/// Converts the table of a described struct to the fields of a StateTable whose rows are such structs. Every
/// member must be a number, a bool or an array of these. This function does not check this condition; its
/// caller memory_fields() in engine/kinds/controller.hpp checks it at compile time.
std::vector<StateField> state_fields(const FieldTable& table);

}  // namespace troupe::engine

#undef TROUPE_OF_TYPE
