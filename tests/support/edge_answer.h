// What bess-edge answers to one command line, once it has ended, and what it says as it runs.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "shared/host/json.h"
#include "shared/local_text.h"
#include "shared/utc_text.h"
#include "tests/support/programs_under_test.h"
#include "tests/support/said.h"
#include "tests/support/simulated_site.h"

namespace bess {

/// bess-edge's. `arguments`: without the program.
inline Said edge(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), edge_program());
  return answer_of(std::move(arguments));
}

/// `status --json`; does not exist where that is no JSON.
inline Json status_of(const std::string& config) {
  return Json::parse(edge({"status", "--json", "--config", config}).text);
}

/// The next line of output with this piece; empty when the program ended before.
inline std::string await_line(ChildProcess& child, const std::string& piece) {
  std::string line = child.read_line();
  while (!line.empty() && line.find(piece) == std::string::npos) line = child.read_line();
  return line;
}

/// A simulated site, and the configuration with which bess-edge drives it.
class SiteTest : public ::testing::Test {
 protected:
  explicit SiteTest(std::int32_t time_scale) : site_(time_scale) {}

  /// Both simulators, and the sign check.
  void start_site(int minutes = 150) {
    site_.start_both(minutes);
    config_ = site_.commission();
  }
  /// bess-edge's answer, by that configuration.
  [[nodiscard]] Said ask(std::vector<std::string> words) const {
    return edge(joined(std::move(words), {"--config", config_}));
  }
  /// A controller that runs by it.
  [[nodiscard]] ChildProcess controller(const std::vector<std::string>& options = {}) const {
    return ChildProcess(joined({edge_program(), "--config", config_}, options));
  }
  [[nodiscard]] std::vector<CsvRow> edge_log() const {
    return read_csv(site_.folder.file("edge.csv"));
  }
  [[nodiscard]] std::vector<CsvRow> battery_record() const {
    return read_csv(site_.folder.file("battery.csv"));
  }

  SimulatedSite site_;
  std::string config_;
};

/// A moment as `status` and `why` show it to a person.
inline std::string local_text_of(const std::string& utc) {
  std::int64_t utc_s = 0;
  parse_utc(utc, utc_s);
  set_market_time_zone();
  return local_text(utc_s).c_str();
}

}  // namespace bess
