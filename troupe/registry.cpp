#include "troupe/registry.hpp"

#include "models/controllers/beeclust.hpp"
#include "models/controllers/brazil_nut.hpp"
#include "models/controllers/chain.hpp"
#include "models/controllers/clustering.hpp"
#include "models/controllers/collective_perception.hpp"
#include "models/controllers/collector.hpp"
#include "models/controllers/depots.hpp"
#include "models/controllers/expand.hpp"
#include "models/controllers/flocking.hpp"
#include "models/controllers/forager.hpp"
#include "models/controllers/gradient.hpp"
#include "models/controllers/informed_aggregation.hpp"
#include "models/controllers/operate.hpp"
#include "models/controllers/radio_flocking.hpp"
#include "models/controllers/rasterize.hpp"
#include "models/controllers/script.hpp"
#include "models/controllers/wander.hpp"
#include "models/controllers/waypoints.hpp"
#include "models/devices/actuator.hpp"
#include "models/devices/brush.hpp"
#include "models/devices/flags.hpp"
#include "models/devices/gripper.hpp"
#include "models/devices/led.hpp"
#include "models/devices/light.hpp"
#include "models/devices/power.hpp"
#include "models/devices/remover.hpp"
#include "models/devices/spawner.hpp"
#include "models/drives/drives.hpp"
#include "models/drives/wheels.hpp"
#include "models/faults/faults.hpp"
#include "models/measures/clusters.hpp"
#include "models/measures/coverage.hpp"
#include "models/measures/measures.hpp"
#include "models/measures/nearness.hpp"
#include "models/measures/rank_errors.hpp"
#include "models/model_kinds.hpp"
#include "sensors/blobfinder.hpp"
#include "sensors/bumper.hpp"
#include "sensors/camera.hpp"
#include "sensors/compass.hpp"
#include "sensors/fiducial.hpp"
#include "sensors/ground.hpp"
#include "sensors/light_sensor.hpp"
#include "sensors/radio.hpp"
#include "sensors/ranger.hpp"
#include "worldio/stage/stage_demos.hpp"

namespace troupe {

engine::Registry make_registry() {
  engine::Registry registry;
  registry.models = models::model_kinds();
  registry.devices = {
      sensors::ranger_kind(),        sensors::fiducial_kind(),     sensors::blobfinder_kind(),
      sensors::bumper_kind(),        sensors::camera_kind(),       models::blinkenlight_kind(),
      models::lightindicator_kind(), models::power_pack_kind(),    models::power_contact_kind(),
      models::flags_kind(),          models::actuator_kind(),      models::gripper_kind(),
      models::wheels_kind(),         models::spawner_kind(),       models::remover_kind(),
      sensors::radio_kind(),         models::led_kind(),           sensors::ground_kind(),
      models::brush_kind(),          sensors::light_sensor_kind(), sensors::compass_kind()};
  registry.drives = {models::diff_drive(), models::omni_drive(), models::car_drive()};
  registry.controllers = {models::expand_controller(),
                          models::wander_controller(),
                          models::script_controller(),
                          models::waypoints_controller(),
                          models::source_controller(),
                          models::sink_controller(),
                          models::fasr_controller(),
                          models::fasr2_controller(),
                          models::pioneer_flocking_controller(),
                          worldio::dynamic_controller(),
                          worldio::lasernoise_controller(),
                          models::rasterize_controller(),
                          models::operate_controller(),
                          models::collector_controller(),
                          models::gradient_controller(),
                          models::radio_flocking_controller(),
                          models::collective_perception_controller(),
                          models::beeclust_controller(),
                          models::chain_controller(),
                          models::brazil_nut_controller(),
                          models::clustering_controller(),
                          models::informed_aggregation_controller()};
  registry.measures = {models::coverage_measure(),       models::mean_nearest_distance_measure(),
                       models::neighbours_measure(),     models::stalls_measure(),
                       models::held_measure(),           models::displacement_measure(),
                       models::path_length_measure(),    models::mean_speed_measure(),
                       models::order_measure(),          models::polarisation_measure(),
                       models::spread_measure(),         models::alive_measure(),
                       models::share_within_measure(),   models::state_mean_measure(),
                       models::state_variance_measure(), models::rank_errors_measure(),
                       models::clusters_measure(),       models::largest_cluster_measure(),
                       models::deaths_measure()};
  registry.faults = {models::dead_sensors_fault(), models::slow_wheels_fault(), models::drop_out_fault()};
  registry.presets = {models::expand_pioneer_preset(), models::expand_swarm_preset()};
  return registry;
}

}  // namespace troupe
