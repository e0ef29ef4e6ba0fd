// The smallest program that drives a robot: load a world, find a robot, set its speed, and read its ranges.
// After Figure 3 of Vaughan, Massively multi-robot simulation in Stage, 2008.
#include <troupe/troupe.hpp>

#include <algorithm>
#include <iostream>

int main(int argc, char** argv) {
  troupe::Simulation world(argc > 1 ? argv[1] : "worlds/minimal.world");
  world.subscribe("r0");  // runs its sensors
  troupe::Model robot = world.find("r0");
  robot.set_speed(0.2, 0.05);  // m/s forward, rad/s to the left

  while (world.time_s() < 10) {
    world.step();
    if (std::ranges::min(robot.ranges()) < 0.5) robot.set_speed(0, 0.5);  // something is near: turn away
  }
  const troupe::Pose pose = robot.pose();
  std::cout << robot.name() << " is at (" << pose.x << ", " << pose.y << ") m, the nearest thing "
            << std::ranges::min(robot.ranges()) << " m away\n";
}
