// A state of charge that its device brings up to date every few minutes, as its map says
// ([response] soc_refresh_s). Each reading of it is of some instant since then, and orders turn
// meanwhile: what the energy of an interval between two readings is off by may be more than the
// interval. So
//   - a reading of the SoC has a range of energies, not one; where the SoC has just changed, a
//     narrower one;
//   - it stands still only if energy has flowed whichever instants the readings are of;
//   - readings are put together until that is three quarters of what has flowed, most of it one
//     way: then they are one interval of energy_balance.h. Where orders turn more often than that,
//     nothing is said.
#pragma once

#include <cstdint>

#include "edge/supervision/energy_balance.h"
#include "edge/supervision/energy_path.h"
#include "edge/supervision/response.h"

namespace bess {

class SeldomSoc {
 public:
  static constexpr std::int32_t kUsualRefreshS = 60;  ///< as old as that is any

  explicit SeldomSoc(const ResponseSettings& settings) : settings_(settings) {}

  [[nodiscard]] bool is_seldom() const { return settings_.band.soc_refresh_s > kUsualRefreshS; }

  /// Nothing is known of what was before this reading.
  void begin(const Response& now);
  /// `power_before_w` at the reading before, until the order of this one.
  void note_power(const Response& now, std::int32_t power_before_w);
  /// After `note_power` of it.
  void observe(const Response& now);

  /// Since the reading before.
  [[nodiscard]] EnergyRange change() const { return now_.energy.since(before_.energy); }
  /// That has surely flowed since the SoC last changed, with its sign.
  [[nodiscard]] std::int64_t still_ws() const {
    return now_.energy.since(changed_.energy).surely_ws();
  }
  [[nodiscard]] std::int64_t still_s() const { return now_.steady_s - changed_.steady_s; }
  [[nodiscard]] std::int32_t still_readings() const { return still_readings_; }

  /// Readings that say enough together.
  struct Interval {
    std::int64_t energy_ws = 0;
    std::int64_t surely_ws = 0;
    std::int32_t soc_e4 = 0;  ///< by how much it rose
    std::int64_t seconds = 0;
  };
  /// False: not yet. The next one begins where this one ends.
  bool take_interval(Interval& interval);
  /// What has come together so far says nothing: it was too long, or is excused.
  [[nodiscard]] bool is_too_long() const;
  void restart_interval() { from_ = now_; }
  void restart_standstill() { changed_ = now_, still_readings_ = 0; }

 private:
  /// A reading, and of what energy its SoC may be.
  struct Reading {
    std::int64_t steady_s = 0;
    std::int32_t soc_e4 = 0;
    EnergyRange energy{};
    std::int64_t energy_ws = 0;
    std::int64_t moved_ws = 0;  ///< both ways together
  };

  [[nodiscard]] Reading reading_of(const Response& now, std::int64_t refreshed_after_s) const;

  ResponseSettings settings_;
  EnergyPath path_;
  std::int64_t moved_ws_ = 0;
  std::int64_t noted_s_ = 0;
  Reading now_, before_;
  Reading changed_;  ///< the last at which the SoC was another one than before
  Reading from_;     ///< with which the interval began
  std::int32_t still_readings_ = 0;
};

}  // namespace bess
