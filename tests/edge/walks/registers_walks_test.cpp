// Walks over edge/registers: every shipped map with slips of the hand in it, and what a map that
// loads makes of orders and registers.
#include <sys/mman.h>
#include <unistd.h>

#include <fstream>

#include "edge/registers/codec.h"
#include "edge/registers/live_points.h"
#include "edge/registers/map_file.h"
#include "edge/registers/point_codec.h"
#include "edge/registers/point_places.h"
#include "tests/edge/walks/slips.h"
#include "tests/support/shipped_maps.h"
#include "tests/support/temporary_folder.h"

namespace bess {
namespace {

void see_condition(Walk& walk, const Condition& c) { walk.see(c.point, c.test, c.value); }

void see_conditions(Walk& walk, const auto& list) {
  walk.see(list.size());
  for (const Condition& c : list) see_condition(walk, c);
}

void see_cases(Walk& walk, const StaticVector<PowerCase, 4>& cases) {
  for (const PowerCase& c : cases) {
    see_condition(walk, c.when);
    for (const PowerCase::Term& term : c.terms) walk.see(term.point, term.sign);
  }
  walk.see(cases.size());
}

void see_point(Walk& walk, const RegisterPoint& p) {
  walk.see_text(p.name.view());
  walk.see(p.address, p.model, p.unit_group, p.registers, p.read_function, p.type, p.word_order,
           p.eeprom, p.optional, p.is_private, p.scale_from, p.percent_of, p.clamp_to, p.mask,
           p.scale, p.scale_divisor, p.offset, p.sign, p.step, p.max_age_s, p.value_min,
           p.value_max);
  for (const std::uint64_t raw : p.not_implemented) walk.see(raw);
}

void see_commands(Walk& walk, const RegisterMap& map) {
  for (const CommandSequence& sequence : map.command) {
    walk.see(sequence.writes.size());
    for (const BlockWrite& w : sequence.writes) {
      for (const WriteValue& v : w.values) {
        walk.see(v.point, v.argument, v.sign, v.divisor, v.constant);
      }
      walk.see(w.address, w.function, w.read_back, w.eeprom, w.tolerance);
    }
  }
}

void see_simulator(Walk& walk, const SimulatorHints& s) {
  see_conditions(walk, s.active);
  see_cases(walk, s.order_power);
  for (const auto& a : s.initial) walk.see(a.point, a.source, a.constant);
  for (const auto& a : s.at_expiry) walk.see(a.point, a.source, a.constant);
  for (const std::int8_t point : s.apply_on) walk.see(point);
}

void see_map(Walk& walk, const RegisterMap& m) {
  walk.see_text(m.name.view());
  walk.see_text(m.variant.view());
  walk.see(m.is_meter, m.unit, m.port, m.baud, m.parity, m.stop_bits, m.connect_delay_ms,
           m.minimum_gap_ms, m.response_timeout_ms, m.read_gap_registers_max,
           m.registers_per_read_max, m.charge_w_max, m.discharge_w_max);
  for (const UnitGroup& g : m.unit_groups) walk.see(g.unit, g.name.view().size());
  for (const std::uint16_t model : m.models) walk.see(model);
  for (const std::uint16_t base : m.model_bases) walk.see(base);
  walk.see(m.watchdog.kind, m.watchdog.duration_s, m.watchdog.refresh_s, m.watchdog.remaining,
           m.watchdog.expiry_visible, m.writes.eeprom_writes_per_day, m.writes.reserve);
  for (const std::uint8_t code : m.exceptions.retry) walk.see(code);
  for (const std::uint8_t code : m.exceptions.not_permitted) walk.see(code);
  const ResponseBand& band = m.response;
  walk.see(band.settle_s, band.tolerance_percent, band.tolerance_w, band.soc_step_e4,
           band.soc_refresh_s, band.charges_by_itself, m.commissioning.power_w,
           m.commissioning.duration_s, m.commissioning.settle_s, m.commissioning.tolerance_percent);
  for (const RegisterPoint& p : m.points) see_point(walk, p);
  for (const NamedValue& n : m.names) {
    walk.see(n.point, n.is_bit, n.value);
    walk.see_text(n.name.view());
  }
  for (const std::int8_t point : m.measure) walk.see(point);
  for (const std::int8_t point : m.required) walk.see(point);
  see_conditions(walk, m.active);
  see_conditions(walk, m.alarms);
  see_conditions(walk, m.warnings);
  see_conditions(walk, m.precondition);
  see_condition(walk, m.off_grid);
  walk.see(m.alive.point, m.alive.max_age_s);
  see_cases(walk, m.measured_power);
  see_cases(walk, m.order_power);
  see_cases(walk, m.grid_power);
  for (const IdentityCheck& i : m.identity) {
    walk.see(i.point, i.value_min, i.value_max, i.may_be_unknown);
    walk.see_text(i.text.view());
    walk.see_text(i.hint.view());
  }
  for (const SavedPoint& s : m.saved) walk.see(s.point, s.fallback);
  see_commands(walk, m);
  see_simulator(walk, m.simulator);
}

/// A file that lies on no disk: thousands are written and read.
class MemoryFile {
 public:
  MemoryFile() : fd_(memfd_create("walk", 0)), path_("/proc/self/fd/" + std::to_string(fd_)) {}
  ~MemoryFile() { close(fd_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  void write_lines(const std::vector<std::string>& lines) const {
    std::ofstream file(path_);
    for (const std::string& line : lines) file << line << "\n";
  }

 private:
  int fd_;
  std::string path_;
};

struct MapText {
  const char* file;
  const char* variant;
};
constexpr MapText kMapTexts[] = {{"maps/alphaess", "block"},
                                 {"maps/alphaess", "five_writes"},
                                 {"maps/simulator", ""},
                                 {"maps/sunspec_124", ""},
                                 {"maps/sunspec_704", ""},
                                 {"maps/fronius_gen24", ""},
                                 {"maps/victron_ess3", "single_phase"},
                                 {"maps/victron_ess3", "three_phase"},
                                 {"maps/sungrow_sh", "external_ems"},
                                 {"maps/sungrow_sh", "forced"},
                                 {"maps/huawei_luna2000", ""},
                                 {"maps/sma", "bms_mode"},
                                 {"maps/sma", "setpoint"},
                                 {"meters/eastron_sdm630", ""},
                                 {"meters/sunspec", ""},
                                 {"meters/victron_gx", ""},
                                 {"meters/simulator", ""},
                                 {"meters/p1_dongle_pro", ""},
                                 {"meters/fronius_smart_meter", ""}};

std::vector<std::string> lines_of(const std::string& path) {
  std::vector<std::string> lines;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    const std::size_t end = line.find_last_not_of(' ');
    if (end != std::string::npos && line[line.find_first_not_of(' ')] != '#') {
      lines.push_back(line.substr(0, end + 1));
    }
  }
  return lines;
}

/// A value of a line in another's place, or a number beyond what may stand there.
void exchange_value(Walk& walk, std::vector<std::string>& lines, std::size_t at) {
  static constexpr const char* kValues[] = {
      "0", "1", "-1", "2", "6", "16", "247", "248", "65535", "65536", "1000001", "-1000000",
      "5000000001", "4294967296", "\"\"", "\"s16\"", "\"u32\"", "\"f32\"", "\"text\"",
      "\"low_first\"", "\"eeprom\"", "\"none\"", "\"duration\"", "\"heartbeat\"", "\"rewrite\"",
      "\"power\"", "\"soc\"", "[]", "[\"soc = 1\"]", "[\"soc has 1\"]", "[\"soc\"]", "true",
      "false", "1.5", "{}", "0x10", "12", "24", "125", "\"nearest\"", "\"-power\"", "3600", "86401",
      "\"soc = soc_limit\"", "[[\"soc = 1\", \"soc = 2\"]]", "\"power = power/3\"",
      // in brackets: one text, no comma forgotten
      ("\"a text that is far too long for any name of a point "
       "or a unit or a hint, and longer still than that\"")};
  const std::size_t equals = lines[at].find('=');
  if (equals == std::string::npos) return;
  const std::size_t other = static_cast<std::size_t>(walk.from(0, std::ssize(lines) - 1));
  const std::size_t theirs = lines[other].find('=');
  const bool takes = walk.once_in(3) && theirs != std::string::npos;
  lines[at] = lines[at].substr(0, equals + 1) +
              (takes ? lines[other].substr(theirs + 1)
                     : std::string(" ") + kValues[walk.from(0, std::ssize(kValues) - 1)]);
}

void add_key(Walk& walk, std::vector<std::string>& lines, std::size_t at) {
  static constexpr const char* kKeys[] = {
      "eeprom_writes_per_day = 0",
      "optional = true",
      "sign = -1",
      "scale = 10",
      "scale = 0",
      "scale_divisor = 10",
      "scale_from = \"soc\"",
      "percent_of = \"soc\"",
      "clamp_to = \"soc\"",
      "mask = 255",
      "mask = 0",
      "offset = 5",
      "step = 5",
      "max_age_s = 5",
      "word_order = \"low_first\"",
      "type = \"u64\"",
      "type = \"s32\"",
      "type = \"text\"",
      "registers = 4",
      "registers = 17",
      "names = { a = 1, b = 2 }",
      "bits = { a = 1, b = 64 }",
      "not_implemented = 32768",
      "not_implemented = [1, 2, 3]",
      "storage = \"eeprom\"",
      "private = true",
      "unit = \"pv\"",
      "model = 124",
      "max = 0",
      "min = 5",
      "retry = [5, 6, 256]",
      "not_permitted = [1]",
      "connect_delay_ms = 1000",
      "gap_ms = 20",
      "read_function = 4",
      "unknown_key = 1",
      "hint = \"\"",
      "baud = 9601",
      "parity = \"odd\"",
      "stop_bits = 3",
      "settle_s = 0",
      "tolerance_percent = 101",
      "soc_refresh_s = 601",
      "charges_by_itself = true",
      "refresh_s = 0",
      "duration_s = 1",
      "remaining = \"soc\"",
      "expiry_visible = false",
      "reserve = 9",
      "max_age_s = 0",
      "off_grid = \"soc = 1\"",
      "alive = \"soc\"",
      "grid_power = \"soc\"",
      "[writes]",
      "[point]",
      "[[point]]",
      "[command]",
      "enable = [\"soc = 1\"]",
      "refresh = []",
      "charge = { write = \"soc = 1\", read_back = \"tolerance\", tolerance = 5 }",
      "saved = [\"soc\"]",
      "saved = { soc = 1 }",
      "precondition = [\"soc = 1\"]"};
  lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(at),
               kKeys[walk.from(0, std::ssize(kKeys) - 1)]);
}

void slip(Walk& walk, std::vector<std::string>& lines) {
  const auto at = static_cast<std::size_t>(walk.from(0, std::ssize(lines) - 1));
  switch (walk.from(0, 9)) {
    case 0:
      lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(at));
      break;
    case 1:
      lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(at), lines[at]);
      break;
    case 2:
      std::swap(lines[at], lines[static_cast<std::size_t>(walk.from(0, std::ssize(lines) - 1))]);
      break;
    case 3:
    case 4:
      lines[at] = with_slips(walk, lines[at], 2);
      break;
    case 5:
    case 6:
      add_key(walk, lines, at);
      break;
    default:
      exchange_value(walk, lines, at);
      break;
  }
}

