// How quickly and how exactly a device follows an order: its register map says it ([response]), the
// supervision of its answers judges by it.
#pragma once

#include <cstdint>

namespace bess {

struct ResponseBand {
  std::int32_t settle_s = 20;           ///< from an order to the power that answers it
  std::int32_t tolerance_percent = 15;  ///< of the ordered power
  std::int32_t tolerance_w = 200;       ///< own consumption and error of the meter, at any power
  std::int32_t soc_step_e4 = 100;   ///< the smallest change of the state of charge that it shows
  std::int32_t soc_refresh_s = 60;  ///< as old as that the state of charge may be
  bool charges_by_itself = false;   ///< surplus PV charges it, whatever is ordered
};

}  // namespace bess
