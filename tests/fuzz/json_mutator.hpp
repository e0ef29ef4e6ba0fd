#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::fuzz {

/// Changes JSON documents as trees, guided by a JSON Schema: keys are inserted where the schema knows them,
/// with values that fit it or lie just beyond its limits; numbers become edge values; subtrees are deleted,
/// duplicated, swapped and generated again. Mutations of bytes alone seldom leave a document that can be
/// read.
class JsonMutator {
 public:
  /// The schema as worldio::world_schema() prints it: `properties`, `items`, `anyOf`, `oneOf`, `allOf`,
  /// `const`, `enum`, limits and `$ref`s into `definitions` are understood.
  explicit JsonMutator(std::string_view schema);
  ~JsonMutator();

  /// Changes one text that is no key, as LLVMFuzzerMutate does with bytes. May be empty.
  using MutateText = std::function<void(std::string& text)>;

  /// A mutation of `text`, a pure function of both and of what `mutate_text` does. Empty where the text is no
  /// JSON of at most 64 levels: to be mutated otherwise. May be longer than the text.
  std::string mutate(std::string_view text, std::uint32_t seed, const MutateText& mutate_text) const;
  /// `first` with a subtree of `second` in the place of one of its own, of the same key where there is one.
  /// Empty where either is no JSON.
  std::string cross(std::string_view first, std::string_view second, std::uint32_t seed) const;

  /// Every key and every text that the schema names, sorted: a dictionary.
  std::vector<std::string> keys() const;
  std::vector<std::string> words() const;  ///< the texts

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The schema of worlds; and that of studies of them (docs/sweeps.md), whose measures are those of worlds.
const JsonMutator& world_mutator();
const JsonMutator& study_mutator();

}  // namespace troupe::fuzz
