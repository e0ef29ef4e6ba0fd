#include "troupe/pictures.hpp"

#include "base/diagnostics.hpp"
#include "base/hash.hpp"
#include "base/split.hpp"
#include "render/draw.hpp"
#include "troupe/frame_history.hpp"
#include "troupe/picture_source.hpp"
#include "troupe/simulation_source.hpp"
#include "worldio/files.hpp"
#include "worldio/images/png.hpp"
#include "worldio/whole_file.hpp"

#ifdef TROUPE_HAS_RENDER
#include "worldio/window_fields.hpp"
#endif

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace troupe {
namespace {

constexpr std::string_view k_follow = "follow:";
constexpr std::string_view k_follow_all = "follow:all";
// Names of the backgrounds, in the order of the enumeration render::Background.
constexpr std::array<std::string_view, 4> k_backgrounds = {"paper", "white", "dark", "transparent"};

using render::Layers;

/// A layer: the name and text of a PictureLayer, and the member that shows it.
struct Layer {
  std::string_view name;
  bool Layers::*shown;
  std::string_view text;
};

constexpr Layer k_shown_layers[] = {
    {"grid", &Layers::grid, "grid lines on the floor"},
    {"shadows", &Layers::shadows, "shadows of bodies on the floor"},
    {"headings", &Layers::headings, "a mark at the front of each robot"},
    {"stalls", &Layers::stalls, "a red outline with a white rim around robots whose motion is blocked"},
    {"scale", &Layers::scale, "a scale bar; in perspective views, the distance between grid lines"},
    {"clock", &Layers::clock, "the simulated time"},
    {"speed", &Layers::speed,
     "speed as a multiple of real time: of the film or, in a single picture, of the run"},
    {"legend", &Layers::legend, "the colour scale of --color-by, with the unit"},
    {"bounds", &Layers::bounds, "the outline of the world's bounds, if the world has bounds"},
    {"types", &Layers::types, "a legend of the types of robots: colour, name and number of robots"},
    {"scans", &Layers::scans, "areas that rangers scan, as transparent surfaces"},
    {"beams", &Layers::beams, "scans of rangers, one line per beam"},
    {"sights", &Layers::sights, "lines from fiducial finders to the bodies they detect"},
    {"blobs", &Layers::blobs, "blobs that blob finders detect, in the colours of the blobs"},
    {"grips", &Layers::grips,
     "light beams of grippers (red if interrupted), and lines to the bodies that they hold"},
    {"links", &Layers::links, "lines from bodies to the bodies that they carry"},
    {"trails", &Layers::trails, "paths of bodies in the last 20 s, older parts paler"},
    {"names", &Layers::names, "names of robots and of other bodies that can move"},
    {"energy", &Layers::energy, "bars with the charges of power packs"},
    {"footprints", &Layers::footprints, "outlines of bodies on the floor"},
    {"coverage", &Layers::coverage, "squares of 1 m x 1 m that robots have visited, older visits paler"},
    {"density", &Layers::density, "squares of the floor, coloured by the number of robots in each"},
    {"tiles", &Layers::tiles,
     "number of robots in each tile; threads process these squares of the world in parallel"},
    {"cells", &Layers::cells, "cells of the spatial index that contain robots"},
};

constexpr auto k_layers = [] {
  std::array<PictureLayer, std::size(k_shown_layers)> layers;
  for (std::size_t i = 0; i < layers.size(); ++i)
    layers[i] = {k_shown_layers[i].name, Layers().*k_shown_layers[i].shown, k_shown_layers[i].text};
  return layers;
}();

/// An entry of a list of layers (PictureOptions::layers): a layer to show (`on`) or to hide.
struct LayerSwitch {
  std::string_view name;
  bool on = true;
};

std::vector<LayerSwitch> switches_of(std::string_view list) {
  std::vector<LayerSwitch> switches;
  if (list.empty()) return switches;
  for (std::string_view word : split(list, ',')) {
    const bool off = word.starts_with('-');
    if (off || word.starts_with('+')) word.remove_prefix(1);
    switches.push_back({word, !off});
  }
  return switches;
}

}  // namespace

std::span<const PictureLayer> picture_layers() { return k_layers; }

Result<> check_layers(const std::string& layers) {
  for (const LayerSwitch& layer : switches_of(layers)) {
    if (std::ranges::find(k_layers, layer.name, &PictureLayer::name) != k_layers.end()) continue;
    std::vector<std::string_view> known;
    for (const PictureLayer& one : k_layers) known.push_back(one.name);
    return Error{unknown_name("layer", std::string(layer.name), known)};
  }
  return {};
}

Result<> check_camera(const std::string& camera) {
  const std::vector<std::string_view> known = {"follow:NAME", "fit", "follow:all",
                                               "perspective", "top", "window"};
  const bool follows = camera.starts_with(k_follow) && camera.size() > k_follow.size();
  if (follows || std::ranges::find(known.begin() + 1, known.end(), camera) != known.end()) return {};
  return Error{unknown_name("camera", camera, known)};
}

Result<> check_background(const std::string& background) {
  if (std::ranges::find(k_backgrounds, background) != k_backgrounds.end()) return {};
  return Error{unknown_name("background", background, {k_backgrounds.begin(), k_backgrounds.end()})};
}

#ifdef TROUPE_HAS_RENDER

namespace {

constexpr double k_default_pitch = 40 * k_pi / 180;
constexpr double k_follow_widths = 24;  // width of the picture, as a multiple of the followed model's radius
constexpr double k_across_shapeless_m = 1.2;     // width of the picture of a followed model without a shape
constexpr double k_stage_fov = 70 * k_pi / 180;  // vertical angle of view of Stage's camera

/// Reads members of the entry `window` of a world by their names.
class Window {
 public:
  explicit Window(const engine::Record& record) : record_(record) {}
  bool on(std::string_view name) const { return value(name).boolean(); }
  const std::vector<double>& numbers(std::string_view name) const { return value(name).numbers(); }
  const engine::Value& value(std::string_view name) const {
    return engine::get(worldio::window_fields(), record_, name);
  }

 private:
  const engine::Record& record_;
};

/// Sets `view` to what the entry `window` of a world describes. The entry has the poses of two cameras, one
/// in perspective and one from above, and says which of them is used. In both poses, yaw turns
/// counter-clockwise, and pitch is 0 straight down and increases towards the horizontal, as in
/// render::Camera.
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
  camera.yaw = angle[1];
  if (camera.perspective) {
    const auto& eye = window.numbers("camera");
    camera.eye = Eigen::Vector3d(eye[0], eye[1], eye[2]);
    camera.fov = k_stage_fov;
  } else {
    const auto& center = window.numbers("center");
    camera.center = Eigen::Vector3d(center[0], center[1], 0);
    camera.across_m = view.width / window.value("scale_px_per_m").number();
  }
  const bool shows_data = window.on("show_data");
  Layers& layers = view.layers;
  layers.grid = window.on("show_grid");
  layers.clock = window.on("show_clock");
  layers.footprints = window.on("show_footprints");
  layers.cells = window.on("show_occupancy");
  layers.scans = shows_data && window.on("show_ranger_ranges");
  layers.sights = shows_data && window.on("show_fiducial");
  layers.blobs = shows_data && window.on("blobfinder_vis");
  layers.grips = shows_data && window.on("show_gripper_data");
}

/// Returns the body with this id from a list that is sorted by id; null if there is no such body.
const engine::FrameBody* find_body(const std::vector<engine::FrameBody>& bodies, std::uint32_t id) {
  const auto found = std::ranges::lower_bound(bodies, id, {}, &engine::FrameBody::id);
  return found == bodies.end() || found->id != id ? nullptr : &*found;
}

namespace fs = std::filesystem;
using Texts = std::vector<std::pair<std::string, std::string>>;

/// Returns the vector format that the ending of a file name selects; empty for all other endings.
std::optional<render::VectorFormat> vector_format(const fs::path& file) {
  if (file.extension() == ".svg") return render::VectorFormat::svg;
  if (file.extension() == ".pdf") return render::VectorFormat::pdf;
  return std::nullopt;
}

/// Throws std::invalid_argument for a null Shot. call: name of the calling function, for the error.
void require_shot(std::string_view call, const Pictures::Shot& shot) {
  if (!shot)
    throw std::invalid_argument(fmt::format("{}: found a null Shot: give one that take() returned", call));
}

/// Throws std::invalid_argument if a frame comes from another world than the scene: if it has bodies of
/// types, or readings of rangers, that the scene does not have. call: name of the calling function, for the
/// error.
void require_world_of(const engine::FrameScene& scene, std::string_view call, const engine::Frame& frame) {
  const std::size_t types = scene.types.size() + frame.types.size();
  const auto has_type = [types](const engine::FrameBody& body) { return body.type < types; };
  const auto has_ranger = [&](const engine::FrameScan& scan) {
    return scan.ranger < scene.rangers.size() && scan.first <= frame.ranges.size() &&
           scene.rangers[scan.ranger].readings <= frame.ranges.size() - scan.first;
  };
  if (!std::ranges::all_of(frame.mobile, has_type) || !std::ranges::all_of(frame.scans, has_ranger))
    throw std::invalid_argument(fmt::format(
        "{}: found a state of another world: these Pictures draw only the world with which they were made",
        call));
}

/// Throws std::invalid_argument if a number in the options cannot be drawn, or if the range of colours is
/// empty, reversed or of no use.
void check_picture_numbers(const PictureOptions& options) {
  if (const auto across = options.across_m;
      across && !(*across >= k_least_across_m && std::isfinite(*across)))
    throw std::invalid_argument(
        fmt::format("across_m is {}: give a finite number, at least {}", *across, k_least_across_m));
  for (const auto& [name, pair] : {std::pair("center_m", options.center_m),
                                   {"angle_rad", options.angle_rad},
                                   {"color_range", options.color_range}})
    if (pair && !(std::isfinite((*pair)[0]) && std::isfinite((*pair)[1])))
      throw std::invalid_argument(
          fmt::format("{} is ({}, {}): give two finite numbers", name, (*pair)[0], (*pair)[1]));
  if (options.color_range && options.color_by.empty())
    throw std::invalid_argument(
        "color_range has no effect without color_by: give color_by, or leave out color_range");
  if (const auto range = options.color_range; range && (*range)[0] >= (*range)[1])
    throw std::invalid_argument(fmt::format(
        "color_range is ({}, {}): give two different numbers, the lower first", (*range)[0], (*range)[1]));
}

}  // namespace

