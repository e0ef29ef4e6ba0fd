#include "worldio/stage/stage_demos.hpp"

#include "engine/kinds/controller.hpp"
#include "engine/kinds/sensor_params.hpp"
#include "engine/spec/world_spec.hpp"

#include <fmt/format.h>

#include <vector>

namespace troupe::worldio {
namespace {

using engine::DeviceInfo;
using engine::PartSpec;
using engine::Record;
using engine::TypeSpec;

constexpr std::string_view k_dynamic = "dynamic";
constexpr std::string_view k_lasernoise = "lasernoise";

constexpr double k_child_m = 0.1;

struct Dynamic {
  struct Params {
    std::int64_t count = 100;
    double reach = 1;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      using enum engine::Unit;
      d.member<&Params::count>("count", within(0, 10000), "number of boxes to add");
      d.member<&Params::reach>("reach", meters, within(0, 1000),
                               "largest distance of a box from the origin of the model, along x and along y");
    }
  };

  static constexpr bool needs_drive = false;
  static Dynamic make(const Params&) { return {}; }
  std::vector<std::size_t> choose(std::span<const DeviceInfo>, std::vector<bool>&) { return {}; }
  void operator()(const engine::Percept&, Random&, engine::Actions&) const {}
};

Result<> add_children(const Record& params, std::uint64_t seed, const engine::Registry&, TypeSpec& type,
                      std::uint32_t part) {
  const auto [count, reach] = engine::from_record<Dynamic::Params>(params);
  const PartSpec parent = type.parts[part];
  Random random(seed, stream_id(k_dynamic, parent.name), 0, 0);
  for (std::int64_t i = 0; i < count; ++i) {
    const std::string last = fmt::format("dynamic:{}", i);
    PartSpec child{.name = parent.name.empty() ? last : fmt::format("{}.{}", parent.name, last),
                   .kind = "model",
                   .parent = part,
                   .joint = parent.joint,
                   .size = {k_child_m, k_child_m, k_child_m},
                   .returns = parent.returns,
                   .where = parent.where};
    Pose pose_parent_child{0, 0, parent.size.z(), 0};
    pose_parent_child.x = random.uniform(-reach, reach);
    pose_parent_child.y = random.uniform(-reach, reach);
    pose_parent_child.heading = random.uniform(-k_pi, k_pi);
    child.pose_body_part = compose(parent.pose_body_part, pose_parent_child);
    constexpr double h = k_child_m / 2;
    child.solids = {
        placed(Solid{{Ring{{-h, -h}, {h, -h}, {h, h}, {-h, h}}}, {0, k_child_m}}, child.pose_body_part)};
    type.parts.push_back(std::move(child));
  }
  return {};
}

struct LaserNoise {
  struct Params {
    double share = 0.05;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      d.member<&Params::share>("share", within(0, 1),
                               "standard deviation of a reading's error, as a fraction of the reading");
    }
  };

  static constexpr bool needs_drive = false;
  static LaserNoise make(const Params&) { return {}; }
  Result<std::vector<std::size_t>> choose(std::span<const DeviceInfo> devices, std::vector<bool>&) {
    for (std::size_t d = 0; d < devices.size(); ++d)
      if (devices[d].kind == "ranger") return std::vector{d};  // not claimed: other controllers may read it
    return Error{"needs a ranger"};
  }
  void operator()(const engine::Percept&, Random&, engine::Actions&) const {}
};

Result<> add_noise(const Record& params, std::uint64_t, const engine::Registry&, TypeSpec& type,
                   std::uint32_t part) {
  for (engine::DeviceSpec& device : type.devices) {
    if (device.kind != "ranger" || device.part != part) continue;
    auto ranger = engine::from_record<engine::RangerParams>(device.params);
    if (ranger.transducers.empty()) break;
    ranger.transducers.front().noise_relative = engine::from_record<LaserNoise::Params>(params).share;
    device.params = engine::to_record(ranger);
    return {};
  }
  return Error{"must be in a ranger with a sensor( ... )"};
}

}  // namespace

engine::ControllerKind dynamic_controller() {
  return engine::make_controller_kind<Dynamic>(k_dynamic,
                                               "add boxes with edges of 0.1 m to the model when a `.world` "
                                               "file is read; in a JSON world, the controller adds none");
}

engine::ControllerKind lasernoise_controller() {
  return engine::make_controller_kind<LaserNoise>(
      k_lasernoise,
      "when a `.world` file is read: give the first transducer of the model's ranger a normally distributed "
      "error, with a standard deviation proportional to the reading; in a JSON world, set `noise_relative` "
      "of the transducer instead");
}

StageAddition stage_addition(std::string_view controller) {
  if (controller == k_dynamic) return add_children;
  if (controller == k_lasernoise) return add_noise;
  return nullptr;
}

}  // namespace troupe::worldio
