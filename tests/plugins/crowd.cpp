// Measures of a plug-in: one without and one with parameters and memory.
#include <troupe/plugin.hpp>

#include <algorithm>

/// Distance between the two robots that are farthest apart.
struct Extent : troupe::Measure {
  static constexpr std::string_view text = "distance between the two robots that are farthest apart";
  static constexpr std::string_view formula = "max_(i, j) |x_i - x_j|";
  static constexpr troupe::Unit unit = troupe::Unit::meters;

  Extent(const troupe::MeasuredWorld&, std::vector<troupe::BodyId> its_robots)
      : robots(std::move(its_robots)) {}
  double value(const troupe::MeasuredWorld& world) override {
    double farthest = 0;
    const auto place = [&](troupe::BodyId id) { return world.transform(world.row(id)).position; };
    for (const troupe::BodyId a : robots)
      for (const troupe::BodyId b : robots) farthest = std::max(farthest, (place(a) - place(b)).norm());
    return farthest;
  }

  std::vector<troupe::BodyId> robots;
};
TROUPE_MEASURE("crowd", Extent)

/// Number of ticks in which the first robot has been beyond a line.
struct Beyond : troupe::Measure {
  struct Params {
    double x = 0;

    static constexpr void describe(troupe::Description<Params>& d) {
      d.member<&Params::x>("x", troupe::Unit::meters, troupe::facts::required, "place of the line");
    }
  };
  static constexpr std::string_view text = "ticks in which the first robot was beyond a line";

  Beyond(const troupe::MeasuredWorld&, const Params& its_params, std::vector<troupe::BodyId> its_robots)
      : params(its_params), robots(std::move(its_robots)) {}
  void see(const troupe::MeasuredWorld& world) override {
    ticks += world.transform(world.row(robots.front())).position.x() > params.x;
  }
  double value(const troupe::MeasuredWorld&) override { return ticks; }
  std::span<std::byte> memory() override { return std::as_writable_bytes(std::span(&ticks, 1)); }

  Params params;
  std::vector<troupe::BodyId> robots;
  double ticks = 0;
};
TROUPE_MEASURE("beyond", Beyond)
