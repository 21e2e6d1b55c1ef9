// Published status: valid JSON for `bess-edge status`, and a Prometheus text that follows the rules
// of the exposition format and of its naming.
#include "edge/records/log/run_status.h"

#include <gmock/gmock.h>

#include <map>
#include <random>
#include <regex>
#include <set>
#include <sstream>

#include "edge/records/log/atomic_file.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/edge/records/log/sample_records.h"

namespace bess {
namespace {

CycleRecord good_record() {
  CycleRecord r;
  r.utc_s = 1'679'788'920;
  r.cycle = 1;
  r.mode = Mode::kRunning;
  r.has_measurement = true;
  r.measurement.soc_e4 = 5'555;
  r.measurement.power_w = -3'990;
  r.price = {.has_row = true, .price_centi_eur_per_mwh = -12'345, .status = Status::kOk};
  r.price_age_s = 60;
  r.reason = Reason::kStudent;
  r.battery_status = Status::kOk;
  r.ordered_power_w = -4'000;
  r.written = true;
  r.decision_us = 5;
  r.write_us = 400'000;
  r.counters.requests = 10;
  r.counters.failed_requests = 3;
  return r;
}

RunTotals totals_after(std::initializer_list<CycleRecord> records) {
  RunTotals totals;
  for (const CycleRecord& record : records) totals.count(record);
  return totals;
}

std::string prometheus_text(const RunTotals& totals) {
  char storage[kMetricsBytes];
  TextBuffer text(storage);
  format_prometheus({.identity = sample_identity(), .totals = totals}, text);
  EXPECT_FALSE(text.was_cut());
  return std::string(text.view());
}

struct Family {
  std::string type;
  std::map<std::string, double> samples;  ///< by labels
};

/// Strict parser, by the rules of promtool.
std::map<std::string, Family> parse_prometheus(const std::string& text) {
  std::map<std::string, Family> families;
  EXPECT_TRUE(text.ends_with('\n'));
  static const std::regex help("# HELP ([a-z_:][a-z0-9_:]*) (.+)");
  static const std::regex type("# TYPE ([a-z_:][a-z0-9_:]*) (counter|gauge)");
  static const std::regex sample(
      R"(([a-z_:][a-z0-9_:]*)(\{([a-z_]+="[^"\\]*")(,[a-z_]+="[^"\\]*")*\})? (-?[0-9.e+-]+))");
  std::string current;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::smatch m;
    if (std::regex_match(line, m, help)) {
      current = m[1];
      EXPECT_FALSE(families.contains(current)) << "second HELP: " << line;
      EXPECT_TRUE(line.ends_with('.')) << line;
    } else if (std::regex_match(line, m, type)) {
      EXPECT_EQ(m[1], current) << "TYPE follows its HELP";
      families[current].type = m[2];
    } else if (std::regex_match(line, m, sample)) {
      EXPECT_EQ(m[1], current) << "samples of a family stay together";
      EXPECT_TRUE(families[current].samples.emplace(m[2], std::stod(m[5])).second) << line;
    } else if (line.starts_with("# crc32=")) {  // to Prometheus a comment
      EXPECT_TRUE(lines.peek() == EOF) << "the last line";
    } else {
      ADD_FAILURE() << "not exposition format: " << line;
    }
  }
  return families;
}

/// Any damaged byte, a file of another build, and a truncated one.
TEST(StoredStatus, IsReadWholeOrNotAtAll) {
  const TemporaryFolder folder;
  const std::string path = folder.file("status.bin");
  EXPECT_EQ(stored_status_path(folder.file("status.json").c_str()).view(), path);
  RunStatus read;
  EXPECT_EQ(read_status(path.c_str(), read), StatusFile::kAbsent);
  StoredStatus stored{.status = {.identity = sample_identity(),
                                 .totals = totals_after({good_record()}),
                                 .written_monotonic_ms = 77}};
  ASSERT_TRUE(write_status(path.c_str(), stored));
  ASSERT_EQ(read_status(path.c_str(), read), StatusFile::kRead);
  EXPECT_EQ(read.identity.name, sample_identity().name.view());
  EXPECT_EQ(read.totals.last.price.price_centi_eur_per_mwh, -12'345);
  EXPECT_EQ(read.written_monotonic_ms, 77);
  const std::string whole = text_of_file(path);
  std::mt19937 random(20'261'128);
  for (int i = 0; i < 200; ++i) {
    std::string damaged = whole;
    damaged[random() % damaged.size()] ^= static_cast<char>(1U << random() % 8);
    folder.write("status.bin", damaged);
    EXPECT_EQ(read_status(path.c_str(), read), StatusFile::kDamaged) << i;
  }
  folder.write("status.bin", whole.substr(0, whole.size() - 1));
  EXPECT_EQ(read_status(path.c_str(), read), StatusFile::kDamaged);
}

TEST(Prometheus, FollowsTheFormatAndTheNamingRules) {
  for (const auto& [name, family] :
       parse_prometheus(prometheus_text(totals_after({good_record()})))) {
    EXPECT_TRUE(name.starts_with("bess_")) << name;
    EXPECT_EQ(family.type == "counter", name.ends_with("_total")) << name;
    EXPECT_FALSE(family.samples.empty()) << name;
  }
}

/// tools/delivery/monitoring asks for nothing else, but of an upgrade and of a fleet's inventory.
TEST(Prometheus, RulesAndDashboardAskForWhatIsPublished) {
  std::set<std::string> known{"bess_update_trouble", "bess_expected_student_info"};
  CycleRecord record = full_record(1);
  record.outlook.source = OutlookSource::kPlanned;
  for (const auto& [name, family] : parse_prometheus(prometheus_text(totals_after({record})))) {
    known.insert(name);
  }
  static const std::regex expression("expr\"?: |\\[[0-9]+m\\]");
  static const std::regex metric("bess_[a-z_]+");
  std::size_t asked = 0;
  for (const std::string file : {"bess_rules.yml", "grafana_dashboard.json"}) {
    std::istringstream lines(text_of_file(BESS_SOURCE_DIR "/tools/delivery/monitoring/" + file));
    for (std::string line; std::getline(lines, line);) {
      if (!std::regex_search(line, expression)) continue;
      for (std::sregex_iterator m(line.begin(), line.end(), metric), end; m != end; ++m, ++asked) {
        EXPECT_TRUE(known.contains(m->str())) << file << ": " << line;
      }
    }
  }
  EXPECT_GT(asked, 20U);
}

TEST(RunTotals, CountFailuresAndReasons) {
  CycleRecord bad = good_record();
  bad.battery_status = Status::kTimeout;
  bad.price.status = Status::kHttpError;
  bad.reason = Reason::kLink;
  bad.written = false;
  const RunTotals totals = totals_after({good_record(), bad, bad});
  EXPECT_EQ(totals.cycles, 3);
  EXPECT_EQ(totals.written_orders, 1);
  EXPECT_EQ(totals.battery_failures, 2);
  EXPECT_EQ(totals.price_failures, 2);
  EXPECT_EQ(totals.cycles_by_reason[static_cast<std::size_t>(Reason::kLink)], 2);
  bad.mode = Mode::kStopping;  // ends the run without a price request
  EXPECT_EQ(totals_after({bad}).price_failures, 0);
}

/// The buffers are fixed: the longest texts and numbers must fit, or readers would get half a file.
TEST(RunStatus, TheLargestValuesFit) {
  RunIdentity id = sample_identity();
  id.student_provenance = FixedText<255>(std::string(255, 'x'));
  id.battery = FixedText<159>(std::string(159, 'x'));
  id.map = id.variant = FixedText<31>(std::string(31, 'x'));
  id.pid = INT32_MIN;
  id.cadence_ms = INT32_MIN;
  RunTotals t;
  t.last = longest_record();
  t.cycles = t.written_orders = t.battery_failures = t.price_failures = INT64_MIN;
  t.records_dropped = t.disk_failures = INT64_MIN;
  t.cycles_by_reason.fill(INT64_MIN);
  char status_storage[kStatusBytes];
  TextBuffer json(status_storage);
  const RunStatus longest{.identity = id, .totals = t, .written_monotonic_ms = INT64_MIN};
  format_status_json(longest, json);
  EXPECT_FALSE(json.was_cut());
  char metrics_storage[kMetricsBytes];
  TextBuffer metrics(metrics_storage);
  format_prometheus(longest, metrics);
  EXPECT_FALSE(metrics.was_cut());
}

}  // namespace
}  // namespace bess
