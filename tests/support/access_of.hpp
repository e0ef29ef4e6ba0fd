#pragma once

#include "engine/rows/ranks.hpp"
#include "engine/world/rank_access.hpp"
#include "engine/world/world.hpp"

namespace troupe::test {

/// The access of ranks to a world, by which tests change it between two steps in ways that programs cannot.
/// The world must have no other ranks.
inline engine::RankAccess& access_of(engine::World& world) {
  struct Taker final : engine::Ranks {
    void join(engine::RankAccess& access) override { given = &access; }
    engine::RankAccess* given = nullptr;
  };
  Taker taker;
  world.attach(&taker);
  world.attach(nullptr);
  return *taker.given;
}

}  // namespace troupe::test
