#pragma once

#include "base/ids.hpp"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::engine {

/// A body's name in eight bytes: a word of a Names table and the number that stands behind it. "r17" is word
/// "r", number 17. Of one table, equal texts are equal names, and unequal ones differ.
struct Name {
  static constexpr std::uint32_t k_no_number = ~0u;  ///< there is no number behind the word
  std::uint32_t word = 0;                            ///< index into Names::words(); 0 is the empty text
  std::uint32_t number = k_no_number;                ///< written without leading zeros
  friend bool operator==(Name, Name) = default;
};

/// The words that names are made of: a crowd shares one, so that a million names cost no text. (A string for
/// each body lost: 32 bytes of it and most of the time that a large population took to load.)
class Names {
 public:
  /// A Name() is the empty text.
  Names() { intern(""); }
  /// The table that had these words(), so that its names are names of this one. Throws std::invalid_argument
  /// where no table has such words: the first must be empty, and each stand there once.
  explicit Names(std::vector<std::string> words);

  /// In the order in which they came; the first is empty.
  std::span<const std::string> words() const { return words_; }

  /// The name of a text, which is kept.
  Name add(std::string_view text);
  /// The name of a text with a number behind it: add("r", 17) is add("r17").
  Name add(std::string_view text, std::uint32_t number);
  /// The name of a text; nothing where no name with its word was added.
  std::optional<Name> find(std::string_view text) const;
  std::string text(Name name) const;  ///< as add() was given it

 private:
  std::uint32_t intern(std::string_view word);

  std::vector<std::string> words_;
  std::map<std::string, std::uint32_t, std::less<>> positions_;  // of the words
};

/// Who has a name.
struct NamedBody {
  Name name;    ///< of one table, the world's
  BodyId body;  ///< not valid: no body
};

/// Bodies by their names: a hash table with open addressing.
class NameMap {
 public:
  std::size_t size() const { return size_; }  ///< names that bodies have
  /// Makes room for so many names.
  void reserve(std::size_t names);
  /// The body that has the name: `body` where no other had it before.
  BodyId add(Name name, BodyId body);
  /// Gives the name to the body, even where another one had it.
  void set(Name name, BodyId body);
  /// Not valid where no body has the name.
  BodyId find(Name name) const;

 private:
  /// Position of the slot that holds a name, or of the free one where it belongs.
  std::size_t slot_of(Name name) const;
  NamedBody& take(Name name);

  std::vector<NamedBody> slots_;  // free ones hold no valid body
  std::size_t size_ = 0;
};

}  // namespace troupe::engine
