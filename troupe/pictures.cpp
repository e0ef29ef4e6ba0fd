#include "troupe/pictures.hpp"

#include "base/diagnostics.hpp"
#include "base/hash.hpp"
#include "engine/watch_spec.hpp"
#include "engine/world.hpp"
#include "troupe/frame_data.hpp"
#include "worldio/png.hpp"

#ifdef TROUPE_HAS_RENDER
#include "render/draw.hpp"
#endif

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace troupe {
namespace {

constexpr std::string_view k_follow = "follow:";

constexpr std::array<PictureLayer, 17> k_layers = {{
    {"grid", true, "lines on the floor"},
    {"shadows", true, "of what stands, on the floor"},
    {"headings", true, "a mark at the front of each robot"},
    {"stalls", true, "a red outline around who may not move"},
    {"scale", true, "a bar of a round length, or how far apart the grid's lines are"},
    {"clock", true, "the simulated time"},
    {"legend", true, "of --color-by"},
    {"scans", false, "what rangers see, filled and transparent"},
    {"beams", false, "the same, a line a beam"},
    {"sights", false, "lines from fiducial finders to what they have found"},
    {"trails", false, "where robots were in the last 20 s, the older the paler"},
    {"names", false, "of robots"},
    {"energy", false, "bars of what power packs hold"},
    {"footprints", false, "outlines of bodies on the floor"},
    {"density", false, "how many robots there are in squares of the floor"},
    {"tiles", false, "how many there are in each tile, the unit of parallel work"},
    {"cells", false, "cells of the index in which robots are"},
}};

/// A layer and whether it is to be shown; false where a word is none.
struct LayerSwitch {
  std::string_view name;
  bool on = true;
};

std::vector<LayerSwitch> switches_of(std::string_view list) {
  std::vector<LayerSwitch> switches;
  for (std::size_t start = 0; !list.empty() && start <= list.size();) {
    const std::size_t end = std::min(list.find(',', start), list.size());
    std::string_view word = list.substr(start, end - start);
    const bool off = word.starts_with('-');
    if (off || word.starts_with('+')) word.remove_prefix(1);
    switches.push_back({word, !off});
    start = end + 1;
  }
  return switches;
}

}  // namespace

std::span<const PictureLayer> picture_layers() { return k_layers; }

std::string layers_fault(const std::string& layers) {
  for (const LayerSwitch& layer : switches_of(layers)) {
    if (std::ranges::find(k_layers, layer.name, &PictureLayer::name) != k_layers.end()) continue;
    std::vector<std::string_view> known;
    for (const PictureLayer& one : k_layers) known.push_back(one.name);
    return unknown_name("layer", std::string(layer.name), known);
  }
  return {};
}

std::string camera_fault(const std::string& camera) {
  const std::vector<std::string_view> known = {"follow:NAME", "perspective", "top", "window"};
  const bool follows = camera.starts_with(k_follow) && camera.size() > k_follow.size();
  if (follows || std::ranges::find(known.begin() + 1, known.end(), camera) != known.end()) return {};
  return unknown_name("camera", camera, known);
}

#ifdef TROUPE_HAS_RENDER

namespace {

constexpr double k_default_pitch = 40 * k_pi / 180;
constexpr double k_follow_widths = 24;  // of the model that is followed, across the picture
constexpr double k_stage_fov = 60 * k_pi / 180;

bool* switch_of(render::Layers& layers, std::string_view name) {
  const std::array<std::pair<std::string_view, bool*>, 17> all = {{{"grid", &layers.grid},
                                                                   {"shadows", &layers.shadows},
                                                                   {"headings", &layers.headings},
                                                                   {"stalls", &layers.stalls},
                                                                   {"scale", &layers.scale},
                                                                   {"clock", &layers.clock},
                                                                   {"legend", &layers.legend},
                                                                   {"scans", &layers.scans},
                                                                   {"beams", &layers.beams},
                                                                   {"sights", &layers.sights},
                                                                   {"trails", &layers.trails},
                                                                   {"names", &layers.names},
                                                                   {"energy", &layers.energy},
                                                                   {"footprints", &layers.footprints},
                                                                   {"density", &layers.density},
                                                                   {"tiles", &layers.tiles},
                                                                   {"cells", &layers.cells}}};
  const auto found = std::ranges::find(all, name, &std::pair<std::string_view, bool*>::first);
  return found == all.end() ? nullptr : found->second;
}

/// What a world's window says, by the names of its fields.
class Window {
 public:
  explicit Window(const engine::Record& record) : record_(record) {}
  bool on(std::string_view name) const { return value(name).boolean(); }
  const std::vector<double>& numbers(std::string_view name) const { return value(name).numbers(); }
  const engine::Value& value(std::string_view name) const {
    return engine::get(engine::window_fields(), record_, name);
  }

 private:
  const engine::Record& record_;
};

/// Its cameras turn the world where a map is tilted, and themselves in perspective: a map's yaw is the other
/// way round.
void look_through(const Window& window, render::View& view) {
  const auto& size = window.numbers("size_px");
  if (size[0] >= 1 && size[1] >= 1) {
    view.width = static_cast<int>(size[0]);
    view.height = static_cast<int>(size[1]);
  }
  render::Camera& camera = view.camera;
  camera.perspective = window.on("perspective");
  const auto& angle = window.numbers(camera.perspective ? "camera_angle" : "rotate");
  camera.pitch = angle[0];
  camera.yaw = camera.perspective ? angle[1] : -angle[1];
  if (camera.perspective) {
    const auto& eye = window.numbers("camera");
    camera.eye = Eigen::Vector3d(eye[0], eye[1], eye[2]);
    camera.fov = k_stage_fov;
  } else {
    const auto& center = window.numbers("center");
    camera.center = Eigen::Vector3d(center[0], center[1], 0);
    camera.across_m = view.width / window.value("scale_px_per_m").number();
  }
  view.layers.grid = window.on("show_grid");
  view.layers.clock = window.on("show_clock");
  view.layers.footprints = window.on("show_footprints");
  view.layers.cells = window.on("show_occupancy");
  view.layers.scans = window.on("show_data") && window.on("show_ranger_ranges");
  view.layers.sights = window.on("show_data") && window.on("show_fiducial");
}

}  // namespace

struct Pictures::ShotData {
  engine::Frame frame;
  std::optional<Eigen::Vector3d> center;  // of what is followed
  std::vector<std::pair<std::string, std::string>> text;
};

struct Pictures::Impl {
  PictureOptions options;
  render::View view;
  std::string world;                    // its file, for people
  std::optional<std::uint32_t> follow;  // BodyId
  double follow_across = 0;
  std::optional<ChosenValue> color_by;
  Trails trails;
  std::optional<render::Painter> painter;
  engine::FrameScene scene;  // the painter's own copy has the same rangers

  [[noreturn]] void refuse(const std::string& message) const {
    throw InputError(fmt::format("{}: error: {}", world, message));
  }

  void find_followed(const engine::World& of, const std::string& name) {
    const BodyId body = of.find(name);
    if (!body.valid()) refuse(fmt::format("there is no model \"{}\" to follow", name));
    follow = body.value;
    follow_across =
        k_follow_widths * std::max(of.types()[of.spec().bodies[body.index()].type.index()].radius, 0.05);
  }

  void set_camera(const engine::World& of) {
    const std::string& camera = options.camera;
    if (const std::string fault = camera_fault(camera); !fault.empty()) refuse(fault);
    if (camera == "window") {
      if (!of.spec().window) refuse("the world has no window; other cameras: follow:NAME, perspective, top");
      const Window window(*of.spec().window);
      look_through(window, view);
      if (const std::string& name = window.value("follow").text(); !name.empty()) {
        find_followed(of, name);
        view.camera.eye.reset();
      }
    } else if (camera != "top") {
      view.camera.perspective = true;
      view.camera.pitch = k_default_pitch;
      if (camera.starts_with(k_follow)) {
        find_followed(of, camera.substr(k_follow.size()));
        view.camera.across_m = follow_across;
      }
    }
    if (options.width > 0) view.width = options.width;
    if (options.height > 0) view.height = options.height;
    if (options.angle_rad) {
      view.camera.pitch = (*options.angle_rad)[0];
      view.camera.yaw = (*options.angle_rad)[1];
    }
    if (options.center_m) {
      view.camera.center = Eigen::Vector3d((*options.center_m)[0], (*options.center_m)[1], 0);
      view.camera.eye.reset();
    }
    if (options.across_m) {
      view.camera.across_m = options.across_m;
      view.camera.eye.reset();
    }
  }

  /// Where what is followed stands.
  std::optional<Eigen::Vector3d> followed(const engine::World& of) const {
    if (!follow) return std::nullopt;
    const Pose pose = of.pose(BodyId(std::size_t{*follow}));
    return Eigen::Vector3d(pose.x, pose.y, pose.z);
  }

  std::vector<std::uint8_t> draw(const ShotData& shot) {
    if (!painter) painter.emplace(scene);
    render::View own = view;
    if (shot.center) own.camera.center = shot.center;
    return painter->draw(shot.frame, own).rgba;
  }
};

Pictures::Pictures(const Simulation& simulation, PictureOptions options) : impl_(std::make_unique<Impl>()) {
  const engine::World& world = simulation.world();
  impl_->options = std::move(options);
  const PictureOptions& wanted = impl_->options;
  impl_->world = simulation.effective_options().front().second;
  impl_->set_camera(world);
  if (const std::string fault = layers_fault(wanted.layers); !fault.empty()) impl_->refuse(fault);
  for (const LayerSwitch& layer : switches_of(wanted.layers))
    *switch_of(impl_->view.layers, layer.name) = layer.on;
  if (!wanted.color_by.empty()) {
    std::string fault;
    impl_->color_by = find_value(world, wanted.color_by, fault);
    if (!impl_->color_by) impl_->refuse(fault);
  }
  if (wanted.color_range) impl_->view.values = std::pair((*wanted.color_range)[0], (*wanted.color_range)[1]);
  impl_->scene = world.frame_scene();
  impl_->scene.rangers = frame_rangers(world);
}

Pictures::~Pictures() = default;
Pictures::Pictures(Pictures&&) noexcept = default;
Pictures& Pictures::operator=(Pictures&&) noexcept = default;

int Pictures::width() const { return impl_->view.width; }
int Pictures::height() const { return impl_->view.height; }

void Pictures::see(const Simulation& simulation) {
  if (impl_->view.layers.trails) impl_->trails.see(simulation.world());
}

Pictures::Shot Pictures::take(const Simulation& simulation) const {
  return take(simulation, {simulation.time_s(), simulation.state_hash()});
}

Pictures::Shot Pictures::take(const Simulation& simulation, const Told& told) const {
  const engine::World& world = simulation.world();
  const render::Layers& shown = impl_->view.layers;
  auto shot = std::make_shared<ShotData>();
  shot->frame = world.frame();
  shot->frame.time_s = told.time_s;
  shot->center = impl_->followed(world);
  if (shown.scans || shown.beams) add_scans(world, impl_->scene, shot->frame);
  if (shown.sights) add_sights(world, shot->frame);
  if (shown.names) add_names(world, shot->frame);
  if (shown.energy) add_charges(world, shot->frame);
  if (shown.trails) impl_->trails.add_to(shot->frame);
  if (impl_->color_by) {
    shot->frame.values = values_of(world, *impl_->color_by, shot->frame);
    shot->frame.value_name = impl_->color_by->text;
  }
  shot->text = {{"Software", version_line()},
                {"world", impl_->world},
                {"time_s", fmt::format("{}", told.time_s)},
                {"seed", fmt::format("{}", world.spec().seed)},
                {"state_hash", hex(told.state_hash)}};
  return shot;
}

std::string_view Pictures::needs() const {
  const render::Layers& shown = impl_->view.layers;
  if (impl_->color_by) return "values to colour by";
  if (shown.scans || shown.beams) return "scans";
  if (shown.sights) return "sights";
  if (shown.energy) return "energy";
  return shown.trails ? "trails" : "";
}

Pictures::Shot Pictures::between(const Shot& earlier, const Shot& later, double share) {
  auto shot = std::make_shared<ShotData>(*earlier);
  const auto mix = [share](double a, double b) { return a + share * (b - a); };
  engine::Frame& frame = shot->frame;
  const engine::Frame& next = later->frame;
  frame.time_s = mix(frame.time_s, next.time_s);
  for (std::size_t i = 0; i < std::min(frame.mobile.size(), next.mobile.size()); ++i) {
    if (frame.mobile[i].id != next.mobile[i].id) continue;
    Pose& pose = frame.mobile[i].pose_world_body;
    const Pose& to = next.mobile[i].pose_world_body;
    pose = {mix(pose.x, to.x), mix(pose.y, to.y), mix(pose.z, to.z),
            pose.heading + share * wrap_angle(to.heading - pose.heading)};
  }
  if (shot->center && later->center)
    shot->center = Eigen::Vector3d(*shot->center + share * (*later->center - *shot->center));
  std::erase_if(shot->text, [](const auto& entry) { return entry.first == "state_hash"; });  // of no state
  for (auto& [key, value] : shot->text)
    if (key == "time_s") value = fmt::format("{}", frame.time_s);
  return shot;
}

std::vector<std::uint8_t> Pictures::draw(const Shot& shot) { return impl_->draw(*shot); }

void Pictures::write(const Shot& shot, const std::filesystem::path& png) {
  worldio::write_png(png, {width(), height(), impl_->draw(*shot)}, shot->text);
}

#else

struct Pictures::ShotData {};
struct Pictures::Impl {};

namespace {
[[noreturn]] void refuse_to_draw() {
  throw std::runtime_error("this build draws no pictures: it was configured with TROUPE_RENDER=OFF");
}
}  // namespace

Pictures::Pictures(const Simulation&, PictureOptions) { refuse_to_draw(); }
Pictures::~Pictures() = default;
Pictures::Pictures(Pictures&&) noexcept = default;
Pictures& Pictures::operator=(Pictures&&) noexcept = default;
int Pictures::width() const { return 0; }
int Pictures::height() const { return 0; }
void Pictures::see(const Simulation&) {}
Pictures::Shot Pictures::take(const Simulation&) const { refuse_to_draw(); }
Pictures::Shot Pictures::take(const Simulation&, const Told&) const { refuse_to_draw(); }
std::string_view Pictures::needs() const { return {}; }
Pictures::Shot Pictures::between(const Shot&, const Shot&, double) { refuse_to_draw(); }
std::vector<std::uint8_t> Pictures::draw(const Shot&) { refuse_to_draw(); }
void Pictures::write(const Shot&, const std::filesystem::path&) { refuse_to_draw(); }

#endif

}  // namespace troupe
