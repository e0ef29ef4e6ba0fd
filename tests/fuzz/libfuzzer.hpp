#pragma once

#include "tests/fuzz/json_mutator.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

/// Functions that connect libFuzzer with the mutators. The mutators do not depend on libFuzzer, so they can
/// be tested without it.
namespace troupe::fuzz {

/// Whether libFuzzer itself makes the mutation with this seed, which holds for one mutation in five. Only
/// libFuzzer's mutations use dictionaries and the values that the program compares its input with.
inline bool by_bytes(unsigned seed) { return seed % 5 == 0; }

/// Copies the text to `data`, which must have space for it, and returns its size.
inline std::size_t put(std::string_view text, std::uint8_t* data) {
  std::memcpy(data, text.data(), text.size());
  return text.size();
}

/// Implements LLVMFuzzerCustomMutator for JSON documents.
inline std::size_t mutate_json(const JsonMutator& mutator, std::uint8_t* data, std::size_t size,
                               std::size_t most, unsigned seed) {
  const auto mutate_text = [](std::string& text) {
    constexpr std::size_t k_longer = 16;
    const std::size_t size = text.size();
    text.resize(size + k_longer);
    text.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(text.data()), size, text.size()));
  };
  if (!by_bytes(seed))
    if (const std::string text =
            mutator.mutate({reinterpret_cast<const char*>(data), size}, seed, mutate_text);
        !text.empty() && text.size() <= most)
      return put(text, data);
  return LLVMFuzzerMutate(data, size, most);
}

/// Implements LLVMFuzzerCustomCrossOver for two JSON documents. Returns 0 if an input is not JSON or if the
/// result is longer than `most` bytes.
inline std::size_t cross_json(const JsonMutator& mutator, std::string_view first, std::string_view second,
                              std::uint8_t* out, std::size_t most, unsigned seed) {
  const std::string text = mutator.cross(first, second, seed);
  return text.size() <= most ? put(text, out) : 0;
}

}  // namespace troupe::fuzz
