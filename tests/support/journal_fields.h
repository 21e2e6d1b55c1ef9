// Lines of bess-edge about a cycle: "... cycle=3 mode=running ordered_power_w=-4000 ...".
#pragma once

#include <map>
#include <sstream>
#include <string>

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

}  // namespace bess
