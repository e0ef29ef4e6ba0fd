#pragma once

#include "tests/fuzz/json_mutator.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

/// Functions that connect libFuzzer with the mutators, which change inputs at random with knowledge of their
/// format (tests/fuzz/json_mutator.hpp). The mutators do not depend on libFuzzer, so they can be tested
/// without it.
namespace troupe::fuzz {

/// Whether the mutation with this seed is left to libFuzzer itself, which changes bytes without knowledge of
/// the format. This is so for one seed in five. libFuzzer's own mutations are needed because only they use
/// dictionaries, and the values with which the program compares its input.
inline bool by_bytes(unsigned seed) { return seed % 5 == 0; }

/// Copies the text to `data`, which must have space for it, and returns its size.
inline std::size_t put(std::string_view text, std::uint8_t* data) {
  std::memcpy(data, text.data(), text.size());
  return text.size();
}

/// Implements LLVMFuzzerCustomMutator for JSON documents: replaces the document of `size` bytes at `data` by
/// a mutation of at most `most` bytes. Returns the new size, bytes. Leaves the mutation to libFuzzer if
/// by_bytes(seed) is true, if the document is not JSON, or if the result of the mutator is too long.
inline std::size_t mutate_json(const JsonMutator& mutator, std::uint8_t* data, std::size_t size,
                               std::size_t most, unsigned seed) {
  const auto mutate_text = [](std::string& text) {
    constexpr std::size_t k_longer = 16;
    const std::size_t length = text.size();
    text.resize(length + k_longer);
    text.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(text.data()), length, text.size()));
  };
  if (!by_bytes(seed))
    if (const std::string text =
            mutator.mutate({reinterpret_cast<const char*>(data), size}, seed, mutate_text);
        !text.empty() && text.size() <= most)
      return put(text, data);
  return LLVMFuzzerMutate(data, size, most);
}

/// Implements LLVMFuzzerCustomCrossOver for JSON documents: writes a document made of parts of `first` and
/// `second` to `out`, at most `most` bytes. Returns its size, bytes. Returns 0 if `first` or `second` is not
/// JSON, or if the result is too long.
inline std::size_t cross_json(const JsonMutator& mutator, std::string_view first, std::string_view second,
                              std::uint8_t* out, std::size_t most, unsigned seed) {
  const std::string text = mutator.cross(first, second, seed);
  return text.size() <= most ? put(text, out) : 0;
}

}  // namespace troupe::fuzz