void see_loaded(Walk& walk, const std::string& folder, const std::string& path,
                const char* variant) {
  RegisterMap map;
  std::string error;
  const bool is_loaded = load_register_map(path, variant, map, error);
  walk.see(is_loaded);
  for (std::size_t at; (at = error.find(folder)) != std::string::npos;)
    error.erase(at, folder.size());
  walk.see_text(error);
  if (!is_loaded) return;
  see_map(walk, map);
  walk.see(measure_grid_power(map), map.measure.size());
}

TEST(RegistersWalk, MapsWithSlips) {
  Walk walk("maps_with_slips");
  const MemoryFile map;
  for (const auto& [file, variant] : kMapTexts) {
    const std::vector<std::string> lines =
        lines_of(std::string(BESS_SOURCE_DIR) + "/edge/" + file + ".toml");
    for (int i = 0; i < 300; ++i) {
      std::vector<std::string> changed = lines;
      const int slips = i == 0 ? 0 : walk.number(1, 3);
      for (int s = 0; s < slips; ++s) slip(walk, changed);
      map.write_lines(changed);
      see_loaded(walk, map.path(), map.path(), walk.once_in(90) ? "none_such" : variant);
      if (i % 100 == 99) walk.end_line(std::string(file) + " " + variant + " " + std::to_string(i));
    }
  }
  walk.hold();
}

