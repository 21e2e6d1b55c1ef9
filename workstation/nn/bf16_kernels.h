// The tile kernels with factors rounded to bf16 and sums in fp32. What meets the network's own
// inputs stays in fp32: 8 bits would not tell one price from the next.
#pragma once

#include <vector>

#include "workstation/nn/tile_kernels.h"

namespace bess {

/// The fastest first; none where the processor has no such instructions.
std::vector<const TileKernels*> bf16_kernels();

}  // namespace bess
