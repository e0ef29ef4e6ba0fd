#include "apps/observers/camera_pictures.hpp"

#include "apps/options.hpp"
#include "apps/outputs.hpp"
#include "apps/run/run_options.hpp"
#include "base/diagnostics.hpp"
#include "engine/spec/ticks.hpp"
#include "engine/world/world.hpp"
#include "worldio/images/png.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace troupe::apps {
namespace {

constexpr const char* k_color = "-color.png";  // ends of file names
constexpr const char* k_depth = "-depth.png";

using Text = std::vector<std::pair<std::string, std::string>>;

/// A camera of a robot. slot: the row of the robot in the table of the camera's readings.
struct RobotCamera {
  std::string name;  ///< "r0.eye"
  Row row;
  const engine::BodyType::Device* device;
  std::size_t slot;
  engine::Camera pictures;
};

/// Returns the cameras that are in use (CommittedView::senses()), in the order of body ids. Cameras of robots
/// that are not in the world are included.
std::vector<RobotCamera> running_cameras(const Simulation& simulation) {
  const engine::World& world = simulation.world();
  std::vector<RobotCamera> cameras;
  for (std::size_t b = 0; b < world.spec().bodies.size(); ++b) {
    const Row row = world.view().row(BodyId(b));
    if (!row.valid()) continue;
    for (const engine::BodyType::Device& device : world.view().type(row).devices) {
      if (!device.prepared.camera || !world.view().senses(row, device)) continue;
      const std::string body = world.spec().name(BodyId(b));
      cameras.push_back({device.name.empty() ? body : fmt::format("{}.{}", body, device.name), row, &device,
                         world.view().slot(row), *device.prepared.camera});
    }
  }
  return cameras;
}

/// Whether the camera has a reading and is not stopped: its robot is in the world, and has been in the world
/// for at least one period of the camera. A camera that is stopped, for example because its robot is
/// disabled, keeps its last reading.
bool has_reading(const engine::World& world, const RobotCamera& camera) {
  return world.view().is_there(camera.row) && world.view().runs(camera.row, *camera.device) &&
         world.tick() - world.view().birth_tick(camera.row) >= camera.device->period;
}

/// Returns the name of a camera in a form for file names: `/` is replaced by `_`, and a number is appended if
/// `taken` already contains the name. Adds the result to `taken`.
std::string file_stem(std::string name, std::set<std::string>& taken) {
  std::ranges::replace(name, '/', '_');
  std::string stem = name;
  for (int n = 2; !taken.insert(stem).second; ++n) stem = fmt::format("{}#{}", name, n);
  return stem;
}

/// Returns a simulated time, s, as text, such as "000012.300s", with enough digits to distinguish ticks, and
/// with leading zeros so that file names sort by time.
std::string time_text(double time_s, double tick_s) {
  const double tick_ms = tick_s * 1000;
  const int digits = std::abs(tick_ms - std::round(tick_ms)) < 1e-9 ? 3 : 6;
  constexpr int k_before = 7;  // digits before the point, and the point
  return fmt::format("{:0{}.{}f}s", time_s, k_before + digits, digits);
}

/// Returns an image of depths in millimetres, the usual format of depth cameras. Depths in `depths` are in m.
/// A pixel is 0 if its ray meets nothing; larger depths than 16 bits can represent are clamped.
worldio::DepthImage depth_image(const engine::Camera& camera, std::span<const float> depths) {
  worldio::DepthImage image{static_cast<int>(camera.width), static_cast<int>(camera.height), {}};
  const auto far = static_cast<float>(camera.range_far);
  constexpr double k_most = std::numeric_limits<std::uint16_t>::max();
  for (const float depth : depths) {
    const double mm = depth < far ? std::min(std::round(1000.0 * depth), k_most) : 0;
    image.values.push_back(static_cast<std::uint16_t>(mm));
  }
  return image;
}

}  // namespace

CameraPictures::CameraPictures(std::filesystem::path folder, std::uint64_t every_ticks)
    : folder_(std::move(folder)), every_ticks_(every_ticks) {
  std::error_code error;
  std::filesystem::create_directory(folder_, error);
  if (error) refuse_output(folder_, error.message());
}

