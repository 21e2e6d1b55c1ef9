// Allocation count of the program's own code. Such a test program is linked with
// count_allocations.cpp and -Wl,--wrap=malloc -Wl,--wrap=_Znwm.
#pragma once

namespace bess {
long allocation_count();
}  // namespace bess
