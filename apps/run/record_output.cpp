#include "apps/run/record_output.hpp"

#include "apps/observers/recorder.hpp"
#include "apps/options.hpp"
#include "apps/run/run_options.hpp"

#include <string>

namespace troupe::apps {
namespace {

class RecordOutput : public ClonedOutput<RecordOutput> {
 public:
  void add_options(CLI::App& app, RunOptions& options) override {
    add_value(app, "--record", "FILE.h5", "Record the state into an HDF5 file (docs/recordings.md)",
              [&options](const std::string& text) { options.record = hdf5_name("--record", text); });
    add_value(app, "--record-every", "S", "Simulated seconds between frames (default: 0.1)",
              [&options](const std::string& text) {
                options.recording.every_s = positive_seconds("--record-every", text, "a time");
              });
    add_value(app, "--record-fields", "A,B,...",
              "Recorded fields: pose, velocity, ranges, ... (docs/recordings.md), or all (default: pose)",
              [&options](const std::string& text) {
                options.recording.fields =
                    names_in("--record-fields", text, "a list of names, as in --record-fields pose,ranges");
              });
  }
  std::vector<std::filesystem::path*> names(RunOptions& options) override { return {&options.record}; }
  std::vector<std::filesystem::path> files(const RunOptions& options) const override {
    return {options.record};
  }
  void take_name_from_world(RunOptions& options, const Simulation& simulation) const override {
    options.record = recording_file(options, simulation);
  }
  OpenOutput prepare(const RunOptions& options, Simulation& simulation, std::uint64_t) const override {
    return prepare_recorder(options, simulation);
  }
};

}  // namespace

std::unique_ptr<RunOutput> record_output() { return std::make_unique<RecordOutput>(); }

}  // namespace troupe::apps