/// More of it than fits, and a list that is none.
std::vector<std::string> overfull_lines() {
  const auto many = [](const char* key, const char* item, int count) {
    std::string line = std::string(key) + " = [";
    for (int i = 0; i < count; ++i) line += std::string(i > 0 ? ", " : "") + item;
    return line + "]";
  };
  std::vector<std::string> lines;
  for (const char* key :
       {"measure", "alarms", "warnings", "active", "precondition", "charge", "idle", "enable",
        "refresh", "release", "save", "apply_on", "initial", "at_expiry", "read_points"}) {
    for (const int count : {1, 4, 5, 6, 7, 8, 9, 16, 17, 40, 41}) {
      lines.push_back(many(key, "\"soc = 1\"", count));
    }
    lines.push_back(many(key, "[\"soc = 1\", \"soc = 2\"]", 1));
    lines.push_back(many(key, "{ delay_ms = 10 }", 1));
    lines.push_back(many(key, "1", 1));
    lines.push_back(std::string(key) + " = \"soc\"");
    lines.push_back(std::string(key) + " = { soc = 1 }");
  }
  for (const char* key : {"measured_power", "order_power", "grid_power"}) {
    for (const int count : {1, 2, 4, 5}) {
      lines.push_back(many(key, "{ when = \"soc = 1\", power = \"soc\" }", count));
      lines.push_back(std::string(key) + " = [{ power = " + many("x", "\"soc\"", count).substr(4) +
                      " }]");
    }
    lines.push_back(std::string(key) + " = [{ power = \"-soc\" }]");
    lines.push_back(std::string(key) + " = \"-soc\"");
  }
  for (const char* key : {"not_implemented", "retry", "not_permitted", "models", "bases"}) {
    for (const int count : {0, 1, 3, 4, 5, 6, 7}) lines.push_back(many(key, "1", count));
    for (const char* item : {"0", "-1", "255", "256", "65535", "65536", "4294967296"}) {
      lines.push_back(many(key, item, 1));
    }
  }
  for (const char* key : {"bits", "names"}) {
    for (const char* value : {"0", "31", "32", "-1", "65535", "65536"}) {
      lines.push_back(std::string(key) + " = { a = " + value + " }");
    }
    std::string full = std::string(key) + " = {";
    for (int i = 0; i < 97; ++i) full += (i > 0 ? ", n" : " n") + std::to_string(i) + " = 1";
    lines.push_back(full + " }");
    lines.push_back(std::string(key) + " = { a_name_that_is_too_long_for_one = 1 }");
  }
  return lines;
}

