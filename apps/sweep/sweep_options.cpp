#include "apps/options.hpp"
#include "apps/sweep/sweep.hpp"
#include "base/number_text.hpp"
#include "worldio/json/study.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <string>

namespace troupe::apps {
namespace {

constexpr const char* k_sweep_footer = R"(
A study is a JSON file that names a world, the parameters that vary between runs (a grid or random samples), seeds and
measures (docs/sweeps.md). Runs are made in parallel, each on one thread. When a run finishes, its result is saved in
DIR. To continue a sweep that was stopped or killed, give the same command again. When all runs are finished, DIR
contains the table with one row per run (table.csv and table.h5). If the study has "series": true, DIR also contains the
measures over time (series.csv), which troupe plot draws. The tables depend neither on the number of parallel runs nor
on interruptions.

With --part, several machines share a study, as in a SLURM array of eight jobs:
  sbatch --array=1-8 --wrap 'troupe sweep study.json -o results --part $SLURM_ARRAY_TASK_ID/8'
The process that finishes last writes the tables. Under mpirun or srun, all processes share the runs (docs/cluster.md):
  mpirun -n 8 troupe sweep study.json -o results

Exit codes: 0 finished (with --part: this part); 1 runs failed, see the messages and the table's column `error`; 2 bad
study or usage; 3 stopped by Ctrl-C, SIGTERM or SIGHUP.

Examples:
  troupe sweep apps/examples/study/coverage.json -o results
  troupe sweep apps/examples/study/coverage.json --list)";

}  // namespace

void add_sweep_options(CLI::App& command, SweepOptions& options) {
  command.footer(k_sweep_footer);
  add_argument(command, "STUDY", "Study, in JSON", options.study);
  add_value(command, "-o,--out", "DIR", "Folder for the results of the runs and the tables; may exist",
            [&options](const std::string& text) {
              if (text.empty() || text.starts_with('-')) refuse("--out", text, "the name of a folder");
              options.folder = text;
              if (!options.folder.has_filename()) options.folder = options.folder.parent_path();
            });
  add_value(command, "--threads", "N", "Number of parallel runs (default: one per available processor)",
            [&options](const std::string& text) { options.runs_at_once = thread_count(text); });
  add_value(command, "--part", "I/N", "Make only every N-th run, beginning with the I-th (1 to N)",
            [&options](const std::string& text) {
              const auto slash = text.find('/');
              const auto part = number_of<std::size_t>(text.substr(0, slash));
              const auto parts =
                  slash == text.npos ? std::nullopt : number_of<std::size_t>(text.substr(slash + 1));
              if (!part || !parts || *part < 1 || *part > *parts || *parts > worldio::k_most_runs)
                refuse("--part", text,
                       fmt::format("a part I/N, with I from 1 to N and N at most {}, as in --part 2/8",
                                   worldio::k_most_runs));
              options.part = *part;
              options.parts = *parts;
            });
  add_switch(command, "--list", options.list, "Print the list of runs without making them");
  add_switch(command, "--quiet", options.quiet, "Print only errors");
  add_kind_options(command, options.sources);
  add_simd_option(command);
  add_rank_limit_option(command, options.rank_limit_s);
}

}  // namespace troupe::apps
