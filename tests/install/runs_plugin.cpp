// A program that runs a world whose controllers or sensors are plug-ins: runs_plugin WORLD FOLDER prints the
// state's hash after 10 s.
#include <troupe/troupe.hpp>

#include <cinttypes>
#include <cstdio>

int main(int, char** argv) {
  troupe::SimulationOptions options;
  options.plugin_path = {argv[2]};
  troupe::Simulation simulation(argv[1], options);
  simulation.run_for(10);
  std::printf("%016" PRIx64 "\n", simulation.state_hash());
}
