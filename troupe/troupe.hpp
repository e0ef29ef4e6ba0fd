#pragma once

/// This header includes the public headers of Troupe that most programs need.
#include "base/diagnostics.hpp"
#include "troupe/acts.hpp"
#include "troupe/batch_env.hpp"
#include "troupe/measures.hpp"
#include "troupe/pictures.hpp"
#include "troupe/recording.hpp"
#include "troupe/session.hpp"
#include "troupe/simulation.hpp"
#include "troupe/swarm.hpp"
#include "troupe/world_builder.hpp"