struct Pictures::ShotData {
  engine::Frame frame;
  std::optional<Eigen::Vector3d> center;  // of the followed model
  std::optional<double> across_m;         // for the followed model
  std::optional<Box> region;              // contains the robots; for the cameras fit and follow:all
  std::vector<std::pair<std::string, std::string>> text;
};

struct Pictures::Impl {
  PictureOptions options;
  render::View view;
  std::string file;                     // name of the source's file, for errors
  std::optional<std::uint32_t> follow;  // BodyId
  std::optional<Eigen::Vector3d> last_center;
  std::optional<double> last_across_m;
  bool shows_robots = false;  // the cameras fit and follow:all
  std::optional<Box> last_region;
  FrameWishes wishes;
  double tick_s;
  Trails trails;
  Covered covered;
  std::optional<render::Painter> painter;
  engine::FrameScene scene;  // the painter has a copy

  Impl(const PictureSource& source, PictureOptions wanted)
      : options(std::move(wanted)),
        file(source.file()),
        tick_s(source.tick_s()),
        trails(tick_s),
        scene(source.scene()) {
    check_picture_numbers(options);
    require_option("camera", check_camera(options.camera));
    require_option("layers", check_layers(options.layers));
    require_option("background", check_background(options.background));
    view.background = static_cast<render::Background>(std::ranges::find(k_backgrounds, options.background) -
                                                      k_backgrounds.begin());
    set_camera(source);
    for (const LayerSwitch& layer : switches_of(options.layers))
      view.layers.*std::ranges::find(k_shown_layers, layer.name, &Layer::name)->shown = layer.on;
    if (options.color_range) view.values = std::pair((*options.color_range)[0], (*options.color_range)[1]);
    const Layers& shown = view.layers;
    wishes = {.scans = shown.scans || shown.beams,
              .sights = shown.sights,
              .blobs = shown.blobs,
              .grips = shown.grips,
              .links = shown.links,
              .charges = shown.energy,
              .names = shown.names,
              .value = std::nullopt,
              .tiles = shown.tiles,
              .cells = shown.cells};
    if (!options.color_by.empty()) {
      Result<ChosenValue> value = source.find_value(options.color_by);
      require(value);
      wishes.value = *std::move(value);
    }
    require(source.check(wishes));
  }

