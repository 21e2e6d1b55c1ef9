#include "tools/hil_runner/witness/maker_table.h"

#include <cmath>

namespace bess {
namespace {

using Value = MakerTable::Value;

Value times(const Value& value, double factor) {
  return value ? Value(*value * factor) : std::nullopt;
}
Value of(const std::optional<std::uint16_t>& word) { return word ? Value(*word) : std::nullopt; }
Value minus(const Value& a, const Value& b) { return a && b ? Value(*a - *b) : std::nullopt; }

/// AlphaESS, manual V1.23: 0x0102 SoC in 0.1 %; 0x0126 power, discharge positive; dispatch at
/// 0x0880: start, then 32000 + W in two registers, below 32000 charge.
struct AlphaEss : MakerTable {
  static constexpr int kUnit = 85;
  Value soc_frac(const WireMemory& wire) const override {
    return times(of(wire.word(kUnit, 0x0102)), 0.001);
  }
  Value power_w(const WireMemory& wire) const override {
    return times(wire.signed16(kUnit, 0x0126), -1);
  }
  Value ordered_w(const WireMemory& wire) const override {
    if (wire.word(kUnit, 0x0880) != 1) return std::nullopt;
    return minus(32'000, wire.unsigned32(kUnit, 0x0881));
  }
};

/// bess-sim's own: 10 SoC in 0.01 %, 11 power, 100 on, 101 ordered power, charge positive.
struct Simulator : MakerTable {
  Value soc_frac(const WireMemory& wire) const override {
    return times(of(wire.word(1, 10)), 0.0001);
  }
  Value power_w(const WireMemory& wire) const override { return wire.signed32(1, 11); }
  Value ordered_w(const WireMemory& wire) const override {
    return wire.word(1, 100) == 1 ? wire.signed32(1, 101) : std::nullopt;
  }
};

/// SunSpec 124, by offsets from the model's id: 2 WChaMax, 5 StorCtl_Mod (1: limit of charging, 2:
/// of discharging), 8 ChaState, 12 OutWRte and 13 InWRte in the percent of WChaMax. A negative
/// limit of one is the other.
struct StorageModel : MakerTable {
  static constexpr double kWhole = 10'000;  // with the scale of -2 that both devices have
  virtual std::optional<int> model(const WireMemory& wire) const = 0;