void CameraPictures::observe(const Simulation& simulation) {
  const std::uint64_t tick = simulation.tick();
  if (tick == 0 || tick % every_ticks_ != 0) return;
  simulation.world().gather_distributed();
  std::set<std::string> taken;
  for (const RobotCamera& camera : running_cameras(simulation)) {
    const std::string stem = file_stem(camera.name, taken);
    if (!has_reading(simulation.world(), camera)) continue;
    const engine::StateTable& state = simulation.world().tables()[camera.device->table];
    const engine::Camera& pictures = camera.pictures;
    const auto color = state.cell<std::uint8_t>(camera.slot, pictures.color);
    const std::string name = fmt::format("{}-{}", stem, time_text(simulation.time_s(), simulation.tick_s()));
    Text text{{"camera", camera.name},
              {"tick", fmt::format("{}", tick)},
              {"time_s", fmt::format("{}", simulation.time_s())}};
    const auto write = [&](std::string_view ending, const auto& image) {
      const std::filesystem::path file = folder_ / fmt::format("{}{}", name, ending);
      const worldio::Descriptor reader = await_reader(file);
      worldio::write_png(file, image, text);
    };
    write(k_color, worldio::Image{static_cast<int>(pictures.width),
                                  static_cast<int>(pictures.height),
                                  {color.begin(), color.end()}});
    text.emplace_back("unit", "mm along the axis of view; 0: nothing is seen");
    write(k_depth, depth_image(pictures, state.cell<float>(camera.slot, pictures.depth)));
  }
}

namespace {

/// Throws InputError if no camera of the simulation runs, because no image would then be written. world: name
/// of the world file, for the error.
void check_cameras(const Simulation& simulation, const std::filesystem::path& world) {
  if (!running_cameras(simulation).empty()) return;
  throw InputError(
      fmt::format("{}: error: --camera-png: no camera of this world runs: set \"active\": true for a camera "
                  "(\"alwayson 1\" in a .world file); a camera that a controller reads also runs",
                  world.string()));
}

/// Throws InputError if the name of a camera is too long for the names of its images.
///
/// folder: folder of the images; it need not exist
/// end_s: simulated time at the end of the run, s
/// world: name of the world file, for the error
void check_names(const Simulation& simulation, const std::filesystem::path& folder, double end_s,
                 const std::filesystem::path& world) {
  constexpr long k_usual_bytes = 255;  // longest name of a file on nearly all file systems
  constexpr std::string_view k_partial = ".1000.partial";  // longest end of a temporary name (PartialFile)
  std::error_code ignored;
  const std::filesystem::path above = folder.has_parent_path() ? folder.parent_path() : ".";
  const long limit =
      pathconf((std::filesystem::exists(folder, ignored) ? folder : above).c_str(), _PC_NAME_MAX);
  const auto most = static_cast<std::size_t>(limit > 0 ? limit : k_usual_bytes);
  std::set<std::string> taken;
  for (const RobotCamera& camera : running_cameras(simulation)) {
    const std::string stem = file_stem(camera.name, taken);
    const std::string others =
        fmt::format("-{}{}{}", time_text(end_s, simulation.tick_s()), k_depth, k_partial);
    if (stem.size() + others.size() > most)
      throw InputError(
          fmt::format("{}: error: --camera-png: the name \"{}\" has {} bytes, which is too long for "
                      "the names of its images: at most {} bytes are possible",
                      world.string(), camera.name, stem.size(), most - std::min(most, others.size())));
  }
}

class CameraOutput : public ClonedOutput<CameraOutput> {
 public:
  void add_options(CLI::App& app, RunOptions&) override {
    CLI::Option* folder =
        add_value(app, "--camera-png", "DIR",
                  "Write colour and depth images of each running camera to a folder, as PNG, at intervals",
                  [this](const std::string& text) {
                    if (text.empty() || text.starts_with('-'))
                      refuse("--camera-png", text, "the name of a folder");
                    folder_ = text;
                    if (!folder_.has_filename()) folder_ = folder_.parent_path();
                  });
    add_value(
        app, "--camera-every", "S",
        "Interval of camera images in simulated seconds; 0: every tick (default: 1)",
        [this](const std::string& text) { every_s_ = seconds_from_zero("--camera-every", text); }, folder);
  }
  std::vector<std::filesystem::path*> names(RunOptions&) override { return {&folder_}; }
  std::vector<std::filesystem::path> files(const RunOptions&) const override {
    check_folder(folder_);
    return {};
  }
  OpenOutput prepare(const RunOptions& options, Simulation& simulation,
                     std::uint64_t end_tick) const override {
    if (folder_.empty()) return nullptr;
    check_cameras(simulation, options.world);
    check_names(simulation, folder_, static_cast<double>(end_tick) * simulation.tick_s(), options.world);
    return [this, &simulation](Observers& observers) {
      observers.push_back(
          std::make_unique<CameraPictures>(folder_, engine::period_ticks(every_s_, simulation.tick_s())));
    };
  }

 private:
  std::filesystem::path folder_;
  double every_s_ = 1;  // 0: every tick
};

}  // namespace

std::unique_ptr<RunOutput> camera_output() { return std::make_unique<CameraOutput>(); }

}  // namespace troupe::apps
