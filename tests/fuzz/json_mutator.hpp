#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::fuzz {

/// Mutates JSON documents as trees, guided by a JSON Schema. It inserts keys where the schema allows them,
/// with values that fit the schema or lie just outside its limits; replaces numbers by edge cases; and
/// deletes, duplicates, swaps and generates subtrees. Random changes of bytes, in contrast, seldom result in
/// a document that can be read.
class JsonMutator {
 public:
  /// schema: the text of a JSON Schema, as worldio::world_schema() returns it. The mutator uses `properties`,
  /// `required`, `items`, `anyOf`, `oneOf`, `allOf`, `const`, `enum`, limits, and each `$ref` to a member of
  /// `definitions`.
  explicit JsonMutator(std::string_view schema);
  ~JsonMutator();

  /// A function that mutates the bytes of one text value, as LLVMFuzzerMutate does. May be empty.
  using MutateText = std::function<void(std::string& text)>;

  /// Returns a mutation of `text`, which depends only on `text`, `seed` and the results of `mutate_text`. It
  /// may be longer than `text`. Returns an empty text if `text` is not JSON or is nested more than 64 levels
  /// deep; the caller then has to mutate it in another way.
  std::string mutate(std::string_view text, std::uint32_t seed, const MutateText& mutate_text) const;
  /// Returns the document `first` with one of its subtrees replaced by a random subtree of `second`. The
  /// replaced subtree has the same key as the new one, if `first` has such a subtree. Returns an empty text
  /// if `first` or `second` is not JSON.
  std::string cross(std::string_view first, std::string_view second, std::uint32_t seed) const;

  /// All keys in the schema, sorted, for the dictionary of libFuzzer.
  std::vector<std::string> keys() const;
  /// All texts that the schema lists as values (`const`, `enum`), sorted, for the same dictionary.
  std::vector<std::string> words() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The mutator for JSON worlds.
const JsonMutator& world_mutator();
/// The mutator for studies (docs/sweeps.md).
const JsonMutator& study_mutator();

}  // namespace troupe::fuzz
