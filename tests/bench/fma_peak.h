// Peak rate of the machine now: multiply-adds in registers, without memory.
#pragma once

#include "workstation/policy/nn/thread_team.h"

namespace bess {

/// GFLOP/s in float over all threads of the team; takes some milliseconds.
double fma_peak_gflops(ThreadTeam& team);

}  // namespace bess
