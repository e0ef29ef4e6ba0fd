// The table of the outputs of a run.

#include "apps/observers/camera_pictures.hpp"
#include "apps/observers/checkpointing.hpp"
#include "apps/observers/filming.hpp"
#include "apps/observers/hash_log.hpp"
#include "apps/observers/profile.hpp"
#include "apps/observers/tables.hpp"
#include "apps/run/record_output.hpp"
#include "apps/run/run_output.hpp"

#include <algorithm>
#include <array>
#include <numeric>

namespace troupe::apps {
namespace {

/// A kind of output. make: creates the output. order: observers of outputs with lower numbers observe a tick
/// first. The checkpoint is last, because the other outputs must be flushed before it is saved, and because
/// the checkpoint that is written as a test then contains their data.
struct OutputRow {
  std::unique_ptr<RunOutput> (*make)();
  int order;
};

// All outputs, in the order of their options in --help.
constexpr std::array k_rows{
    OutputRow{checkpoint_output, 9}, OutputRow{hash_log_output, 2}, OutputRow{pictures_output, 7},
    OutputRow{profile_output, 3},    OutputRow{camera_output, 5},   OutputRow{record_output, 1},
    OutputRow{measures_output, 4},   OutputRow{events_output, 6},
};

}  // namespace

RunOutputs::RunOutputs() {
  for (const OutputRow& row : k_rows) all_.push_back(row.make());
}

RunOutputs::RunOutputs(const RunOutputs& other) {
  for (const auto& output : other.all_) all_.push_back(output->clone());
}

RunOutputs& RunOutputs::operator=(const RunOutputs& other) { return *this = RunOutputs(other); }

void RunOutputs::add_options(CLI::App& app, RunOptions& options) {
  for (const auto& output : all_) output->add_options(app, options);
}

std::vector<std::filesystem::path*> RunOutputs::names(RunOptions& options) {
  std::vector<std::filesystem::path*> names;
  for (const auto& output : all_) std::ranges::copy(output->names(options), std::back_inserter(names));
  return names;
}

std::vector<std::filesystem::path> RunOutputs::files(const RunOptions& options) const {
  std::vector<std::filesystem::path> files;
  for (const auto& output : all_) std::ranges::copy(output->files(options), std::back_inserter(files));
  return files;
}

void RunOutputs::take_names_from_world(RunOptions& options, const Simulation& simulation) const {
  for (const auto& output : all_) output->take_name_from_world(options, simulation);
}

std::vector<OpenOutput> RunOutputs::prepare(const RunOptions& options, Simulation& simulation,
                                            std::uint64_t end_tick) const {
  std::array<std::size_t, k_rows.size()> rows;
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  std::ranges::sort(rows, {}, [](std::size_t row) { return k_rows[row].order; });
  std::vector<OpenOutput> prepared;
  for (const std::size_t row : rows)
    if (OpenOutput open = all_[row]->prepare(options, simulation, end_tick))
      prepared.push_back(std::move(open));
  return prepared;
}

}  // namespace troupe::apps
