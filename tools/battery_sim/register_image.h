// The registers of an AlphaESS battery as its master sees them: measurements are rendered from the
// physics at every request, writes to the dispatch block become orders. Addresses, types and signs
// come from the same map file that the edge uses.
#pragma once

#include <cstdint>
#include <span>

#include "edge/registers/register_map.h"
#include "tools/battery_sim/simulated_battery.h"

namespace bess {

class RegisterImage {
 public:
  static constexpr int kRegisterCount = 0x1'0000;

  /// `registers` are the holding registers that the bus serves. Throws SimError when the map lacks
  /// the dispatch points that this simulator acts.
  RegisterImage(const RegisterMap& map, SimulatedBattery& battery,
                std::span<std::uint16_t> registers);

  /// Brings the battery to `utc_ns` and renders what it measures.
  void refresh(std::int64_t utc_ns);
  /// Acts on a write that has just changed registers; call `refresh` before the write.
  void apply_write(int address, int count);

 private:
  [[nodiscard]] std::int64_t value(int point) const;
  void set(int point, std::int64_t value);
  [[nodiscard]] bool covers(int address, int count, int point) const;

  const RegisterMap& map_;
  SimulatedBattery& battery_;
  std::span<std::uint16_t> registers_;
  int start_, power_, mode_, soc_limit_, time_;
  bool was_started_ = false;
};

}  // namespace bess
