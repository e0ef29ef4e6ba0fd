#include "apps/observers/checkpointing.hpp"

#include "apps/outputs.hpp"
#include "engine/ticks.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace troupe::apps {
namespace fs = std::filesystem;

Checkpointing::Checkpointing(fs::path file, std::optional<double> every_s, const Simulation& simulation,
                             std::vector<Observer*> others)
    : file_(std::move(file)),
      others_(std::move(others)),
      period_(every_s ? engine::period_ticks(*every_s, simulation.tick_s()) : 0),
      first_tick_(simulation.tick()) {
  const fs::path rehearsal = fs::path(file_).concat(".rehearsal");
  try {
    simulation.save(rehearsal);
  } catch (const std::runtime_error& fault) {
    const std::string_view reason = std::string_view(fault.what()).substr(rehearsal.string().size());
    throw OutputError(file_.string() + std::string(reason));
  }
  std::error_code ignored;
  fs::remove(rehearsal, ignored);
}

void Checkpointing::observe(const Simulation& simulation) {
  const std::uint64_t tick = simulation.tick();
  if (period_ == 0 || tick % period_ != 0 || tick == first_tick_) return;
  for (Observer* other : others_) other->before_save();
  save(simulation);
}

void Checkpointing::finish(const Simulation& simulation) {
  if (saved_ != simulation.tick()) save(simulation);
}

void Checkpointing::save(const Simulation& simulation) {
  simulation.save(file_);
  saved_ = simulation.tick();
}

void check_checkpoint(const fs::path& file, const fs::path& resumed_from, bool force) {
  std::error_code ignored;
  if (file.empty() || !fs::exists(file, ignored)) return;
  if (!fs::is_regular_file(file, ignored)) refuse_output(file, "it is no regular file");
  if (force) return;
  if (!resumed_from.empty() && fs::equivalent(file, resumed_from, ignored)) return;
  throw OutputError(
      fmt::format("{}: error: there is a file of this name already: --force replaces it", file.string()));
}

}  // namespace troupe::apps
