// How often the program's own code has asked for memory so far. Such a test program is linked with
// count_allocations.cpp and -Wl,--wrap=malloc -Wl,--wrap=_Znwm.
#pragma once

namespace bess {
long allocation_count();
}  // namespace bess
