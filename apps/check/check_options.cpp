#include "apps/check/check_options.hpp"

#include "base/split.hpp"

#include <CLI/CLI.hpp>

#include <string>
#include <string_view>

namespace troupe::apps {
namespace {

constexpr const char* k_check_footer = R"(
Checks that the number of threads, the number of ranks and the size of the tiles (the squares of the world that threads
process) do not change the results of a world. Runs one variant of the world for each combination of --threads,
--tile-size and --ranks, all side by side, and compares every component of the state after each tick. Stops at the first
tick at which a variant differs from the first variant. Prints the component, the robot, the field, the value in the
variant and the value in the first variant.

With --ranks, the world also runs on each given number of ranks, which divide its robots among themselves
(docs/cluster.md). With --distribute, a rank has only its own robots and those near them, if the world allows it;
without it, all robots. The ranks are threads of this process. Their messages arrive late and in a shuffled order, and
in each tick robots move to other ranks, both at random with the seed --rank-seed (default: 1). After each tick, the
data that every rank computes are compared between the ranks. Under mpirun, --ranks is not allowed; instead, the world
also runs on all processes.

--amnesia adds three variants. In the first, all data that are not part of the state are overwritten with junk after
each tick and computed again. In the second, the world is discarded after each tick and rebuilt from its description and
its state, as in a resumed run. In the third, every body gets another place in memory after each tick. These variants
find data that influence a later tick but are not part of the state, and code that confuses a body with its place in
memory.

--reach adds a variant in which every device computes one robot at a time. The kind of a device declares its reach (the
distance up to which it reads other bodies), the state of other bodies that it reads, and the bodies that it changes.
While a device computes, bodies beyond its reach are removed from the world and their state is junk; of the nearer
bodies, only the declared state is kept. This variant finds devices that read or change more than their kind declares.
It is slow, and only possible for worlds with "ranging": "exact".

--controllers computes every decision of the first variant twice more, from the same readings and memory: once in
another order, on another thread and in memory filled with junk, and once with a newly constructed controller. The
option finds controllers that call rand(), keep a static variable, read the clock, leave a member uninitialised or
change a command or the memory of another robot, and prints the field that differs. The command waits 1.1 s after the
first decision, to detect clocks that count seconds. docs/determinism.md describes what --controllers cannot detect.

The run ends as in troupe run: at --for S, else at the quit_time of the world.

Exit codes: 0 same bits; 1 different; 2 bad input or usage.

Examples:
  troupe check worlds/crowd.json --for 5
  troupe check worlds/hospital.json --for 5 --threads 1,2,3,4,8 --tile-size auto,1.7,45.1
  troupe check worlds/hospital.json --for 5 --ranks 1,2,3,4,7 --threads 1,2
  troupe check worlds/failures.json --for 20 --threads 1 --tile-size auto --amnesia
  troupe check worlds/cave-simple.json --for 5 --threads 2 --tile-size auto --controllers)";

}  // namespace

void add_check_options(CLI::App& check, CheckOptions& options) {
  check.footer(k_check_footer);
  add_world_options(check, options);
  add_value(check, "--threads", "N,...", "Numbers of worker threads to compare (default: 1,2,8)",
            [&options](const std::string& text) {
              options.threads.clear();
              for (const std::string_view item : split(text, ','))
                options.threads.push_back(thread_count(item));
            });
  add_value(check, "--tile-size", "M,...",
            "Edge lengths of tiles to compare, m; auto: Troupe chooses (default: auto,1.7)",
            [&options](const std::string& text) {
              options.tile_sizes_m.clear();
              for (const std::string_view item : split(text, ','))
                options.tile_sizes_m.push_back(item == "auto" ? 0 : tile_size_m(item));
            });
  add_value(check, "--ranks", "N,...", "Numbers of ranks to compare (default: 1)",
            [&options](const std::string& text) {
              options.ranks.clear();
              for (const std::string_view item : split(text, ',')) options.ranks.push_back(rank_count(item));
              options.gives_ranks = true;
            });
  add_distribute_option(check, options);
  add_rank_limit_option(check, options.rank_limit_s);
  add_rank_seed_option(check, options);
  add_switch(check, "--amnesia", options.amnesia,
             "Also compare runs that must not differ: after each tick, one replaces all data computed from\n"
             "the state by junk and computes them again, one builds the world again from the state, and one\n"
             "moves the bodies to other places in memory");
  add_switch(check, "--reach", options.reach,
             "Also compare a run in which devices can read only the bodies and state that they declare");
  add_switch(check, "--controllers", options.controllers,
             "Also repeat each decision of a controller and compare the results");
}

}  // namespace troupe::apps
