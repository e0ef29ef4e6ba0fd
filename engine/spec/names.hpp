#pragma once

#include "base/ids.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::engine {

/// Largest size of a name in a world file, bytes. Every body of a population has its name, so that longer
/// names make loading slow.
inline constexpr std::size_t k_most_name_bytes = 4096;

/// The name of a body, in eight bytes: a word of a Names table, and a number that follows the word. For
/// example, "r17" is the word "r" and the number 17. The number has at most nine digits and no leading zeros,
/// so "r007" is the word "r00" and the number 7. Two names of one table are equal if and only if their texts
/// are equal.
struct Name {
  static constexpr std::uint32_t k_no_number = ~0u;  ///< no number follows the word
  std::uint32_t word = 0;                            ///< index into Names::words(); 0 is the empty text
  std::uint32_t number = k_no_number;                ///< the number after the word; k_no_number: none
  friend bool operator==(Name, Name) = default;
};

/// The table of the words from which names are made. The names of a population, the bodies "r0", "r1", ...,
/// normally share one word. A million names then need memory for one text only. (A string per body was
/// rejected: it took 32 bytes per body, and most of the loading time of a large population.)
class Names {
 public:
  /// A table that contains only the empty word, so that Name() is the empty text.
  Names() { intern(""); }
  /// Makes a copy of another table. `words` is the result of words() of that table. Names of the other table
  /// are valid for the copy. Throws std::invalid_argument if the list is empty, if its first word is not
  /// empty, or if a word occurs twice.
  explicit Names(std::vector<std::string> words);

  /// All words in the order in which they were added; the first is empty.
  std::span<const std::string> words() const { return words_; }

  /// Returns the name with this text, which may be empty. If the table lacks the word of the name, adds that
  /// word.
  Name add(std::string_view text);
  /// Returns the name whose text is `text` followed by the number: add("r", 17) equals add("r17"). If the
  /// table lacks the word of the name, adds that word.
  Name add(std::string_view text, std::uint32_t number);
  /// Returns the name with this text; std::nullopt if the table lacks the word of that name.
  std::optional<Name> find(std::string_view text) const;
  /// The name as text: its word and its number. The word must be in this table.
  std::string text(Name name) const;

 private:
  std::uint32_t intern(std::string_view word);

  std::vector<std::string> words_;
  std::map<std::string, std::uint32_t, std::less<>> positions_;  // in words_
};

/// The name without the digits at its end. The bodies "r0", "r1", ... of the population "r" all give "r". If
/// the name has no digits at its end, returns the whole name.
std::string_view without_number(std::string_view name);
/// Whether `name` is the name of a body of the population `population`: the name of the population, followed
/// by one or more digits. The name "r217" fits the population "r2", and also the population "r".
bool is_of_population(std::string_view name, std::string_view population);
/// As the function above, for a name of the table `names`. Faster, because it converts few names to text.
bool is_of_population(const Names& names, Name name, std::string_view population);

/// Makes the names of a list unique: a name that an earlier entry has gets a number. With the mark "#", the
/// second "eye" becomes "eye#2", or "eye#3" if an earlier entry is already called "eye#2".
class UniqueNames {
 public:
  /// mark: the text between the name and the number
  explicit UniqueNames(std::string_view mark) : mark_(mark) {}
  /// Returns the unique name of the next entry: `name` itself unless it is taken.
  std::string add(std::string_view name);

 private:
  std::string mark_;
  std::map<std::string, int> next_;  // taken name -> the first number that add() tries for it
};
/// The mark of UniqueNames for the devices of a body type: of two sensors "eye", the second is called
/// "eye#2".
inline constexpr std::string_view k_device_mark = "#";

/// A name and the body that has it.
struct NamedBody {
  Name name;    ///< the name, in the table WorldSpec::names
  BodyId body;  ///< the body; not valid() in a free slot of a NameMap
};

/// A map from names to bodies: a hash table with open addressing. All names must be from one Names table.
class NameMap {
 public:
  std::size_t size() const { return size_; }  ///< number of names
  /// Reserves memory for `names` names in total, including the names that the map already has.
  void reserve(std::size_t names);
  /// Gives the name to `body`, which must be valid(), unless another body has the name already. Returns the
  /// body that has the name after the call.
  BodyId add(Name name, BodyId body);
  /// Gives the name to `body`, which must be valid(), even if another body has the name.
  void set(Name name, BodyId body);
  /// The body that has the name; not valid() if there is none.
  BodyId find(Name name) const;

 private:
  /// Index of the slot that contains the name or, if there is none, of the free slot in which the name must
  /// be stored.
  std::size_t slot_of(Name name) const;
  NamedBody& take(Name name);

  std::vector<NamedBody> slots_;  // the body of a free slot is not valid
  std::size_t size_ = 0;
};

}  // namespace troupe::engine
