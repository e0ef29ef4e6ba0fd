#include "perf/paper_watch.hpp"

#include "engine/observing/measures.hpp"
#include "worldio/results/recording_writer.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

namespace troupe::perf {
namespace {

class HashWatcher : public Watcher {
 public:
  explicit HashWatcher(engine::World& world) : world_(world) {}
  void look() override { last_ = world_.hashes(); }

 private:
  engine::World& world_;
  engine::Hashes last_;
};

/// Records into a temporary file, which the destructor removes.
class RecordingWatcher : public Watcher {
 public:
  explicit RecordingWatcher(engine::World& world)
      : file_(std::filesystem::temp_directory_path() / fmt::format("perf_paper.{}.h5", getpid())),
        world_(world),
        writer_(file_, world, worldio::recorded_components(world, std::vector<std::string>{"pose"}), {},
                /*in_background=*/true) {}
  ~RecordingWatcher() override {
    std::error_code ignored;
    std::filesystem::remove(file_, ignored);
  }
  void look() override {
    if (writer_.due(world_.tick())) writer_.record(world_, world_.hashes().state);
  }
  void finish() override { writer_.close(); }

 private:
  std::filesystem::path file_;
  engine::World& world_;
  worldio::RecordingWriter writer_;
};

class MeasureWatcher : public Watcher {
 public:
  MeasureWatcher(engine::World& world, const engine::Registry& registry)
      : set_(world, registry, specs(registry), diagnostics_) {
    diagnostics_.throw_if_errors();
  }
  void look() override {
    set_.see();
    last_ = set_.values();
  }

 private:
  static std::vector<engine::MeasureSpec> specs(const engine::Registry& registry) {
    std::vector<engine::MeasureSpec> specs;
    for (const engine::MeasureKind& kind : registry.measures)
      if (kind.is_usual())
        specs.push_back({.kind = std::string(kind.name), .params = kind.params.defaults()});
    return specs;
  }

  Diagnostics diagnostics_;
  engine::MeasureSet set_;
  std::vector<double> last_;
};

}  // namespace

std::string_view watch_name(Watch watch) {
  switch (watch) {
    case Watch::hashes: return "hashes";
    case Watch::recording: return "recording";
    case Watch::measures: return "measures";
    case Watch::nothing: break;
  }
  return "nothing";
}

std::unique_ptr<Watcher> make_watcher(Watch watch, engine::World& world, const engine::Registry& registry) {
  switch (watch) {
    case Watch::hashes: return std::make_unique<HashWatcher>(world);
    case Watch::recording: return std::make_unique<RecordingWatcher>(world);
    case Watch::measures: return std::make_unique<MeasureWatcher>(world, registry);
    case Watch::nothing: break;
  }
  return nullptr;
}

}  // namespace troupe::perf
