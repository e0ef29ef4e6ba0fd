#pragma once

#include "partition/ranging.hpp"

namespace troupe::partition {

/// The functions whose loops are kernels, for kernels_are_right().
struct Kernels {
  decltype(&partition::turn) turn = &partition::turn;
  decltype(&partition::project) project = &partition::project;
  decltype(&partition::limits_of) limits_of = &partition::limits_of;
  decltype(&partition::ranges_of) ranges_of = &partition::ranges_of;
  decltype(&partition::may_meet) may_meet = &partition::may_meet;
  decltype(&partition::unpack) unpack = &partition::unpack;
};

/// Whether the kernels compute a small fixed scene as plain loops do: the same bits of all ranges, and no
/// circle missing that a beam hits. The scene has fans of every form, edges of every form that the formula of
/// ranging.hpp treats differently, and the special values 0 and infinity. Takes about 0.1 ms.
bool kernels_are_right(const Kernels& kernels = {});

}  // namespace troupe::partition
