#include "engine/world/derivation.hpp"

#include "base/capacity.hpp"
#include "base/diagnostics.hpp"

#include <algorithm>
#include <cstddef>

namespace troupe::engine {

void Derivation::derive() {
  movement_.draw_odometry_errors();
  interventions_.derive();
  derive_state();
}

void Derivation::derive_state() {
  std::ranges::fill(state_.contacts, Contact());
  lives_.derive();
  interventions_.count_impaired();
  movement_.count_stalls();
  links_.derive();
  for (std::size_t r = 0; r < state_.row_count(); ++r) places_.derive(Row(r));
  tick_.clear_effects();
  places_.clear_placed();
  places_.index();
}

void Derivation::derive_rows() {
  resize_with_capacity(state_.radii, state_.row_count());
  resize_with_capacity(state_.shapes, state_.row_count());
  resize_with_capacity(state_.transforms, state_.row_count());
  if (!state_.not_drawn.empty()) resize_with_capacity(state_.not_drawn, state_.row_count());
  movement_.build();
  links_.build();
  state_.bind_view();
  movement_.draw_odometry_errors();
  lives_.count_present();
  interventions_.count_impaired();
  movement_.count_stalls();
  links_.derive();
  for (std::size_t r = 0; r < state_.row_count(); ++r) places_.derive(Row(r));
  if (state_.ray_grid) {
    Diagnostics diagnostics(state_.spec.files);  // stays empty: the constructor has made the same checks
    places_.build_ray_grid(diagnostics);
  }
  tick_.follow_rows();
  places_.index();
}

void Derivation::forget() {
  lives_.forget();
  interventions_.forget();
  links_.forget();
  movement_.forget();
  places_.forget();
  derive();
  movement_.forget_motions();
}

}  // namespace troupe::engine
