// Writes the worlds among the seeds of the fuzz targets as JSON, reads them again, and checks that they are
// still the same worlds.

#include "engine/world/world.hpp"
#include "tests/fuzz/targets.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/registry.hpp"
#include "worldio/json/json_text.hpp"
#include "worldio/json/json_world.hpp"
#include "worldio/load.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace troupe::fuzz::convert_test {
namespace {

namespace fs = std::filesystem;

const fs::path k_folder = test::source_dir() / "tests/fuzz";

std::vector<fs::path> seeds(const std::string& kind) {
  std::vector<fs::path> files;
  for (const char* folder : {"corpus", "findings"})
    if (fs::exists(k_folder / folder / kind))
      for (const auto& entry : fs::directory_iterator(k_folder / folder / kind))
        files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

std::string content(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The state hashes of ticks 0 and 20 (2 in slow builds). Empty if the world cannot be built or a step fails,
/// for example because a controller lacks its sensors.
std::vector<std::uint64_t> states(const engine::WorldSpec& spec, const engine::Registry& registry) {
  Diagnostics diagnostics(spec.files);
  try {
    engine::World world(spec, registry, {.threads = 1}, diagnostics);
    std::vector<std::uint64_t> found{world.hashes().state};
    for (int tick = 0; tick < (test::k_slow_build ? 2 : 20); ++tick) world.step();
    found.push_back(world.hashes().state);
    return found;
  } catch (const InputError&) {
    return {};
  } catch (const engine::StepError&) {
    return {};
  }
}

TEST(ConvertedSeeds, AreTheSameWorlds) {
  const engine::Registry registry = make_registry();
  worldio::LoadOptions options;
  options.threads = 1;
  options.most_bodies = 200;
  int converted = 0;
  for (const std::string kind : {"stage", "json"})
    for (const fs::path& seed : seeds(kind)) {
      SCOPED_TRACE(seed.string());
      const fs::path beside =
          k_folder / "files" / ("fuzz." + (kind == "stage" ? std::string("world") : kind));
      const std::string text = content(seed);
      Diagnostics diagnostics;
      engine::WorldSpec spec;
      try {
        spec = kind == "stage" ? worldio::load_stage_world(beside, text, registry, options, diagnostics)
                               : worldio::load_json_world(beside, text, registry, options, diagnostics);
      } catch (const InputError&) {
        continue;
      }
      if (diagnostics.has_errors() || spec.bodies.size() > 200) continue;
      const fs::path out = k_folder / "files/converted.json";
      const auto document = worldio::write_json_world(spec, out, registry, diagnostics);
      std::string faults;
      for (const Finding& finding : diagnostics.findings())
        if (finding.severity == Severity::error) faults += diagnostics.text(finding) + '\n';
      // Texts in Stage's files may have any encoding, but JSON requires UTF-8.
      if (faults.find("is not UTF-8") != std::string::npos) continue;
      ASSERT_TRUE(document) << faults;
      ++converted;
      Diagnostics again;
      engine::WorldSpec back =
          worldio::load_json_world(out, worldio::json_text(*document), registry, {}, again);
      ASSERT_FALSE(again.has_errors()) << again.text(again.findings().front());
      spec.ranging = back.ranging = engine::RangingEngine::exact;  // the grid may take 2 GiB, by design
      EXPECT_EQ(states(back, registry), states(spec, registry));
    }
  EXPECT_GE(converted, 4);
}

}  // namespace
}  // namespace troupe::fuzz::convert_test