/// Numbers at the ends of what keys may hold, in each line that holds one.
constexpr const char* kNumbers[] = {"-1",    "0",     "1",     "2",       "6",      "16",
                                    "17",    "24",    "31",    "32",      "100",    "101",
                                    "125",   "247",   "248",   "3600",    "3601",   "65535",
                                    "65536", "86400", "86401", "1000000", "1000001"};

std::vector<std::string> with_line(const std::vector<std::string>& lines, std::size_t at,
                                   const std::string& line, bool replaces) {
  std::vector<std::string> changed = lines;
  if (replaces) {
    changed[at] = line;
  } else {
    changed.insert(changed.begin() + static_cast<std::ptrdiff_t>(at) + 1, line);
  }
  return changed;
}

constexpr MapText kMapTextsOfEachKind[] = {{"maps/simulator", ""},
                                           {"maps/sungrow_sh", "external_ems"},
                                           {"maps/sunspec_704", ""},
                                           {"maps/victron_ess3", "three_phase"}};

TEST(RegistersWalk, EverySlipAlone) {
  Walk walk("every_slip_alone");
  const MemoryFile map;
  const auto see = [&](const std::vector<std::string>& lines, const char* variant) {
    map.write_lines(lines);
    see_loaded(walk, map.path(), map.path(), variant);
  };
  const std::vector<std::string> overfull = overfull_lines();
  for (const auto& [file, variant] : kMapTextsOfEachKind) {
    const std::vector<std::string> lines =
        lines_of(std::string(BESS_SOURCE_DIR) + "/edge/" + file + ".toml");
    for (std::size_t at = 0; at < lines.size(); ++at) {
      see(with_line(lines, at, "", true), variant);
      see(with_line(lines, at, lines[at], false), variant);
      const std::size_t equals = lines[at].find("= ");
      const bool is_number = equals != std::string::npos &&
                             lines[at].find_first_of("-0123456789", equals) == equals + 2;
      for (const char* number : kNumbers) {
        if (!is_number || (at * 7 + static_cast<std::size_t>(number[0])) % 3 != 0) continue;
        see(with_line(lines, at, lines[at].substr(0, equals + 2) + number, true), variant);
      }
    }
    walk.end_line(std::string(file) + " " + variant + " lines");
    for (const char* table : {"[state]", "[command]", "[[point]]", "[simulator]", "[sunspec]",
                              "[exceptions]", "[map]"}) {
      const auto at = std::find(lines.begin(), lines.end(), table);
      if (at == lines.end()) continue;
      for (const std::string& line : overfull) {
        std::vector<std::string> changed = lines;  // in place of what it says there, if it does
        const std::string key = line.substr(0, line.find('=') + 1);
        const auto place = at - lines.begin();
        for (auto i = place + 1; i < std::ssize(changed) && changed[i][0] != '['; ++i) {
          if (changed[i].starts_with(key)) changed.erase(changed.begin() + i);
        }
        see(with_line(changed, static_cast<std::size_t>(place), line, false), variant);
      }
      walk.end_line(std::string(file) + " " + variant + " " + table);
    }
  }
  walk.hold();
}

