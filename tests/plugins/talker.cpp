// Robots that send their heading, turn to the mean of the headings that they receive, and show the number of
// these: the controller of tests/python/swarm_devices_test.py, so that a test can compare both. Also a device
// for that test whose command is a bool: the commands of Troupe's own devices have none.
#include <models/devices/led.hpp>
#include <sensors/radio.hpp>
#include <troupe/plugin.hpp>

struct Talker {
  static constexpr std::array k_uses{std::string_view("radio"), std::string_view("led")};

  void operator()(const troupe::Percept& percept, troupe::Random&, troupe::Actions& actions) const {
    const troupe::sensors::RadioPort radio(percept.devices[0], actions.devices[0]);
    double x = 0;
    double y = 0;
    for (std::size_t i = 0; i < radio.count(); ++i)
      if (float cos = 0, sin = 0; radio[i].read(cos, sin)) {
        x += cos;
        y += sin;
      }
    const double heading = percept.estimate.heading;
    actions.set_speed(0.2, 0, radio.count() > 0 ? troupe::wrap_angle(troupe::atan2(y, x) - heading) : 0.0);
    radio.say(static_cast<float>(troupe::cos(heading)), static_cast<float>(troupe::sin(heading)));
    actions.device<troupe::models::LedCommand>(1) = {1, static_cast<float>(radio.count()) / 16, 0.25f, 0.25f};
  }
};
TROUPE_CONTROLLER("talker", Talker)

/// A device without an effect.
struct Horn {
  struct Command {
    float pitch = 0;
    bool blows = false;
    TROUPE_FIELDS(pitch, blows)
  };
  void act(const troupe::DeviceBatch&) const {}
};

troupe::DeviceKind horn() { return troupe::make_device_kind<Horn>("horn", "a horn"); }
TROUPE_DEVICE("horn", horn)
