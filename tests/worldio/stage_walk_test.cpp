// A test that visits all properties of Stage's files, so that a new one cannot be forgotten.

#include "tests/support/scratch.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/registry.hpp"
#include "worldio/json/spec_check.hpp"
#include "worldio/load.hpp"
#include "worldio/stage/stage_properties.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <string_view>

namespace troupe::worldio {
namespace {

using engine::WorldSpec;

class StageWalk : public test::ScratchTest {
 protected:
  WorldSpec load(const std::string& text, Diagnostics& diagnostics) const {
    return load_stage_world(folder_ / "w.world", text, registry_, {}, diagnostics);
  }
  static std::string errors_of(const Diagnostics& diagnostics) {
    std::string all;
    for (const Finding& finding : diagnostics.findings())
      if (finding.severity == Severity::error) all += finding.message + "\n";
    return all;
  }

  engine::Registry registry_ = make_registry();
};

/// A world in which an entity of the type has this line.
std::string world_with(std::string_view type, const std::string& line) {
  if (type == "world") return line + "\nposition( )\n";
  if (type == "block")
    return fmt::format(
        "position( block( points 3 z [0 1] point[0] [0 0] point[1] [1 0] point[2] [0 1] {} ) )\n", line);
  if (type == "sensor") return fmt::format("position( ranger( alwayson 1 sensor( {} ) ) )\n", line);
  if (type == "window") return fmt::format("window( {} )\nposition( )\n", line);
  if (type == "model" || type == "position")
    return fmt::format("position( ctrl \"wander\" ranger( ) {} )\n", line);
  return fmt::format("position( {}( alwayson 1 {} ) )\n", type, line);
}

// A value that the reader of Stage's files accepts is within the limits of the engine.
TEST_F(StageWalk, WhatIsAcceptedIsWithinTheLimits) {
  const std::string numbers[] = {
      "9007199254740992", "-9007199254740992", "4000000000", "100001", "-100001", "0", "0.0000001"};
  std::size_t accepted = 0, refused = 0;
  for (const StageRow& row : stage_rows()) {
    if (row.support != StageSupport::honoured || row.name == "threads" || row.name == "include") continue;
    if (test::k_slow_build && row.type != "world" && row.type != "model") continue;
    std::string name(row.name);
    if (const std::size_t k = name.find("[k]"); k != name.npos) name.replace(k, 3, "[0]");
    for (const std::string& number : numbers) {
      const std::string tuples[] = {number, fmt::format("[{0} {0}]", number), fmt::format("[1 1 {}]", number),
                                    fmt::format("[{0} {0} {0}]", number),
                                    fmt::format("[{0} {0} {0} {0}]", number)};
      for (const std::string& value : tuples) {
        const std::string text = world_with(row.type, name + " " + value);
        Diagnostics found;
        const WorldSpec spec = load(text, found);
        if (found.has_errors()) {
          ++refused;
          continue;
        }
        ++accepted;
        Diagnostics checked;
        check_spec(spec, registry_, checked);
        EXPECT_EQ(errors_of(checked), "") << text;
      }
    }
  }
  EXPECT_GT(accepted, 100u);
  EXPECT_GT(refused, 100u);
}

}  // namespace
}  // namespace troupe::worldio