  /// Throws InputError for an option whose value is wrong in every world. The error names the option, because
  /// the file of the source has no part in it.
  static void require_option(std::string_view option, const Result<>& result) {
    if (!result) throw InputError(fmt::format("{}: error: {}", option, result.error().text));
  }

  template <class T>
  void require(const Result<T>& result) const {
    if (!result) refuse(result.error().text);
  }

  [[noreturn]] void refuse(const std::string& message) const {
    throw InputError(fmt::format("{}: error: {}", file, message));
  }

  void find_followed(const PictureSource& source, const std::string& name) {
    follow = source.find_body(name);
    if (!follow) refuse(fmt::format("there is no model \"{}\" to follow", name));
  }

  void set_camera(const PictureSource& source) {
    const std::string& camera = options.camera;
    if (camera == "window") {
      if (!source.window())
        refuse(
            "the camera \"window\" needs a world file with the entry \"window\"; other cameras: fit, "
            "follow:all, follow:NAME, perspective, top");
      const Window window(*source.window());
      look_through(window, view);
      if (const std::string& name = window.value("follow").text(); !name.empty()) {
        find_followed(source, name);
        view.camera.eye.reset();
      }
    } else if (camera != "top" && camera != "fit") {
      view.camera.perspective = true;
      view.camera.pitch = k_default_pitch;
      if (camera.starts_with(k_follow) && camera != k_follow_all)
        find_followed(source, camera.substr(k_follow.size()));
    }
    shows_robots = camera == "fit" || camera == k_follow_all;
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

  const engine::FrameType& type_of(const engine::Frame& frame, const engine::FrameBody& body) const {
    const std::size_t known = scene.types.size();
    return body.type < known ? scene.types[body.type] : frame.types[body.type - known];
  }

  /// Sets the region of the picture: the region that contains the robots, with a margin, or, if no robot is
  /// left in the world, the region of the last picture that had robots.
  void show_robots_in(ShotData& shot) {
    constexpr double k_margin = 0.06;     // fraction of the larger side
    constexpr double k_least_side_m = 1;  // a single robot does not fill the picture
    Box region;
    for (const engine::FrameBody& body : shot.frame.mobile)
      if (const engine::FrameType& type = type_of(shot.frame, body); type.mobile)
        region.extend(Box::around(body.pose_world_body.position(), type.radius));
    if (!region.empty()) {
      const Vec2 half = (0.5 * region.size()).cwiseMax(0.5 * k_least_side_m);
      last_region =
          Box{region.center() - half, region.center() + half}.expanded(2 * k_margin * half.maxCoeff());
    }
    shot.region = last_region;
  }

  /// Centres the picture on the followed model, or on its last position if it has left the world.
  void follow_in(ShotData& shot) {
    if (shows_robots) show_robots_in(shot);
    if (!follow) return;
    const engine::Frame& frame = shot.frame;
    const engine::FrameBody* body = find_body(frame.mobile, *follow);
    if (!body) body = find_body(scene.fixed, *follow);
    if (body) {
      const engine::FrameType& type = type_of(frame, *body);
      const Pose& pose = body->pose_world_body;
      last_center = Eigen::Vector3d(pose.x, pose.y, pose.z);
      last_across_m =
          type.radius > 0 ? std::max(k_follow_widths * type.radius, k_least_across_m) : k_across_shapeless_m;
    }
    shot.center = last_center;
    shot.across_m = last_across_m;
  }

  render::Painter& ready_painter() {
    if (!painter) painter.emplace(scene);
    return *painter;
  }

  render::View view_of(const ShotData& shot) const {
    render::View own = view;
    if (shot.center && !options.center_m) own.camera.center = shot.center;
    if (!own.camera.across_m) own.camera.across_m = shot.across_m;
    own.region = shot.region;
    return own;
  }

  std::vector<std::uint8_t> draw(const ShotData& shot) {
    return ready_painter().draw(shot.frame, view_of(shot)).rgba;
  }

  /// Draws a frame from a view into the file `to`, with `texts` as metadata. name: the name of the file for
  /// error messages, which differs from `to` if `to` is a trial file.
  void write(const engine::Frame& frame, const render::View& from, const Texts& texts, const fs::path& to,
             const fs::path& name) {
    const std::string bytes = encoded(frame, from, texts, to, name);
    try {
      worldio::write_whole(to, {bytes});
    } catch (const std::system_error& error) {
      fail_to_write(name, error.code());
    }
  }

  /// Returns the bytes that write() writes.
  std::string encoded(const engine::Frame& frame, const render::View& from, const Texts& texts,
                      const fs::path& to, const fs::path& name) {
    if (const auto format = vector_format(to)) {
      if (!render::is_from_above(from.camera))
        refuse(fmt::format(
            "{}: .svg and .pdf need a view from straight above: the camera top or fit, without an "
            "angle; a .png takes any view",
            name.filename().string()));
      return ready_painter().draw_vector(frame, from, *format, texts);
    }
    render::Picture picture = ready_painter().draw(frame, from);
    try {
      return worldio::encode_png({picture.width, picture.height, std::move(picture.rgba)}, texts);
    } catch (const std::runtime_error& error) {
      fail_to_write(name, error.what());
    }
  }

  [[noreturn]] static void fail_to_write(const fs::path& name, std::string_view reason) {
    throw std::runtime_error(fmt::format("{}: error: cannot be written: {}", name.string(), reason));
  }

  [[noreturn]] static void fail_to_write(const fs::path& name, const std::error_code& code) {
    const std::string reason = worldio::write_failure(name, code.message());
    if (reason != code.message()) fail_to_write(name, reason);
    throw std::system_error(code, fmt::format("{}: error: cannot be written", name.string()));
  }
};

Pictures::Pictures(const PictureSource& source, PictureOptions options)
    : impl_(std::make_unique<Impl>(source, std::move(options))) {}
Pictures::Pictures(const Simulation& simulation, PictureOptions options)
    : Pictures(SimulationSource(simulation), std::move(options)) {}
Pictures::~Pictures() = default;
Pictures::Pictures(Pictures&&) noexcept = default;
Pictures& Pictures::operator=(Pictures&&) noexcept = default;

int Pictures::width() const { return impl_->view.width; }
int Pictures::height() const { return impl_->view.height; }
double Pictures::history_s() const {
  if (impl_->view.layers.coverage) return std::numeric_limits<double>::infinity();
  return impl_->view.layers.trails ? impl_->trails.history_s() : 0;
}

void Pictures::see(const Simulation& simulation) {
  if (impl_->view.layers.coverage || (impl_->view.layers.trails && impl_->trails.wants(simulation.tick())))
    see(SimulationSource(simulation));
}

void Pictures::see(const PictureSource& source) {
  if (history_s() == 0) return;
  const engine::Frame frame = source.frame({});
  require_world_of(impl_->scene, "see()", frame);
  if (impl_->view.layers.trails) impl_->trails.see(frame);
  if (impl_->view.layers.coverage) impl_->covered.see(impl_->scene, frame);
}

void Pictures::forget() {
  impl_->trails = Trails(impl_->tick_s);
  impl_->covered = {};
  impl_->last_center.reset();
  impl_->last_across_m.reset();
  impl_->last_region.reset();
}

void Pictures::update_scene(const Simulation& simulation) {
  impl_->scene = SimulationSource(simulation).scene();
  if (impl_->painter) impl_->painter->set_scene(impl_->scene);
}

Pictures::Shot Pictures::take(const Simulation& simulation, double times_real_time) {
  return take(SimulationSource(simulation), times_real_time);
}

Pictures::Shot Pictures::take(const PictureSource& source, double times_real_time) {
  auto shot = std::make_shared<ShotData>();
  shot->frame = source.frame(impl_->wishes);
  require_world_of(impl_->scene, "take()", shot->frame);
  shot->frame.times_real_time = times_real_time;
  impl_->follow_in(*shot);
  if (impl_->view.layers.trails) impl_->trails.add_to(shot->frame);
  if (impl_->view.layers.coverage) impl_->covered.add_to(shot->frame);
  shot->text = {{"Software", version_line()},
                {"world", source.world()},
                {"time_s", fmt::format("{}", shot->frame.time_s)},
                {"seed", fmt::format("{}", source.seed())},
                {"state_hash", hex(source.state_hash())}};
  return shot;
}

Pictures::Shot Pictures::between(const Shot& earlier, const Shot& later, double share) {
  require_shot("between()", earlier);
  require_shot("between()", later);
  if (!(share >= 0 && share <= 1))
    throw std::invalid_argument(fmt::format("between(): share is {}: give a number from 0 to 1", share));
  auto shot = std::make_shared<ShotData>(*earlier);
  const auto mix = [share](double a, double b) { return a + share * (b - a); };
  engine::Frame& frame = shot->frame;
  const engine::Frame& next = later->frame;
  frame.time_s = mix(frame.time_s, next.time_s);
  for (std::size_t i = 0, k = 0; i < frame.mobile.size(); ++i) {
    // Both lists are sorted by id. A body that dies between the two ticks is shown until `later`; a body that
    // is born between them is shown from `later` on.
    while (k < next.mobile.size() && next.mobile[k].id < frame.mobile[i].id) ++k;
    if (k == next.mobile.size() || next.mobile[k].id != frame.mobile[i].id) continue;
    Pose& pose = frame.mobile[i].pose_world_body;
    const Pose& to = next.mobile[k].pose_world_body;
    pose = {mix(pose.x, to.x), mix(pose.y, to.y), mix(pose.z, to.z),
            pose.heading + share * wrap_angle(to.heading - pose.heading)};
  }
  for (engine::FrameTrail& trail : frame.trails) {
    const Pose& pose = frame.mobile[trail.body].pose_world_body;
    trail.points.back() = {pose.x, pose.y, pose.z};
  }
  if (shot->center && later->center)
    shot->center = Eigen::Vector3d(*shot->center + share * (*later->center - *shot->center));
  if (shot->region && later->region)
    shot->region = Box{shot->region->min + share * (later->region->min - shot->region->min),
                       shot->region->max + share * (later->region->max - shot->region->max)};
  // An interpolated state has no hash.
  std::erase_if(shot->text, [](const auto& entry) { return entry.first == "state_hash"; });
  for (auto& [key, value] : shot->text)
    if (key == "time_s") value = fmt::format("{}", frame.time_s);
  return shot;
}

void Pictures::rehearse(const std::filesystem::path& file) {
  try {
    worldio::check_replaceable(file);
  } catch (const std::system_error& error) {
    Impl::fail_to_write(file, error.code());
  }
  std::filesystem::path beside = file;
  beside += fmt::format(".{}{}", getpid(), vector_format(file) ? file.extension().string() : ".png");
  render::View view = impl_->view;
  view.width = view.height = 16;
  impl_->write({}, view, {}, beside, file);
  std::error_code ignored;
  std::filesystem::remove(beside, ignored);
}

std::vector<std::uint8_t> Pictures::draw(const Shot& shot) {
  require_shot("draw()", shot);
  require_world_of(impl_->scene, "draw()", shot->frame);
  return impl_->draw(*shot);
}

void Pictures::write(const Shot& shot, const std::filesystem::path& file) {
  require_shot("write()", shot);
  require_world_of(impl_->scene, "write()", shot->frame);
  if (!vector_format(file) && file.extension() != ".png")
    throw InputError(fmt::format(
        "{}: error: this is not the name of a picture: it must end in .png, .svg or .pdf", file.string()));
  impl_->write(shot->frame, impl_->view_of(*shot), shot->text, file, file);
}

#else

struct Pictures::ShotData {};
struct Pictures::Impl {};

namespace {
[[noreturn]] void refuse_to_draw() {
  throw std::runtime_error(
      "this build cannot draw pictures: build Troupe with the CMake option -DTROUPE_RENDER=ON");
}
}  // namespace

Pictures::Pictures(const Simulation&, PictureOptions) { refuse_to_draw(); }
Pictures::Pictures(const PictureSource&, PictureOptions) { refuse_to_draw(); }
Pictures::~Pictures() = default;
Pictures::Pictures(Pictures&&) noexcept = default;
Pictures& Pictures::operator=(Pictures&&) noexcept = default;
int Pictures::width() const { return 0; }
int Pictures::height() const { return 0; }
double Pictures::history_s() const { return 0; }
void Pictures::see(const Simulation&) {}
void Pictures::see(const PictureSource&) {}
void Pictures::forget() {}
void Pictures::update_scene(const Simulation&) {}
Pictures::Shot Pictures::take(const Simulation&, double) { refuse_to_draw(); }
Pictures::Shot Pictures::take(const PictureSource&, double) { refuse_to_draw(); }
Pictures::Shot Pictures::between(const Shot&, const Shot&, double) { refuse_to_draw(); }
void Pictures::rehearse(const std::filesystem::path&) { refuse_to_draw(); }
std::vector<std::uint8_t> Pictures::draw(const Shot&) { refuse_to_draw(); }
void Pictures::write(const Shot&, const std::filesystem::path&) { refuse_to_draw(); }

#endif

}  // namespace troupe
