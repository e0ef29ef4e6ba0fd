#pragma once

#include "engine/kinds/registry.hpp"
#include "engine/spec/world_spec.hpp"
#include "models/controllers/depots.hpp"
#include "models/controllers/expand.hpp"
#include "models/controllers/script.hpp"
#include "models/controllers/wander.hpp"
#include "models/devices/flags.hpp"
#include "models/devices/power.hpp"
#include "models/drives/drives.hpp"
#include "models/drives/wheels.hpp"
#include "models/model_kinds.hpp"
#include "sensors/blobfinder.hpp"
#include "sensors/bumper.hpp"
#include "sensors/camera.hpp"
#include "sensors/fiducial.hpp"
#include "sensors/ranger.hpp"
#include "tests/support/scratch.hpp"
#include "worldio/load.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::worldio {

inline const engine::Registry& test_registry() {
  static const engine::Registry registry = [] {
    engine::Registry r;
    r.models = models::model_kinds();
    r.devices = {sensors::ranger_kind(),       sensors::fiducial_kind(), sensors::blobfinder_kind(),
                 sensors::bumper_kind(),       sensors::camera_kind(),   models::power_pack_kind(),
                 models::power_contact_kind(), models::flags_kind(),     models::wheels_kind()};
    r.drives = {models::diff_drive(), models::omni_drive(), models::car_drive()};
    r.controllers = {models::expand_controller(), models::wander_controller(), models::script_controller(),
                     models::source_controller()};
    r.presets = {models::expand_pioneer_preset(), models::expand_swarm_preset()};
    return r;
  }();
  return registry;
}

/// A test that loads worlds in Stage's syntax. The errors and warnings of each load are collected. A test
/// must fetch them with messages(): at the end of the test, messages that were not fetched make the test
/// fail.
class StageTest : public test::ScratchTest {
 protected:
  void TearDown() override { EXPECT_THAT(messages(), testing::IsEmpty()); }

  /// Loads the world `text` as if it were the content of the file `w.world` in the temporary folder.
  engine::WorldSpec load(std::string_view text, const LoadOptions& options = {}) {
    return read(folder_ / "w.world", std::string(text), options, test_registry());
  }

  engine::WorldSpec read(const std::filesystem::path& file, const std::string& text,
                         const LoadOptions& options, const engine::Registry& registry) {
    Diagnostics diagnostics;
    engine::WorldSpec spec = load_stage_world(file, text, registry, options, diagnostics);
    keep(diagnostics);
    return spec;
  }

  void keep(const Diagnostics& diagnostics) {
    // Warnings carry their counts; errors follow them.
    for (const std::string& line : diagnostics.warnings()) messages_.push_back(shortened(line));
    for (const Finding& finding : diagnostics.findings())
      if (finding.severity == Severity::error) messages_.push_back(shortened(diagnostics.text(finding)));
  }

  /// Returns the errors and warnings that were reported since the last call. Paths are relative to the
  /// temporary folder.
  std::vector<std::string> messages() { return std::exchange(messages_, {}); }

  const std::filesystem::path& folder() const { return folder_; }
  void shorten(const std::filesystem::path& prefix) { prefix_ = prefix.string() + "/"; }

 private:
  std::string shortened(std::string line) const {
    for (const std::string& prefix : {folder_.string() + "/", prefix_})
      for (std::size_t at; !prefix.empty() && (at = line.find(prefix)) != std::string::npos;)
        line.erase(at, prefix.size());
    return line;
  }

  std::string prefix_;
  std::vector<std::string> messages_;
};

inline const engine::TypeSpec& type_of(const engine::WorldSpec& spec, std::size_t body) {
  return spec.type(BodyId(body));
}

inline std::string name_of(const engine::WorldSpec& spec, std::size_t body) {
  return spec.name(BodyId(body));
}

/// Returns the body that has `name` as a further name, in addition to its own (WorldSpec::aliases). Not valid
/// if there is no such body.
inline BodyId alias(const engine::WorldSpec& spec, std::string_view name) {
  for (const engine::NamedBody& alias : spec.aliases)
    if (spec.names.text(alias.name) == name) return alias.body;
  return {};
}

inline std::vector<std::string> body_names(const engine::WorldSpec& spec) {
  std::vector<std::string> names;
  for (std::size_t b = 0; b < spec.bodies.size(); ++b) names.push_back(spec.name(BodyId(b)));
  return names;
}

inline std::vector<std::string> part_names(const engine::TypeSpec& type) {
  std::vector<std::string> names;
  for (const engine::PartSpec& part : type.parts) names.push_back(part.name);
  return names;
}

}  // namespace troupe::worldio
