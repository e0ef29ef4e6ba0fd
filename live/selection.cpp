#include "live/selection.hpp"

#include "live/request.hpp"
#include "troupe/acts.hpp"

#include <fmt/format.h>

#include <exception>
#include <utility>

namespace troupe::live {
namespace {

constexpr std::uint64_t k_most_columns = 1000000000;

}  // namespace

bool Selection::obey(const Request& request, Simulation& simulation) {
  const engine::World& world = simulation.world();
  if (request.what() == "inspect") {
    const std::string robot = request.name("robot");
    const BodyId body = robot.empty() ? BodyId() : world.state().names.find(robot);
    if (!robot.empty() && !body.valid()) throw ActRefused(fmt::format("there is no body \"{}\"", robot));
    inspected_ = body.valid() ? std::optional(body) : std::nullopt;
  } else if (request.what() == "plot") {
    const std::string measure = request.name("measure");
    try {
      measures_ = measure.empty() ? nullptr
                                  : std::make_unique<Measures>(simulation, std::vector<std::string>{measure});
    } catch (const std::exception& error) {  // a measure of a plug-in or script may throw anything
      throw ActRefused(error.what());
    }
    plotted_ = measure;
    plot_request_ = request.id();
  } else if (request.what() == "color") {
    if (!request.has("component")) {
      color_.reset();
      return true;
    }
    ColorValue color{.component = request.name("component"), .field = request.name("field")};
    if (request.has("column"))
      color.column = static_cast<std::uint32_t>(request.whole("column", 0, k_most_columns));
    if (!has_value(world, color))
      throw ActRefused(fmt::format("there is no field \"{}\"{} in the component \"{}\"", color.field,
                                   color.column ? fmt::format(" with a column {}", *color.column) : "",
                                   color.component));
    color_ = std::move(color);
  } else if (request.what() == "layers") {
    layers_ = request.layers("layers", layers_of(world));
  } else {
    return false;
  }
  return true;
}

void Selection::see(const Refuse& refuse) {
  use_plot(refuse, [](Measures& measures) { measures.see(); });
}

void Selection::use_plot(const Refuse& refuse, const std::function<void(Measures&)>& use) {
  if (!measures_) return;
  try {
    use(*measures_);
  } catch (const std::exception& error) {
    measures_.reset();
    plotted_.clear();
    refuse(plot_request_, error.what());
  }
}

nlohmann::ordered_json Selection::state(Simulation& simulation, const Refuse& refuse) {
  auto json = nlohmann::ordered_json::object();
  if (inspected_) json["inspected"] = inspection(simulation, *inspected_);
  use_plot(refuse, [&](Measures& measures) {
    json["plot"] = {{"measure", plotted_},
                    {"column", std::string(measures.columns().front())},
                    {"value", measures.values().front()}};
  });
  if (color_ && color_->least <= color_->most)
    json["shades"] = {{"least", color_->least}, {"most", color_->most}};
  if (!layers_.empty()) json["lines"] = lines_of(simulation.world(), layers_);
  return json;
}

}  // namespace troupe::live
