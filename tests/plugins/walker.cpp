// A correct plug-in: a parameter, memory, random numbers and Troupe's maths. TURN selects one of several
// builds.
#include <troupe/plugin.hpp>

#ifndef TURN
#define TURN 0.3
#define ABOUT "on the way"
#else
#define ABOUT "on another way"
#endif

struct Walker {  // not in an unnamed namespace: others may bring one of this name
  struct Params {
    double speed = 0.3;

    static constexpr void describe(troupe::Description<Params>& d) {
      using namespace troupe::facts;
      d.member<&Params::speed>("speed", troupe::Unit::meters_per_second, at_least(0), ABOUT);
    }
  };

  Params params;

  static constexpr std::string_view text = "walk in wiggles";

  struct Memory {
    double phase = 0;
    double faint = 0;  // a denormal number, as long as there are any
    std::uint32_t steps = 0;
    TROUPE_FIELDS(phase, faint, steps)
  };

  void operator()(Memory& memory, const troupe::Percept&, troupe::Random& random,
                  troupe::Actions& actions) const {
    memory.phase += TURN * random.normal();
    memory.faint = 0.5 * (memory.faint + 0x1p-1050 * random.uniform());
    ++memory.steps;
    actions.command = {params.speed * troupe::cos(memory.phase), 0, troupe::sin(memory.phase)};
  }
};

TROUPE_CONTROLLER("walker", Walker)
