#include "tools/hil_runner/witness/manufacturer_table.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>

namespace bess {

namespace {

constexpr std::uint8_t kReadHolding = 3;
constexpr std::uint8_t kReadInput = 4;
constexpr std::uint8_t kWriteOne = 6;
constexpr std::uint8_t kWriteMany = 16;

int word_at(WireMemory::Frame bytes, std::size_t at) { return bytes[at] * 256 + bytes[at + 1]; }

}  // namespace

bool WireMemory::exchanged(Frame request, Frame answer) {
  if (request.size() < 6 || answer.size() < 3 || answer[1] != request[1]) return false;
  const int unit = request[0];
  const int address = word_at(request, 2);
  switch (request[1]) {
    case kReadHolding:
    case kReadInput: {
      const auto table = request[1] == kReadInput ? Table::kInput : Table::kHolding;
      if (answer.size() < 3U + answer[2]) return false;
      keep(unit, table, address, answer.subspan(3, answer[2]));
      return true;
    }
    case kWriteOne:
      keep(unit, Table::kHolding, address, request.subspan(4, 2));
      return true;
    case kWriteMany:
      if (request.size() < 7U + request[6]) return false;
      keep(unit, Table::kHolding, address, request.subspan(7, request[6]));
      return true;
    default:
      return false;
  }
}

void WireMemory::keep(int unit, Table table, int address, Frame words) {
  for (std::size_t i = 0; i + 1 < words.size(); i += 2) {
    words_[{unit, table, address++}] = static_cast<std::uint16_t>(word_at(words, i));
  }
}

std::optional<std::uint16_t> WireMemory::word(int unit, int address, Table table) const {
  const auto found = words_.find({unit, table, address});
  if (found == words_.end()) return std::nullopt;
  return found->second;
}

std::optional<double> WireMemory::signed16(int unit, int address, Table table) const {
  const auto value = word(unit, address, table);
  if (!value) return std::nullopt;
  return *value < 0x8000 ? *value : *value - 0x1'0000;
}

std::optional<double> WireMemory::unsigned32(int unit, int address, Table table) const {
  const auto high = word(unit, address, table);
  const auto low = word(unit, address + 1, table);
  if (!high || !low) return std::nullopt;
  return 65'536.0 * *high + *low;
}

std::optional<double> WireMemory::signed32(int unit, int address, Table table) const {
  const auto value = unsigned32(unit, address, table);
  if (!value) return std::nullopt;
  return *value < 2'147'483'648.0 ? *value : *value - 4'294'967'296.0;
}

namespace {

using Wire = const WireMemory&;
using Value = ManufacturerTable::Value;

Value times(const Value& value, double factor) {
  return value ? Value(*value * factor) : std::nullopt;
}

/// 32 bits in two registers, the low word first.
std::optional<std::uint32_t> low_first(Wire wire, int unit, int address,
                                       Table table = Table::kHolding) {
  const auto low = wire.word(unit, address, table);
  const auto high = wire.word(unit, address + 1, table);
  if (!low || !high) return std::nullopt;
  return static_cast<std::uint32_t>(*high) << 16 | *low;
}

Value low_first_signed(Wire wire, int unit, int address, Table table) {
  const auto bits = low_first(wire, unit, address, table);
  return bits ? Value(static_cast<std::int32_t>(*bits)) : std::nullopt;
}

Value low_first_float(Wire wire, int unit, int address) {
  const auto bits = low_first(wire, unit, address);
  return bits ? Value(std::bit_cast<float>(*bits)) : std::nullopt;
}

Value minus(const Value& a, const Value& b) { return a && b ? Value(*a - *b) : std::nullopt; }

/// AlphaESS, manual V1.23: 0x0102 SoC in 0.1 %; 0x0126 power, discharge positive; dispatch at
/// 0x0880: start, then 32000 + W in two registers, below 32000 charge.
struct AlphaEss {
  static constexpr int kUnit = 85;
  static Value soc_frac(Wire wire) { return times(wire.word(kUnit, 0x0102), 0.001); }
  static Value power_w(Wire wire) { return times(wire.signed16(kUnit, 0x0126), -1); }
  static Value ordered_w(Wire wire) {
    if (wire.word(kUnit, 0x0880) != 1) return std::nullopt;
    return minus(32'000, wire.unsigned32(kUnit, 0x0881));
  }
};

/// bess-sim: 10 SoC in 0.01 %, 11 power, 100 on, 101 ordered power, charge positive.
struct Simulator {
  static Value soc_frac(Wire wire) { return times(wire.word(1, 10), 0.0001); }
  static Value power_w(Wire wire) { return wire.signed32(1, 11); }
  static Value ordered_w(Wire wire) {
    return wire.word(1, 100) == 1 ? wire.signed32(1, 101) : std::nullopt;
  }
};

/// SunSpec 124, by offsets from the model's id: 2 WChaMax, 5 StorCtl_Mod (1: limit of charging, 2:
/// of discharging, 3: both), 8 ChaState, 12 OutWRte and 13 InWRte in the percent of WChaMax. A
/// negative limit of one direction orders the other.
Value storage_order_w(Wire wire, int model) {
  constexpr double kWhole = 10'000;  // scale -2 in both devices
  const auto mode = wire.word(1, model + 5);
  if (!mode || *mode == 0) return std::nullopt;
  const Value rating_w = wire.word(1, model + 2);
  const bool limits_discharging = *mode == 2;
  const Value rate = wire.signed16(1, model + (limits_discharging ? 12 : 13));
  if (!rate || !rating_w) return std::nullopt;
  return *rating_w * *rate / kWhole * (limits_discharging ? -1 : 1);
}

/// Fronius GEN24 with integers: model 124 at 40343, SoC in 0.01 %; 40314 power that charges, 40334
/// that discharges.
struct FroniusGen24 {
  static Value soc_frac(Wire wire) { return times(wire.word(1, 40'351), 0.0001); }
  static Value power_w(Wire wire) { return minus(wire.word(1, 40'314), wire.word(1, 40'334)); }
  static Value ordered_w(Wire wire) { return storage_order_w(wire, 40'343); }
};

constexpr int kNowhere = -0x1'0000;  ///< of a model that is missing: no register is near

/// Address of a model in the chain that was read: "SunS" at 40000, then id and length of each.
int find_model(Wire wire, int id) {
  if (wire.word(1, 40'000) != 0x5375 || wire.word(1, 40'001) != 0x6E53) return kNowhere;
  for (int at = 40'002;;) {
    const auto found = wire.word(1, at);
    const auto length = wire.word(1, at + 1);
    if (!found || !length || *found == 0xFFFF) return kNowhere;
    if (*found == id) return at;
    at += 2 + *length;
  }
}

/// Value with a decimal exponent in another register.
Value scaled(const Value& value, const Value& exponent) {
  return value && exponent ? Value(*value * std::pow(10, *exponent)) : std::nullopt;
}

/// SunSpec 103 and 124: 103 +14 AC power and +15 its exponent, discharge positive; 124 +22 is the
/// SoC's exponent.
struct SunSpec124 {
  static Value soc_frac(Wire wire) {
    const int at = find_model(wire, 124);
    return times(scaled(wire.word(1, at + 8), wire.signed16(1, at + 22)), 0.01);
  }
  static Value power_w(Wire wire) {
    const int at = find_model(wire, 103);
    return times(scaled(wire.signed16(1, at + 14), wire.signed16(1, at + 15)), -1);
  }
  static Value ordered_w(Wire wire) { return storage_order_w(wire, find_model(wire, 124)); }
};

/// SunSpec 704 and 802: 704 +22 on, +24 W in two registers, discharge positive, +55 its exponent;
/// 802 +11 SoC, its exponent at +56, +47 power, its exponent at +63.
struct SunSpec704 {
  static Value soc_frac(Wire wire) {
    const int at = find_model(wire, 802);
    return times(scaled(wire.word(1, at + 11), wire.signed16(1, at + 56)), 0.01);
  }
  static Value power_w(Wire wire) {
    const int at = find_model(wire, 802);
    return times(scaled(wire.signed16(1, at + 47), wire.signed16(1, at + 63)), -1);
  }
  static Value ordered_w(Wire wire) {
    const int at = find_model(wire, 704);
    if (wire.word(1, at + 22) != 1) return std::nullopt;
    return times(scaled(wire.signed32(1, at + 24), wire.signed16(1, at + 55)), -1);
  }
};

/// Victron GX, CCGX register list: unit 100, 842 power, 843 SoC in %, 2902 ESS mode, 3 while ours;
/// unit 228, 37, 40 and 41 set point of the AC input of each phase, charge positive; 23 to 25
/// AC output to loads, in 10 W.
template <int kPhases>
struct VictronEss3 {
  static Value soc_frac(Wire wire) { return times(wire.word(100, 843), 0.01); }
  static Value power_w(Wire wire) { return wire.signed16(100, 842); }
  static Value ordered_w(Wire wire) {
    if (wire.word(100, 2902) != 3) return std::nullopt;
    Value sum = 0;
    for (int phase = 0; phase < kPhases; ++phase) {
      const Value input_w = wire.signed16(228, phase == 0 ? 37 : 39 + phase);
      const Value battery_w = minus(input_w, times(wire.signed16(228, 23 + phase), 10));
      sum = sum && battery_w ? Value(*sum + *battery_w) : std::nullopt;
    }
    return sum;
  }
};

/// Sungrow SH: input registers 5213 power in two registers, discharge positive, 13022 SoC in 0.1 %;
/// holding registers 13049 mode, 13050 command, 13051 power.
template <int kMode>
struct SungrowSh {
  static Value soc_frac(Wire wire) { return times(wire.word(1, 13'022, Table::kInput), 0.001); }
  static Value power_w(Wire wire) {
    return times(low_first_signed(wire, 1, 5'213, Table::kInput), -1);
  }
  static Value ordered_w(Wire wire) {
    const auto command = wire.word(1, 13'050);
    if (wire.word(1, 13'049) != kMode || !command) return std::nullopt;
    if (*command == 0xCC) return 0;
    return times(wire.word(1, 13'051), *command == 0xAA ? 1 : *command == 0xBB ? -1 : NAN);
  }
};

/// Huawei LUNA2000: 37760 SoC in 0.1 %, 37765 power, charge positive; 47100 charges at 47247 or
/// discharges at 47249.
struct HuaweiLuna {
  static Value soc_frac(Wire wire) { return times(wire.word(1, 37'760), 0.001); }
  static Value power_w(Wire wire) { return wire.signed32(1, 37'765); }
  static Value ordered_w(Wire wire) {
    const auto forcible = wire.word(1, 47'100);
    if (forcible == 1) return wire.unsigned32(1, 47'247);
    if (forcible == 2) return times(wire.unsigned32(1, 47'249), -1);
    return std::nullopt;
  }
};

/// SMA: 30845 SoC in %, input registers 31393 charging and 31395 discharging power. Either 40151
/// external control (802) and 40149 power, discharge positive; or 40236 mode, and 40795 and 40799
/// the most power in each direction.
template <bool kHasSetpoint>
struct Sma {
  static Value soc_frac(Wire wire) { return times(wire.unsigned32(3, 30'845), 0.01); }
  static Value power_w(Wire wire) {
    return minus(wire.unsigned32(3, 31'393, Table::kInput),
                 wire.unsigned32(3, 31'395, Table::kInput));
  }
  static Value ordered_w(Wire wire) {
    if (kHasSetpoint) {
      return wire.unsigned32(3, 40'151) == 802.0 ? times(wire.signed32(3, 40'149), -1)
                                                 : std::nullopt;
    }
    const Value mode = wire.unsigned32(3, 40'236);
    if (mode != 2'289.0 && mode != 2'290.0) return std::nullopt;
    return minus(wire.unsigned32(3, 40'795), wire.unsigned32(3, 40'799));
  }
};

/// SolarEdge, low word first: 57732 SoC in %, 57716 power, charge positive; 57348 control, 4 while
/// ours; 57357 mode: 3 charges at 57358, 4 discharges at 57360.
struct SolarEdge {
  static Value soc_frac(Wire wire) { return times(low_first_float(wire, 1, 57'732), 0.01); }
  static Value power_w(Wire wire) { return low_first_float(wire, 1, 57'716); }
  static Value ordered_w(Wire wire) {
    const auto mode = wire.word(1, 57'357);
    if (wire.word(1, 57'348) != 4 || !mode || *mode == 7) return std::nullopt;
    if (*mode == 3) return low_first_float(wire, 1, 57'358);
    return *mode == 4 ? times(low_first_float(wire, 1, 57'360), -1) : Value(0);
  }
};

/// GoodWe ET: 37007 SoC in %, 35182 power, discharge positive; mode at 47511 or 42000: 11 charges,
/// 12 discharges, 8 rests; its power in the register behind it, or in two.
template <int kModeAt, bool kHasTwoRegisters>
struct GoodWe {
  static constexpr int kUnit = 247;
  static Value soc_frac(Wire wire) { return times(wire.word(kUnit, 37'007), 0.01); }
  static Value power_w(Wire wire) { return times(wire.signed32(kUnit, 35'182), -1); }
  static Value ordered_w(Wire wire) {
    const auto mode = wire.word(kUnit, kModeAt);
    if (!mode || *mode == 1) return std::nullopt;
    const Value power_w = kHasTwoRegisters ? wire.unsigned32(kUnit, kModeAt + 1)
                                           : Value(wire.word(kUnit, kModeAt + 1));
    return times(power_w, *mode == 11 ? 1 : *mode == 12 ? -1 : 0);
  }
};

/// Kostal Plenticore: 514 SoC in %, 582 power and 1034 set-point (low word first), discharge
/// positive; a set-point of 0 W looks like none.
struct Kostal {
  static constexpr int kUnit = 71;
  static Value soc_frac(Wire wire) { return times(wire.word(kUnit, 514), 0.01); }
  static Value power_w(Wire wire) { return times(wire.signed16(kUnit, 582), -1); }
  static Value ordered_w(Wire wire) {
    const Value set_w = low_first_float(wire, kUnit, 1'034);
    return set_w == 0 ? std::nullopt : times(set_w, -1);
  }
};

/// Marstek Venus: 42000 control, 0x55AA while ours; 42010: 1 charges at 42020, 2 discharges at
/// 42021. Third generation 34002 SoC in 0.1 %, 30006 power; before, 32104 in %, 32202 in two
/// registers; discharge positive.
template <bool kThirdGeneration>
struct Marstek {
  static Value soc_frac(Wire wire) {
    return kThirdGeneration ? times(wire.word(1, 34'002), 0.001)
                            : times(wire.word(1, 32'104), 0.01);
  }
  static Value power_w(Wire wire) {
    return times(kThirdGeneration ? wire.signed16(1, 30'006) : wire.signed32(1, 32'202), -1);
  }
  static Value ordered_w(Wire wire) {
    const auto force = wire.word(1, 42'010);
    if (wire.word(1, 42'000) != 0x55AA || !force) return std::nullopt;
    if (*force == 1) return wire.word(1, 42'020);
    return *force == 2 ? times(wire.word(1, 42'021), -1) : Value(0);
  }
};

template <typename Device>
constexpr ManufacturerTable table_of(std::string_view map, std::string_view variant = "") {
  return {map, variant, Device::soc_frac, Device::power_w, Device::ordered_w};
}

/// A row without a variant is for all others of its map.
constexpr ManufacturerTable kTables[] = {
    table_of<AlphaEss>("alphaess"),
    table_of<Simulator>("simulator"),
    table_of<FroniusGen24>("fronius_gen24"),
    table_of<SunSpec124>("sunspec_124"),
    table_of<SunSpec704>("sunspec_704"),
    table_of<VictronEss3<3>>("victron_ess3", "three_phase"),
    table_of<VictronEss3<1>>("victron_ess3"),
    table_of<SungrowSh<2>>("sungrow_sh", "forced"),
    table_of<SungrowSh<3>>("sungrow_sh"),
    table_of<HuaweiLuna>("huawei_luna2000"),
    table_of<Sma<false>>("sma", "bms_mode"),
    table_of<Sma<true>>("sma"),
    table_of<SolarEdge>("solaredge"),
    table_of<GoodWe<42'000, true>>("goodwe_et", "registers_42000"),
    table_of<GoodWe<47'511, false>>("goodwe_et"),
    table_of<Kostal>("kostal_plenticore"),
    table_of<Marstek<false>>("marstek_venus", "gen_1_2"),
    table_of<Marstek<true>>("marstek_venus")};

}  // namespace

const ManufacturerTable* manufacturer_table(std::string_view map, std::string_view variant) {
  const auto* const found = std::ranges::find_if(kTables, [&](const ManufacturerTable& table) {
    return table.map == map && (table.variant.empty() || table.variant == variant);
  });
  return found == std::end(kTables) ? nullptr : found;
}

}  // namespace bess
