#include "engine/conflicts/conflict_resolver.hpp"

/// The part of conflict resolution that says what blocked a motion (class Conflicts, `result`).

namespace troupe::engine {

void Conflicts::Resolver::Earliest::take(std::size_t at, bool is_static_body, BodyId by,
                                         const Place& its_place) {
  if (at == 0 || (sample != 0 && at > sample)) return;
  const bool is_earlier = sample == 0 || at < sample;
  const bool is_first = is_static_body != is_static ? is_static_body : by < body;
  if (is_earlier || is_first) *this = {at, is_static_body, by, its_place};
}

void Conflicts::Resolver::take(Earliest& earliest, Mover& mover, std::uint32_t other,
                               const Place& place) const {
  earliest.take(blocked_at(mover, other, place.z, place.at), false, BodyId(crowd_.ids[other]), place);
}

void Conflicts::Resolver::set_block(const Earliest& earliest, Mover& mover) const {
  if (earliest.sample == 0) return;
  crowd_.blocks[mover.row] = {{Contact::k_body, earliest.body.value + 1, 0},
                              static_cast<std::uint32_t>(earliest.sample),
                              static_cast<std::uint32_t>(mover.samples()),
                              earliest.place.at,
                              earliest.place.z};
}

void Conflicts::Resolver::explain(std::uint32_t row) const {
  const Outcome outcome = conflicts_.outcome(row);
  if (outcome == Outcome::out_of_bounds) crowd_.blocks[row].contact.cause = Contact::k_bounds;
  if (outcome != Outcome::blocked && outcome != Outcome::turned) return;
  Mover mover(crowd_, row);
  Earliest earliest;
  if (const std::size_t k = blocked_by_scene_at(mover); k != 0)
    earliest.take(k, true, scene_.blocker(mover.at_sample(k - 1), mover.at_sample(k)), {});
  if (crowd_.pushables.any() && !is_plain(row)) return explain_in_zone(mover, earliest);
  const Box mine = swept(row, mover.shape.radius + partition::k_rounding_m);
  for_each_near(mover, [&](std::uint32_t other) {
    if (other != row && !crowd_.shapes[other]->empty() &&
        mine.touches(swept(other, crowd_.shapes[other]->radius)))
      take(earliest, mover, other, place_at_turn(mover, other));
  });
  set_block(earliest, mover);
}

}  // namespace troupe::engine
