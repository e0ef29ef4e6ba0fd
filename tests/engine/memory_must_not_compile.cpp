// Memories that a controller cannot have. Compiled once for each FAULT, which must fail with its message, and
// once without, which must not (tests/CMakeLists.txt).
#include "engine/kinds/controller.hpp"

#define UNLISTED 1
#define POINTER 2
#define TWICE 3
#define NESTED 4
#define CONSTRUCTED 5
#define STRING 6
#define ALIGNED 7
#define ENUM 8

struct Nested {
  double x = 0;
};
enum State : std::uint8_t { walking, resting };

#if FAULT == ALIGNED
#define ALIGNMENT alignas(64)
#else
#define ALIGNMENT
#endif

struct ALIGNMENT Memory {
  float turn_left_s = 0;
  std::uint32_t count = 0;
#if FAULT == UNLISTED
  bool forgotten = false;
#endif
#if FAULT == POINTER
  const float* pointer = nullptr;
  TROUPE_FIELDS(turn_left_s, count, pointer)
#elif FAULT == TWICE
  TROUPE_FIELDS(count, count)
#elif FAULT == NESTED
  Nested nested;
  TROUPE_FIELDS(turn_left_s, count, nested)
#elif FAULT == ENUM
  State state = walking;
  TROUPE_FIELDS(turn_left_s, count, state)
#elif FAULT == CONSTRUCTED
  Memory() {}
  TROUPE_FIELDS(turn_left_s, count)
#elif FAULT == STRING
  std::string text;
  TROUPE_FIELDS(turn_left_s, count, text)
#else
  TROUPE_FIELDS(turn_left_s, count)
#endif
};

std::vector<troupe::engine::StateField> fields() { return troupe::engine::memory_fields<Memory>(); }
