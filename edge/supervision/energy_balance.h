// Does the state of charge move as the measured power explains? One reading of a coarse state of
// charge says little, two hours of them much: every span of the newest intervals that ends now is
// judged, short ones and long ones, charging and discharging together, against the noise that the
// resolution of the SoC alone makes.
//
// An interval i between two readings brings energy e_i (measured) and a change of the SoC s_i, both
// in 1e-4 of the capacity. With k the share of the energy that arrives, s_i = k e_i + u_i -
// u_(i-1), where u is the error of one reading of the SoC, independent of the others. Over a span
//
//   sum (K e_i - s_i) e_i  =  (K - k) sum e_i^2  -  sum u_i (e_i - e_(i+1))
//
// so that k < K is shown when the left side exceeds z sigma_u sqrt(sum (e_i - e_(i+1))^2), with e =
// 0 outside the span. A single interval is no evidence, however far it lies off: the finding must
// hold without the one that speaks for it most, or a battery that sets its count right would be
// accused.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace bess {

/// What two readings of the battery, one after the other, say together.
struct EnergyInterval {
  enum class Kind : std::uint8_t {
    kUnknown,  ///< not under control throughout, too long, excused, or hardly any power
    kFlowing,
    kResting,  ///< 0 W were ordered, and next to nothing was measured at both ends
  };
  Kind kind = Kind::kUnknown;
  std::int16_t energy_e4 = 0;  ///< measured; charging is positive
  /// The same, had the battery followed its order, and the SoC the battery, as late as they may:
  /// less where the order has changed, and of the other sign after a reversal.
  std::int16_t late_energy_e4 = 0;
  std::int16_t soc_e4 = 0;  ///< by how much the SoC rose
  std::int16_t seconds = 0;
  std::int32_t power_w = 0;  ///< measured at its end
};

struct EnergyBalanceSettings {
  std::int32_t capacity_wh = 8'000;
  std::int32_t noise_w = 200;  ///< own consumption, and error of the meter
  bool charges_by_itself = false;
};

class EnergyBalance {
 public:
  static constexpr std::size_t kIntervals = 60;  ///< two hours

  /// What the spans show. Shares in percent of the measured energy; 0: nothing is found.
  struct Findings {
    bool contradicts =
        false;  ///< beyond what any honest battery does: less than 40 %, more than 250 %
    std::int16_t share_percent =
        0;  ///< of the energy shows in the SoC: below 70 or above 150 where it is found
    std::int32_t rest_loss_w = 0;  ///< at 0 W, or besides its orders, it loses that much (negative:
                                   ///< gains), measured or not
  };

  explicit EnergyBalance(const EnergyBalanceSettings& settings) : settings_(settings) {}

  /// The newest interval; `soc_span_e4`: how far two readings of the same SoC may lie apart.
  void observe(const EnergyInterval& interval, std::int32_t soc_span_e4);
  /// Between the intervals before and the next nothing is known.
  void interrupt() { add(EnergyInterval{}); }

  [[nodiscard]] const Findings& findings() const { return findings_; }

 private:
  void add(const EnergyInterval& interval);
  void judge_flow(std::int64_t soc_variance);
  void judge_rest(std::int64_t soc_variance);
  void judge_drift(std::int64_t soc_variance);
  /// 0 is the newest.
  [[nodiscard]] const EnergyInterval& back(std::size_t i) const {
    return intervals_[(next_ + kIntervals - 1 - i) % kIntervals];
  }

  EnergyBalanceSettings settings_;
  std::array<EnergyInterval, kIntervals> intervals_{};
  std::size_t next_ = 0;
  std::size_t count_ = 0;
  Findings findings_;
};

}  // namespace bess