TEST(RegistersWalk, IncludedMaps) {
  Walk walk("included_maps");
  const TemporaryFolder folder;
  const std::string base = folder.file("base.toml");
  const std::vector<std::string> lines =
      lines_of(std::string(BESS_SOURCE_DIR) + "/edge/maps/simulator.toml");
  for (int i = 0; i < 400; ++i) {
    std::vector<std::string> changed = lines;
    if (walk.once_in(4)) changed.insert(changed.begin(), "include = \"base.toml\"");
    std::ofstream file(base);
    for (const std::string& line : changed) file << line << "\n";
    file.close();
    std::vector<std::string> upper = {"include = \"base.toml\"", "[map]", "unit = 7", "[power]",
                                      "charge_w_max = 100"};
    if (walk.once_in(2)) upper.insert(upper.end(), {"[[point]]", "name = \"soc\"", "scale = 7"});
    if (walk.once_in(2)) slip(walk, upper);
    if (walk.once_in(9)) upper[0] = "include = \"../base.toml\"";
    if (walk.once_in(9)) upper[0] = "include = \"none.toml\"";
    const std::string path = folder.file("upper.toml");
    std::ofstream out(path);
    for (const std::string& line : upper) out << line << "\n";
    out.close();
    const std::string place = path.substr(0, path.rfind('/') + 1);
    see_loaded(walk, place, path, "");
    if (i % 50 == 49) walk.end_line(i);
  }
  walk.hold();
}

