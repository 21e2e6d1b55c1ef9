// What the machine could do at this moment: multiply-adds on registers alone, without memory.
#pragma once

#include "workstation/policy/nn/thread_team.h"

namespace bess {

/// GFLOP/s in float over all of the team's threads at once; takes some milliseconds.
double fma_peak_gflops(ThreadTeam& team);

}  // namespace bess
