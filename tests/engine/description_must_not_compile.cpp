// Descriptions that must not compile. Compiled once for each FAULT, which must fail with its message, and
// once without, which must not (tests/CMakeLists.txt).
#include "engine/kinds/controller.hpp"

#define UNDESCRIBED 1
#define TWICE 2
#define POINTER 3
#define CONSTRUCTED 4
#define TEXT 5
#define UNNAMED 6
#define NESTED 7
#define NESTED_DEEPER 8

enum class Law : std::uint8_t { disc, walls };
#if FAULT != UNNAMED
constexpr std::array<std::string_view, 2> names_of(Law) { return {"disc", "walls"}; }
#endif

struct Inner {
#if FAULT == NESTED_DEEPER
  std::vector<std::vector<std::array<double, 2>>> lines;
#else
  std::array<double, 2> lines{};
#endif

  static constexpr void describe(troupe::engine::Description<Inner>& d) { d.member<&Inner::lines>("lines"); }
};

struct Params {
  double speed = 0.3;
  std::optional<bool> again;
  Law law = Law::disc;
  std::vector<Inner> inners;
#if FAULT == NESTED
  std::vector<std::array<double, 2>> points;
#endif
#if FAULT == UNDESCRIBED
  bool forgotten = false;
#elif FAULT == POINTER
  const float* pointer = nullptr;
#elif FAULT == CONSTRUCTED
  Params() {}
#endif

  static constexpr void describe(troupe::engine::Description<Params>& d) {
    d.member<&Params::speed>("speed", troupe::engine::facts::at_least(0), "on the way");
#if FAULT == TWICE
    d.member<&Params::speed>("pace", "on the way");
#else
    d.member<&Params::again>("again", "from the start");
#endif
    d.member<&Params::law>("law", "of the road");
    d.member<&Params::inners>("inners");
#if FAULT == NESTED
    d.member<&Params::points>("points", "on the way");
#endif
#if FAULT == POINTER
    d.member<&Params::pointer>("pointer", "to the way");
#endif
  }
};

struct State {
  double x = 0;
#if FAULT == TEXT
  std::array<char, 8> text{};
#endif

  static constexpr void describe(troupe::engine::Description<State>& d) {
    d.member<&State::x>("x");
#if FAULT == TEXT
    d.member<&State::text>("text");
#endif
  }
};

Params params() { return troupe::engine::from_record<Params>({}); }
const troupe::engine::FieldTable& fields() { return troupe::engine::described<Params>(); }
std::vector<troupe::engine::StateField> state() { return troupe::engine::memory_fields<State>(); }
