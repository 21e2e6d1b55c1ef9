// Journal lines of a control cycle: "... cycle=3 mode=running ordered_power_w=-4000 ...".
#pragma once

#include <cstdlib>
#include <map>
#include <sstream>
#include <string>

#include "tests/support/utc_of.h"

namespace bess {

inline bool is_cycle_line(const std::string& line) {
  return line.find(" cycle=") != std::string::npos;
}

/// Values by their names; words without "=" are left out.
inline std::map<std::string, std::string> journal_fields(const std::string& line) {
  std::map<std::string, std::string> fields;
  std::istringstream words(line);
  for (std::string word; words >> word;) {
    const std::size_t at = word.find('=');
    if (at != std::string::npos) fields[word.substr(0, at)] = word.substr(at + 1);
  }
  return fields;
}

struct JournalCycle {
  std::int64_t utc_s = 0;
  std::string mode, reason, prices;
  double ordered_w = 0, measured_w = 0;
  bool written = false;
  /// Whether or not the device accepted it.
  [[nodiscard]] bool wants() const { return mode == "running" && ordered_w != 0; }
  [[nodiscard]] bool drives() const { return wants() && written; }
};

inline JournalCycle journal_cycle(const std::string& line) {
  std::map<std::string, std::string> value = journal_fields(line);
  return {.utc_s = utc_of(value["utc"]),
          .mode = value["mode"],
          .reason = value["reason"],
          .prices = value["prices"],
          .ordered_w = std::atof(value["ordered_power_w"].c_str()),
          .measured_w = std::atof(value["battery_power_w"].c_str()),
          .written = value["written"] == "1"};
}

}  // namespace bess
