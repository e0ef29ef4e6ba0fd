#include "tests/fuzz/libfuzzer.hpp"
#include "tests/fuzz/stage_mutator.hpp"
#include "tests/fuzz/targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  troupe::fuzz::read_stage({reinterpret_cast<const char*>(data), size});
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most,
                                               unsigned seed) {
  if (!troupe::fuzz::by_bytes(seed))
    if (const std::string text =
            troupe::fuzz::mutate_stage({reinterpret_cast<const char*>(data), size}, seed);
        !text.empty() && text.size() <= most)
      return troupe::fuzz::put(text, data);
  return LLVMFuzzerMutate(data, size, most);
}
