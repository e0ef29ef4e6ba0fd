#include "troupe/registry.hpp"

#include "models/actuator.hpp"
#include "models/beeclust.hpp"
#include "models/brazil_nut.hpp"
#include "models/chain.hpp"
#include "models/clustering.hpp"
#include "models/clusters.hpp"
#include "models/collective_perception.hpp"
#include "models/collector.hpp"
#include "models/coverage.hpp"
#include "models/demos.hpp"
#include "models/depots.hpp"
#include "models/drives.hpp"
#include "models/expand.hpp"
#include "models/faults.hpp"
#include "models/flags.hpp"
#include "models/flocking.hpp"
#include "models/forager.hpp"
#include "models/gradient.hpp"
#include "models/gripper.hpp"
#include "models/ground.hpp"
#include "models/informed_aggregation.hpp"
#include "models/led.hpp"
#include "models/light.hpp"
#include "models/light_sensor.hpp"
#include "models/measures.hpp"
#include "models/model_kinds.hpp"
#include "models/nearness.hpp"
#include "models/operate.hpp"
#include "models/power.hpp"
#include "models/radio.hpp"
#include "models/radio_flocking.hpp"
#include "models/rank_errors.hpp"
#include "models/remover.hpp"
#include "models/script.hpp"
#include "models/spawner.hpp"
#include "models/wander.hpp"
#include "models/waypoints.hpp"
#include "models/wheels.hpp"
#include "sensors/blobfinder.hpp"
#include "sensors/bumper.hpp"
#include "sensors/camera.hpp"
#include "sensors/fiducial.hpp"
#include "sensors/ranger.hpp"

namespace troupe {

engine::Registry make_registry() {
  engine::Registry registry;
  registry.models = models::model_kinds();
  registry.devices = {sensors::ranger_kind(),        sensors::fiducial_kind(),   sensors::blobfinder_kind(),
                      sensors::bumper_kind(),        sensors::camera_kind(),     models::blinkenlight_kind(),
                      models::lightindicator_kind(), models::power_pack_kind(),  models::power_contact_kind(),
                      models::flags_kind(),          models::actuator_kind(),    models::gripper_kind(),
                      models::wheels_kind(),         models::spawner_kind(),     models::remover_kind(),
                      models::radio_kind(),          models::led_kind(),         models::ground_kind(),
                      models::brush_kind(),          models::light_sensor_kind()};
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
                          models::dynamic_controller(),
                          models::lasernoise_controller(),
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
  registry.measures = {models::coverage_measure(),    models::mean_nearest_distance_measure(),
                       models::neighbours_measure(),  models::stalls_measure(),
                       models::held_measure(),        models::displacement_measure(),
                       models::path_length_measure(), models::mean_speed_measure(),
                       models::order_measure(),       models::spread_measure(),
                       models::alive_measure(),       models::share_within_measure(),
                       models::state_mean_measure(),  models::rank_errors_measure(),
                       models::clusters_measure(),    models::largest_cluster_measure(),
                       models::deaths_measure()};
  registry.faults = {models::dead_sensors_fault(), models::slow_wheels_fault(), models::drop_out_fault()};
  registry.presets = {models::expand_pioneer_preset(), models::expand_swarm_preset()};
  return registry;
}

}  // namespace troupe
