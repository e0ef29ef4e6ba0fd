#include "troupe/simulation_source.hpp"

#include "engine/observing/frame.hpp"
#include "engine/world/world.hpp"
#include "troupe/frame_data.hpp"
#include "troupe/simulation.hpp"

namespace troupe {

using engine::Frame;
using engine::FrameScene;

std::string SimulationSource::file() const { return simulation_.effective_options().front().second; }
std::uint64_t SimulationSource::seed() const { return simulation_.world().spec().seed; }
double SimulationSource::tick_s() const { return simulation_.tick_s(); }

const engine::Record* SimulationSource::window() const {
  const auto& window = simulation_.world().spec().window;
  return window ? &*window : nullptr;
}

FrameScene SimulationSource::scene() const {
  FrameScene scene = engine::make_scene(simulation_.world());
  scene.rangers = frame_rangers(simulation_.world());
  return scene;
}

std::optional<std::uint32_t> SimulationSource::find_body(std::string_view name) const {
  const BodyId body = simulation_.world().state().names.find(name);
  return body.valid() ? std::optional(body.value) : std::nullopt;
}

Result<ChosenValue> SimulationSource::find_value(const std::string& name) const {
  return troupe::find_value(simulation_.world(), name);
}

Result<> SimulationSource::check(const FrameWishes&) const { return {}; }
double SimulationSource::time_s() const { return simulation_.time_s(); }
std::uint64_t SimulationSource::state_hash() const { return simulation_.state_hash(); }

Frame SimulationSource::frame(const FrameWishes& wishes) const {
  const engine::World& world = simulation_.world();
  Frame frame = engine::make_frame(world);
  if (wishes.scans) add_scans(world, frame);
  if (wishes.sights) add_layer(world, engine::FrameLayer::sights, frame);
  if (wishes.blobs) add_layer(world, engine::FrameLayer::blobs, frame);
  if (wishes.grips) add_layer(world, engine::FrameLayer::grips, frame);
  if (wishes.links) add_links(world, frame);
  if (wishes.charges) add_charges(world, frame);
  if (wishes.names) add_names(world, frame);
  if (wishes.value) {
    frame.values = values_of(world, *wishes.value, frame);
    frame.value_name = wishes.value->text;
  }
  return frame;
}

}  // namespace troupe
