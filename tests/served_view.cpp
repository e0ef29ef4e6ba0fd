// Serves a live view of a world (docs/live.md) and runs ten ticks in it, for mpi_test.py:
//
//     served_view WORLD
//
// Prints the error that two ranks give, the address of the page and, after the last tick, the hash of the
// state.

#include "live/view.hpp"
#include "troupe/simulation.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <stdexcept>

int main(int count, char** arguments) try {
  if (count != 2) throw std::invalid_argument("usage: served_view WORLD");
  const char* world = arguments[1];
  try {
    const troupe::Simulation on_ranks(world, {.threads = 1, .ranks = 2});
    fmt::print("error none\n");
  } catch (const std::invalid_argument& error) {
    fmt::print("error {}\n", error.what());
  }
  troupe::Simulation simulation(world, {.threads = 1});
  troupe::live::View view(simulation,
                          {.rate = 0, .is_over = [&simulation] { return simulation.tick() >= 10; }});
  fmt::print("view {}\n", view.address());
  std::fflush(stdout);
  view.run();
  fmt::print("hash {:016x}\n", simulation.state_hash());
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}