RegisterPoint drawn_point(Walk& walk) {
  RegisterPoint p;
  p.type = static_cast<RegisterType>(walk.from(0, 6));
  p.word_order = static_cast<WordOrder>(walk.from(0, 1));
  constexpr std::uint8_t kRegisters[] = {1, 1, 2, 2, 4, 2, 4};
  p.registers = kRegisters[static_cast<int>(p.type)];
  if (walk.once_in(2)) p.scale = walk.number(1, 100);
  if (walk.once_in(2)) p.scale_divisor = walk.number(1, 100);
  if (walk.once_in(3)) p.offset = walk.number(-500, 500);
  if (walk.once_in(3)) p.sign = -1;
  if (walk.once_in(4)) p.step = walk.number(1, 50);
  if (walk.once_in(6)) p.mask = static_cast<std::uint64_t>(walk.one_of({0xFF, 0xF0, 0xFF00, 1}));
  if (walk.once_in(5)) p.scale_from = 0;
  if (walk.once_in(6)) p.percent_of = 0;
  p.value_min = walk.one_of({-40'000, -32'768, 0, -5'000'000'000, INT64_MIN});
  p.value_max = walk.one_of({100, 65'535, 5'000'000'000, INT64_MAX});
  if (walk.once_in(4)) p.not_implemented.push_back(0x8000);
  if (walk.once_in(8)) p.not_implemented.push_back(0xFFFF'FFFF);
  return p;
}

TEST(RegistersWalk, Points) {
  Walk walk("points");
  for (int block = 0; block < 30; ++block) {
    for (int i = 0; i < 3'000; ++i) {
      const RegisterPoint p = drawn_point(walk);
      const Scaling scaling{.exponent = walk.edge({0, 0, 3, -3, 10, -10, 11}, 1),
                            .rating = walk.edge({0, 4'000, -5})};
      std::uint16_t raw[kTextRegistersMax] = {};
      for (std::uint16_t& r : raw) {
        r = static_cast<std::uint16_t>(walk.once_in(2)
                                           ? walk.edge({0, 0x7FFF, 0x8000, 0xFFFF, 0x9999, 0x4120})
                                           : walk.from(0, 0xFFFF));
      }
      if (p.type == RegisterType::kText) {
        for (int r = 0; r < 4; ++r) raw[r] = walk.once_in(4) ? 0x2000 : 0x4120;
        walk.see_text(decode_text(p, raw).view());
        continue;
      }
      std::int64_t value = 0;
      const bool is_decoded = decode(p, raw, value, scaling);
      walk.see(is_not_implemented(p, raw), is_decoded, is_decoded ? value : 0);
      const std::int64_t wanted = is_decoded && walk.once_in(2)
                                      ? value + walk.from(-1, 1)
                                      : walk.one_of({0,
                                                     1,
                                                     -1,
                                                     100,
                                                     4'000,
                                                     -4'000,
                                                     32'767,
                                                     32'768,
                                                     -32'768,
                                                     -32'769,
                                                     65'535,
                                                     65'536,
                                                     9'999,
                                                     10'000,
                                                     INT32_MAX,
                                                     std::int64_t{1} << 31,
                                                     INT64_MAX - 1,
                                                     4'294'967'296,
                                                     7,
                                                     55});
      RegisterBlock out;
      if (walk.once_in(9)) {
        for (int full = 0; full < kBlockRegistersMax - 1; ++full) out.push_back(0);
      }
      walk.see(encode(p, wanted, static_cast<Rounding>(walk.from(0, 2)), out, scaling), out.size());
      for (const std::uint16_t r : out) walk.see(r);
    }
    walk.end_line(block);
  }
  walk.hold();
}

void keep_drawn(Walk& walk, const RegisterMap& map, LivePoints& live) {
  for (int point = 0; point < map.points.size(); ++point) {
    if (walk.once_in(3)) continue;
    const RegisterPoint& p = map.points[point];
    RegisterBlock block;
    const std::int64_t value =
        walk.one_of({p.value_min, p.value_max, 0, 1, 100, 4'000, (p.value_min + p.value_max) / 2});
    if (encode(p, value, Rounding::kNearest, block) == Status::kOk && !walk.once_in(9)) {
      live.keep(map, point, block.data());
    } else {
      std::uint16_t raw[kPointRegistersMax];
      for (std::uint16_t& r : raw) r = static_cast<std::uint16_t>(walk.one_of({0, 0xFFFF, 0x8000}));
      live.keep(map, point, raw);
    }
  }
}

TEST(RegistersWalk, Orders) {
  Walk walk("orders");
  for (const MapVariant& wanted : kShippedMapVariants) {
    const RegisterMap map = load_shipped_map(wanted);
    for (int i = 0; i < 300; ++i) {
      LivePoints live = assumed_live_points(map, walk.once_in(2));
      LivePoints saved;
      keep_drawn(walk, map, live);
      keep_drawn(walk, map, saved);
      if (walk.once_in(30)) live.forget();
      const PowerOrder order{
          .power_w = walk.edge({0, 1'000, -1'000, 4'000, -4'000, map.charge_w_max,
                                -std::int64_t{map.discharge_w_max}}),
          .soc_min_e4 = walk.edge({0, 1'000, 1'049}),
          .soc_max_e4 = walk.edge({9'000, 9'951}),
          .duration_s = walk.edge({60, 240, 300})};
      walk.see(check_expressible(map, order));
      const WriteContext context{.live = walk.once_in(4) ? nullptr : &live,
                                 .clamp = !walk.once_in(4),
                                 .saved = walk.once_in(2) ? &saved : nullptr,
                                 .heartbeat = walk.from(0, 70'000)};
      for (const CommandSequence& sequence : map.command) {
        for (const BlockWrite& write : sequence.writes) {
          RegisterBlock block;
          walk.see(encode_block(map, write, order, block, context), block.size());
          for (const std::uint16_t r : block) walk.see(r);
        }
      }
      std::int64_t power_w = 0;
      for (const auto* cases : {&map.measured_power, &map.order_power, &map.grid_power}) {
        const bool is_known = live_power(map, *cases, live, power_w);
        walk.see(is_known, is_known ? power_w : 0);
      }
      walk.see(live_all(map, map.active, live), live_all(map, map.precondition, live));
    }
    walk.end_line(std::string(wanted.map) + " " + wanted.variant);
  }
  walk.hold();
}

TEST(RegistersWalk, OverheardPlaces) {
  Walk walk("overheard_places");
  for (const MapVariant& wanted : kShippedMapVariants) {
    const RegisterMap map = load_shipped_map(wanted);
    PointPlaces places(map, walk.once_in(2) ? -1 : 3);
    std::int64_t next = 40'000;
    for (int i = 0; i < 1'200; ++i) {
      BusExchange exchange;
      exchange.unit = walk.once_in(9) ? walk.number(0, 4) : walk.once_in(2) ? map.unit : 3;
      exchange.function = static_cast<std::uint8_t>(walk.one_of({3, 3, 3, 4, 6, 16}));
      exchange.outcome = walk.once_in(20) ? BusOutcome::kTimeout : BusOutcome::kAnswered;
      exchange.count = static_cast<std::uint16_t>(walk.once_in(2) ? 2 : walk.from(1, 60));
      const RegisterPoint& aimed =
          map.points[static_cast<int>(walk.from(0, map.points.size() - 1))];
      exchange.address = static_cast<std::uint16_t>(aimed.address + walk.edge({0, -2, 2, -20}));
      if (!map.models.empty() && walk.once_in(2)) {
        if (walk.once_in(9)) {
          exchange.address = map.model_bases[0];
          exchange.registers[0] = 0x5375;
          exchange.registers[1] = static_cast<std::uint16_t>(walk.once_in(9) ? 0 : 0x6E53);
          next = exchange.address + 2;
        } else {
          const int model = static_cast<int>(walk.from(0, map.models.size() - 1));
          exchange.address = static_cast<std::uint16_t>(next);
          exchange.registers[0] = walk.once_in(30) ? 0xFFFF : map.models[model];
          exchange.registers[1] = static_cast<std::uint16_t>(walk.from(0, 40));
          next += 2 + exchange.registers[1];
          if (next > 60'000) next = 40'000;
        }
      }
      places.follow(exchange);
      walk.see(places.is_model_head());
      for (int point = 0; point < map.points.size(); ++point) {
        walk.see(places.is_placed(point));
        if (places.is_placed(point)) walk.see(places.offset_in(exchange, point));
      }
    }
    walk.end_line(std::string(wanted.map) + " " + wanted.variant);
  }
  walk.hold();
}

}  // namespace
}  // namespace bess
