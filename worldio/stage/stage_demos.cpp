#include "worldio/stage/stage_demos.hpp"

#include "engine/controller.hpp"
#include "engine/world_spec.hpp"

#include <fmt/format.h>

#include <vector>

namespace troupe::worldio {
namespace {

using engine::DeviceInfo;
using engine::FieldType;
using engine::PartSpec;
using engine::Record;
using engine::TypeSpec;
using engine::Unit;

constexpr std::string_view k_dynamic = "dynamic";
constexpr std::string_view k_lasernoise = "lasernoise";

constexpr double k_child_m = 0.1;

struct Dynamic {
  static constexpr bool needs_drive = false;
  static Dynamic make(const Record&) { return {}; }
  std::vector<std::size_t> choose(std::span<const DeviceInfo>, std::vector<bool>&) { return {}; }
  void operator()(const engine::Percept&, Random&, engine::Actions&) const {}
};

void add_children(const Record& params, std::uint64_t seed, const engine::Registry&, TypeSpec& type,
                  std::uint32_t part) {
  const std::int64_t count = params[0].integer();
  const double reach = params[1].number();
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
}

struct LaserNoise {
  static constexpr bool needs_drive = false;
  static LaserNoise make(const Record&) { return {}; }
  Result<std::vector<std::size_t>> choose(std::span<const DeviceInfo> devices, std::vector<bool>&) {
    for (std::size_t d = 0; d < devices.size(); ++d)
      if (devices[d].kind == "ranger") return std::vector{d};  // not claimed: it is for others to read
    return Error{"needs a ranger"};
  }
  void operator()(const engine::Percept&, Random&, engine::Actions&) const {}
};

void add_noise(const Record& params, std::uint64_t, const engine::Registry& registry, TypeSpec& type,
               std::uint32_t part) {
  const engine::DeviceKind* ranger = registry.device("ranger");
  const int transducers = ranger ? ranger->params.find("transducers") : -1;
  if (transducers < 0) return;
  const auto list = static_cast<std::size_t>(transducers);
  const int relative = ranger->params.fields[list].record->find("noise_relative");
  for (engine::DeviceSpec& device : type.devices) {
    if (device.kind != "ranger" || device.part != part || relative < 0) continue;
    std::vector<Record> records = device.params[list].records();
    if (!records.empty()) records.front()[static_cast<std::size_t>(relative)] = params[0];
    device.params[list] = std::move(records);
    return;
  }
}

}  // namespace

engine::ControllerKind dynamic_controller() {
  return engine::make_controller_kind<Dynamic>(
      k_dynamic, "add small boxes to the model when the world is read",
      {{{.name = "count",
         .type = FieldType::integer,
         .fallback = 100,
         .min = 0,
         .max = 10000,
         .text = "children to add"},
        {.name = "reach",
         .unit = Unit::meters,
         .fallback = 1.0,
         .min = 0,
         .max = 1000,
         .text = "how far from the model's origin, in x and in y"}}});
}

engine::ControllerKind lasernoise_controller() {
  return engine::make_controller_kind<LaserNoise>(
      k_lasernoise, "give the model's ranger a normal error in proportion",
      {{{.name = "share",
         .fallback = 0.05,
         .min = 0,
         .max = 1,
         .text = "standard deviation of a reading's error, as a share of it"}}});
}

StageAddition stage_addition(std::string_view controller) {
  if (controller == k_dynamic) return add_children;
  if (controller == k_lasernoise) return add_noise;
  return nullptr;
}

}  // namespace troupe::worldio
