#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::fuzz {

/// Changes JSON documents at random for fuzz tests, guided by a JSON Schema. A document is changed as a tree:
/// random changes of its bytes would seldom give valid JSON. The mutator makes these changes:
/// - It inserts keys that the schema allows. Their values fit the schema or lie just outside its limits.
/// - It replaces numbers by edge cases.
/// - It deletes, duplicates, swaps and generates subtrees.
/// - It changes texts.
class JsonMutator {
 public:
  /// schema: the text of a JSON Schema, such as worldio::world_schema() returns. The mutator uses
  /// `properties`, `required`, `items`, `anyOf`, `oneOf`, `allOf`, `const`, `enum`, limits, and each `$ref`
  /// to a member of `definitions`. It ignores all else.
  explicit JsonMutator(std::string_view schema);
  ~JsonMutator();

  /// A function that changes one text in a document, such as a wrapper of LLVMFuzzerMutate. An empty
  /// std::function is allowed; texts are then changed only in other ways.
  using MutateText = std::function<void(std::string& text)>;

  /// Returns a changed copy of the document `text`, which may be longer. The result depends only on `text`,
  /// `seed` and the results of `mutate_text`. Returns an empty text if `text` is not JSON or is nested more
  /// than 64 levels deep. The caller must then change `text` in another way.
  std::string mutate(std::string_view text, std::uint32_t seed, const MutateText& mutate_text) const;
  /// Returns a copy of the document `first` in which one subtree is replaced by a random subtree of the
  /// document `second`. If `first` has subtrees with the same key as the new subtree, one of these is
  /// replaced, else any. Returns an empty text if `first` or `second` is not JSON or is nested more than 64
  /// levels deep.
  std::string cross(std::string_view first, std::string_view second, std::uint32_t seed) const;

  /// Returns all keys in the schema, sorted. They become entries of the dictionary of libFuzzer.
  std::vector<std::string> keys() const;
  /// Returns all texts that the schema lists as values (`const` and `enum`), sorted. They become entries of
  /// the dictionary of libFuzzer.
  std::vector<std::string> words() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Returns the mutator for world files in JSON.
const JsonMutator& world_mutator();
/// Returns the mutator for studies. A study is a JSON file that describes many runs of a world with different
/// parameters and seeds (docs/sweeps.md).
const JsonMutator& study_mutator();

}  // namespace troupe::fuzz