  Value ordered_w(const WireMemory& wire) const override {
    const auto at = model(wire);
    if (!at) return std::nullopt;
    const auto mode = wire.word(1, *at + 5);
    if (!mode || *mode == 0) return std::nullopt;
    const Value rating_w = of(wire.word(1, *at + 2));
    const bool limits_discharging = *mode == 2;
    const Value rate = wire.signed16(1, *at + (limits_discharging ? 12 : 13));
    if (!rate || !rating_w) return std::nullopt;
    return *rating_w * *rate / kWhole * (limits_discharging ? -1 : 1);
  }
};

/// Fronius GEN24 with integers: model 124 at 40343, SoC in 0.01 %; 40314 power that charges, 40334
/// that discharges.
struct FroniusGen24 : StorageModel {
  std::optional<int> model(const WireMemory&) const override { return 40'343; }
  Value soc_frac(const WireMemory& wire) const override {
    return times(of(wire.word(1, 40'351)), 0.0001);
  }
  Value power_w(const WireMemory& wire) const override {
    return minus(of(wire.word(1, 40'314)), of(wire.word(1, 40'334)));
  }
};

/// Where a chain of models has this one, by what was read of it: "SunS" at 40000, then id and
/// length of each.
std::optional<int> find_model(const WireMemory& wire, int id) {
  if (wire.word(1, 40'000) != 0x5375 || wire.word(1, 40'001) != 0x6E53) return std::nullopt;
  for (int at = 40'002;;) {
    const auto found = wire.word(1, at);
    const auto length = wire.word(1, at + 1);
    if (!found || !length || *found == 0xFFFF) return std::nullopt;
    if (*found == id) return at;
    at += 2 + *length;
  }
}

/// A value whose decimal exponent stands in another register.
Value scaled(const Value& value, const Value& exponent) {
  return value && exponent ? Value(*value * std::pow(10, *exponent)) : std::nullopt;
}

/// SunSpec 103 and 124: 103 +14 AC power and +15 its exponent, discharge positive; 124 +22 is the
/// SoC's exponent.
struct SunSpec124 : StorageModel {
  std::optional<int> model(const WireMemory& wire) const override { return find_model(wire, 124); }
  Value soc_frac(const WireMemory& wire) const override {
    const auto at = model(wire);
    if (!at) return std::nullopt;
    return times(scaled(of(wire.word(1, *at + 8)), wire.signed16(1, *at + 22)), 0.01);
  }
  Value power_w(const WireMemory& wire) const override {
    const auto at = find_model(wire, 103);
    if (!at) return std::nullopt;
    return times(scaled(wire.signed16(1, *at + 14), wire.signed16(1, *at + 15)), -1);
  }
};

/// SunSpec 704 and 802: 704 +22 on, +24 W in two registers, discharge positive, +55 its exponent;
/// 802 +11 SoC, its exponent at +56, +47 power, its exponent at +63.
struct SunSpec704 : MakerTable {
  Value soc_frac(const WireMemory& wire) const override {
    const auto at = find_model(wire, 802);
    if (!at) return std::nullopt;
    return times(scaled(of(wire.word(1, *at + 11)), wire.signed16(1, *at + 56)), 0.01);
  }
  Value power_w(const WireMemory& wire) const override {
    const auto at = find_model(wire, 802);
    if (!at) return std::nullopt;
    return times(scaled(wire.signed16(1, *at + 47), wire.signed16(1, *at + 63)), -1);
  }
  Value ordered_w(const WireMemory& wire) const override {
    const auto at = find_model(wire, 704);
    if (!at || wire.word(1, *at + 22) != 1) return std::nullopt;
    return times(scaled(wire.signed32(1, *at + 24), wire.signed16(1, *at + 55)), -1);
  }
};

/// Victron GX, CCGX register list: unit 100, 842 power, 843 SoC in %, 2902 ESS mode, 3 while ours;
/// unit 228, 37, 40 and 41 what each phase is to take, charge positive.
struct VictronEss3 : MakerTable {
  explicit VictronEss3(int of_phases) : phases(of_phases) {}
  Value soc_frac(const WireMemory& wire) const override {
    return times(of(wire.word(100, 843)), 0.01);
  }
  Value power_w(const WireMemory& wire) const override { return wire.signed16(100, 842); }
  Value ordered_w(const WireMemory& wire) const override {
    if (wire.word(100, 2902) != 3) return std::nullopt;
    Value sum = wire.signed16(228, 37);
    for (int phase = 1; phase < phases; ++phase) {
      const Value more_w = wire.signed16(228, 39 + phase);
      sum = sum && more_w ? Value(*sum + *more_w) : std::nullopt;
    }
    return sum;
  }
  int phases;
};

/// Sungrow SH: input registers 13000 running state (bit 1 charges, bit 2 discharges), 13021 power
/// without a sign, 13022 SoC in 0.1 %; holding registers 13049 mode, 13050 command, 13051 power.
struct SungrowSh : MakerTable {
  explicit SungrowSh(int ours) : mode(ours) {}
  Value soc_frac(const WireMemory& wire) const override {
    return times(of(wire.word(1, 13'022, Table::kInput)), 0.001);
  }
  Value power_w(const WireMemory& wire) const override {
    const auto state = wire.word(1, 13'000, Table::kInput);
    const Value size_w = of(wire.word(1, 13'021, Table::kInput));
    if (!state) return std::nullopt;
    return times(size_w, (*state & 2) != 0 ? 1 : (*state & 4) != 0 ? -1 : 0);
  }
  Value ordered_w(const WireMemory& wire) const override {
    const auto command = wire.word(1, 13'050);
    if (wire.word(1, 13'049) != mode || !command) return std::nullopt;
    if (*command == 0xCC) return 0;
    return times(of(wire.word(1, 13'051)), *command == 0xAA ? 1 : *command == 0xBB ? -1 : NAN);
  }
  int mode;
};

/// Huawei LUNA2000: 37760 SoC in 0.1 %, 37765 power, charge positive; 47100 charges at 47247 or
/// discharges at 47249.
struct HuaweiLuna : MakerTable {
  Value soc_frac(const WireMemory& wire) const override {
    return times(of(wire.word(1, 37'760)), 0.001);
  }
  Value power_w(const WireMemory& wire) const override { return wire.signed32(1, 37'765); }
  Value ordered_w(const WireMemory& wire) const override {
    const auto forcible = wire.word(1, 47'100);
    if (forcible == 1) return wire.unsigned32(1, 47'247);
    if (forcible == 2) return times(wire.unsigned32(1, 47'249), -1);
    return std::nullopt;
  }
};

/// SMA: 30845 SoC in %, input registers 31393 charging and 31395 discharging power. Either 40151
/// external control (802) and 40149 power, discharge positive; or 40236 mode, and 40795 and 40799
/// the most power in each direction.
struct Sma : MakerTable {
  explicit Sma(bool by_setpoint) : has_setpoint(by_setpoint) {}
  Value soc_frac(const WireMemory& wire) const override {
    return times(wire.unsigned32(3, 30'845), 0.01);
  }
  Value power_w(const WireMemory& wire) const override {
    return minus(wire.unsigned32(3, 31'393, Table::kInput),
                 wire.unsigned32(3, 31'395, Table::kInput));
  }
  Value ordered_w(const WireMemory& wire) const override {
    if (has_setpoint) {
      return wire.unsigned32(3, 40'151) == 802.0 ? times(wire.signed32(3, 40'149), -1)
                                                 : std::nullopt;
    }
    const Value mode = wire.unsigned32(3, 40'236);
    if (mode != 2'289.0 && mode != 2'290.0) return std::nullopt;
    return minus(wire.unsigned32(3, 40'795), wire.unsigned32(3, 40'799));
  }
  bool has_setpoint;
};

}  // namespace

const MakerTable* maker_table(std::string_view map, std::string_view variant) {
  static const AlphaEss alphaess;
  static const Simulator simulator;
  static const FroniusGen24 fronius;
  static const SunSpec124 sunspec_124;
  static const SunSpec704 sunspec_704;
  static const VictronEss3 single_phase(1), three_phase(3);
  static const SungrowSh external(3), forced(2);
  static const HuaweiLuna huawei;
  static const Sma setpoint(true), bms_mode(false);
  if (map == "alphaess") return &alphaess;
  if (map == "simulator") return &simulator;
  if (map == "fronius_gen24") return &fronius;
  if (map == "sunspec_124") return &sunspec_124;
  if (map == "sunspec_704") return &sunspec_704;
  if (map == "victron_ess3") return variant == "three_phase" ? &three_phase : &single_phase;
  if (map == "sungrow_sh") return variant == "forced" ? &forced : &external;
  if (map == "huawei_luna2000") return &huawei;
  if (map == "sma") return variant == "setpoint" ? &setpoint : &bms_mode;
  return nullptr;
}

}  // namespace bess
