// Output of one bess-edge command after it has ended, and of a running bess-edge.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "shared/host/json.h"
#include "shared/local_time.h"
#include "shared/utc_text.h"
#include "tests/support/program_output.h"
#include "tests/support/programs_under_test.h"
#include "tests/support/simulated_site.h"

namespace bess {

/// Runs bess-edge. `arguments`: without the program.
inline ProgramOutput edge(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), edge_program());
  return answer_of(std::move(arguments));
}

/// `status --json`; absent if it is no JSON.
inline Json status_of(const std::string& config) {
  return Json::parse(edge({"status", "--json", "--config", config}).text);
}

/// The next line of output that contains this piece; empty if the program ended before.
inline std::string await_line(ChildProcess& child, const std::string& piece) {
  std::string line = child.read_line();
  while (!line.empty() && line.find(piece) == std::string::npos) line = child.read_line();
  return line;
}

/// A simulated site, and its configuration of bess-edge.
class SiteTest : public ::testing::Test {
 protected:
  explicit SiteTest(std::int32_t time_scale) : site_(time_scale) {}

  /// Both simulators, and the sign check.
  void start_site(int minutes = 150) {
    site_.start_both(minutes);
    config_ = site_.commission();
  }
  /// Output of bess-edge with that configuration.
  [[nodiscard]] ProgramOutput ask(std::vector<std::string> words) const {
    return edge(joined(std::move(words), {"--config", config_}));
  }
  /// A controller with that configuration.
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

/// A moment as `status` and `why` show it.
inline std::string local_text_of(const std::string& utc) {
  std::int64_t utc_s = 0;
  parse_utc(utc, utc_s);
  set_market_time_zone();
  return local_text(utc_s).c_str();
}

}  // namespace bess
