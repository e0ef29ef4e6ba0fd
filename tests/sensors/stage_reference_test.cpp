#include "troupe/registry.hpp"
#include "worldio/load.hpp"

#include "engine/world.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

namespace troupe::sensors {
namespace {

/// Readings that Stage 4.3 itself gave. Its rays walk cells of 0.02 m, so agreement is a share, not a
/// certainty.
struct Agreement {
  std::size_t readings = 0;
  std::size_t within_3_cm = 0;
  std::size_t within_5_cm = 0;
  std::size_t poses = 0;

  double share(std::size_t n) const { return static_cast<double>(n) / static_cast<double>(readings); }
};

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// A part's own name in a body's table: "a.ranger:0" of body "a" is "ranger:0".
const engine::BodyType::Sensor* find_sensor(const engine::BodyType& type, const std::string& name) {
  for (const engine::BodyType::Sensor& sensor : type.sensors)
    if (sensor.name == name) return &sensor;
  return nullptr;
}

void expect_agreement(const std::string& name, double least_within_3_cm, double least_within_5_cm) {
  const std::filesystem::path folder = std::filesystem::path(TROUPE_SOURCE_DIR) / "../shared/stage-reference";
  const std::filesystem::path file = folder / (name + ".world");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file << ": Stage's readings are not compared";

  std::string text = text_of(file);
  const std::size_t dump = text.find("dump");
  ASSERT_NE(dump, std::string::npos);
  text.replace(dump, 4, "script");
  Diagnostics diagnostics;
  const engine::Registry registry = make_registry();
  engine::WorldSpec spec = worldio::load_stage_world(file, text, registry, {}, diagnostics);
  diagnostics.throw_if_errors();
  engine::World world(std::move(spec), registry, {.threads = 2}, diagnostics);
  for (std::uint32_t r = 0; r < world.rows(); ++r) world.subscribe(world.body(Row(r)));

  std::map<long, std::vector<nlohmann::json>> records;  // by tick
  std::ifstream lines(folder / (name + ".jsonl"));
  for (std::string line; std::getline(lines, line);) {
    nlohmann::json record = nlohmann::json::parse(line);
    records[std::lround(record.at("t").get<double>() / world.tick_s())].push_back(std::move(record));
  }
  ASSERT_FALSE(records.empty());

  Agreement agreement;
  for (const auto& [tick, of_tick] : records) {
    while (world.tick() < static_cast<std::uint64_t>(tick)) world.step();
    for (const nlohmann::json& record : of_tick) {
      const std::string model = record.at("model");
      const std::size_t dot = model.find('.');
      const BodyId body = world.find(model.substr(0, dot));
      ASSERT_TRUE(body.valid()) << model;
      const Pose pose = world.pose(body);
      const auto& stage_pose = record.at("pose");
      EXPECT_NEAR(pose.x, stage_pose[0].get<double>(), 1e-9) << model << " at tick " << tick;
      EXPECT_NEAR(pose.y, stage_pose[1].get<double>(), 1e-9) << model << " at tick " << tick;
      EXPECT_NEAR(std::remainder(pose.heading - stage_pose[2].get<double>(), 2 * k_pi), 0, 1e-9)
          << model << " at tick " << tick;
      ++agreement.poses;

      const Row row = world.row(body);
      const engine::BodyType::Sensor* sensor = find_sensor(world.type(row), model.substr(dot + 1));
      ASSERT_NE(sensor, nullptr) << model;
      const std::span<const float> ranges = world.percepts(*sensor).cell<float>(world.slot(row), 0);
      std::size_t beam = 0;
      for (const nlohmann::json& transducer : record.at("sensors")) {
        for (const nlohmann::json& reading : transducer.at("ranges")) {
          ASSERT_LT(beam, ranges.size()) << model;
          const double apart = std::abs(ranges[beam++] - reading.get<double>());
          ++agreement.readings;
          agreement.within_3_cm += apart <= 0.03;
          agreement.within_5_cm += apart <= 0.05;
        }
      }
      EXPECT_EQ(beam, ranges.size()) << model;
    }
    if (testing::Test::HasFailure()) return;
  }
  std::printf("%s: %zu poses to 1e-9; of %zu readings %.2f %% agree within 0.03 m, %.2f %% within 0.05 m\n",
              name.c_str(), agreement.poses, agreement.readings, 100 * agreement.share(agreement.within_3_cm),
              100 * agreement.share(agreement.within_5_cm));
  EXPECT_GE(agreement.share(agreement.within_3_cm), least_within_3_cm);
  EXPECT_GE(agreement.share(agreement.within_5_cm), least_within_5_cm);
}

TEST(StageReference, CaveOfWavingRobotsAgrees) { expect_agreement("cave_wave", 0.85, 0.93); }
TEST(StageReference, HospitalOfRobotsInALineAgrees) { expect_agreement("hospital_line", 0.80, 0.88); }

}  // namespace
}  // namespace troupe::sensors
