// A plug-in as it should be: a parameter, memory, random numbers and Troupe's own maths. Built as TURN says,
// to have several builds of it.
#include <troupe/plugin.hpp>

#ifndef TURN
#define TURN 0.3
#endif

struct Walker {  // not in an unnamed namespace: others may bring one of this name
  double speed;

  static constexpr std::string_view text = "walk in wiggles";
  static troupe::FieldTable parameters() {
    return {{{.name = "speed",
              .unit = troupe::Unit::meters_per_second,
              .fallback = 0.3,
              .min = 0,
              .text = "on the way"}}};
  }
  static Walker make(const troupe::Record& params) { return {params[0].number()}; }

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
    actions.command = {speed * troupe::cos(memory.phase), 0, troupe::sin(memory.phase)};
  }
};

TROUPE_CONTROLLER("walker", Walker)
