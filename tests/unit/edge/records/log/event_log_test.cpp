// Log thread: a record handed over arrives everywhere, a restart finds it, and a blocked disk costs
// records but never the control thread's time.
#include "edge/records/log/event_log.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <set>
#include <sstream>

#include "shared/scaled_clock.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

using ::testing::HasSubstr;

constexpr std::int64_t kDrainNs = 30 * kNanosecondsPerSecond;

CycleRecord record_of(std::int64_t cycle) {
  CycleRecord record;
  record.utc_s = 1'679'788'800 + 120 * cycle;
  record.cycle = cycle;
  record.counters.flash_day = 19'442;
  record.counters.flash_writes_today = static_cast<std::int32_t>(cycle);
  return record;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// A journal line other than a control cycle's.
bool is_about_a_file(const std::string& line) { return line.find("utc=") == line.npos; }

class Log : public ::testing::Test {
 protected:
  EventLogSettings settings() const {
    EventLogSettings s;
    s.ring = folder_.file("decisions.ring").c_str();
    s.status = folder_.file("status.json").c_str();
    s.metrics = folder_.file("metrics.prom").c_str();
    s.csv = folder_.file("log.csv").c_str();
    s.ring_days = 1;
    return s;
  }
  /// A log that has opened successfully.
  std::unique_ptr<EventLog> opened(const EventLogSettings& s, const RunIdentity& run = {}) {
    auto log = std::make_unique<EventLog>();
    EXPECT_TRUE(log->open(s, run, error_)) << error_.c_str();
    return log;
  }
  static CycleRecord newest_of(EventLog& log) {
    CycleRecord newest;
    EXPECT_TRUE(log.newest(newest));
    return newest;
  }
  /// Standard output while these are written.
  static std::string journal_of(EventLog& log, std::initializer_list<CycleRecord> records) {
    ::testing::internal::CaptureStdout();
    for (const CycleRecord& record : records) log.write(record);
    const bool drained = log.drain(kDrainNs);
    const std::string journal = ::testing::internal::GetCapturedStdout();
    EXPECT_TRUE(drained);
    return journal;
  }
  [[nodiscard]] std::string status() const { return text_of_file(folder_.file("status.json")); }

  const TemporaryFolder folder_;
  FileMessage error_;
};

TEST_F(Log, ARecordArrivesEverywhereAndARestartTakesItOver) {
  {
    const auto log = opened(settings());
    CycleRecord newest;
    EXPECT_FALSE(log->newest(newest));
    EXPECT_THAT(status(), HasSubstr("\"cycles\": 0"));
    for (int cycle = 1; cycle <= 100; ++cycle) {
      log->write(record_of(cycle));
      ASSERT_TRUE(log->drain(kDrainNs));
    }
    EXPECT_THAT(status(), HasSubstr("\"cycles\": 100"));
    EXPECT_THAT(text_of_file(folder_.file("metrics.prom")),
                ::testing::ContainsRegex("bess_cycles_total[{].*[}] 100\n"));
    const std::string csv = text_of_file(folder_.file("log.csv"));
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 101);
  }
  const CycleRecord newest = newest_of(*opened(settings()));
  EXPECT_EQ(newest.cycle, 100);
  EXPECT_EQ(newest.counters.flash_day, 19'442);
  EXPECT_EQ(newest.counters.flash_writes_today, 100);
}

/// The CSV is a pipe without a reader: the log thread blocks in write(2), as on a blocked card.
TEST_F(Log, ABlockedDiskNeverBlocksTheControlThread) {
  EventLogSettings s = settings();
  const std::string pipe_path = folder_.file("pipe");
  s.csv = pipe_path.c_str();
  ASSERT_EQ(mkfifo(pipe_path.c_str(), 0600), 0);
  const int reader = open(pipe_path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  ASSERT_GE(reader, 0);
  fcntl(reader, F_SETPIPE_SZ, 4'096);
  const auto log = opened(s);
  constexpr int kRecords = 1'000;
  for (int cycle = 1; cycle <= kRecords; ++cycle) log->write(record_of(cycle));
  EXPECT_FALSE(log->drain(kNanosecondsPerSecond / 100));  // it is blocked, and drain is bounded
  char bytes[65'536];
  for (bool drained = false; !drained; drained = log->drain(kNanosecondsPerSecond / 100)) {
    while (read(reader, bytes, sizeof bytes) > 0) continue;
  }
  log->write(record_of(kRecords + 1));
  ASSERT_TRUE(log->drain(kDrainNs));
  EXPECT_THAT(status(), HasSubstr("\"utc\": \"2023-03-27T09:22:00Z\", \"cycle\": 1001"));
  EXPECT_THAT(status(), HasSubstr("\"records_dropped\": 9"));  // 9xx: all but queue and pipe
  EXPECT_THAT(status(), HasSubstr("\"disk_failures\": 0"));
  close(reader);
}

TEST_F(Log, AFullDiskIsReportedAndDoesNotStopTheStart) {
  EventLogSettings s = settings();
  s.csv = "/dev/full";
  ::testing::internal::CaptureStdout();
  const auto log = std::make_unique<EventLog>();
  const bool opened = log->open(s, RunIdentity{}, error_);
  const std::string journal = ::testing::internal::GetCapturedStdout();
  ASSERT_TRUE(opened) << error_.c_str();
  EXPECT_THAT(journal, Names("[log]"));
  EXPECT_THAT(status(), HasSubstr("\"disk_is_failing\": true"));
}

/// Behaviour of a process with a file size limit.
template <typename Act>
int exit_code_with_room_for(rlim_t bytes, const Act& act) {
  const pid_t child = fork();
  if (child == 0) {
    signal(SIGXFSZ, SIG_IGN);  // the call fails instead
    const rlimit room{bytes, RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &room);
    _exit(act());
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// No file can be created: the first records are lost, and everything works as soon as there is
/// room.
TEST_F(Log, AStartWithoutRoomContinuesAndWritesOnceThereIs) {
  const int code = exit_code_with_room_for(0, [&] {
    const auto log = std::make_unique<EventLog>();
    if (!log->open(settings(), RunIdentity{}, error_)) return 1;
    log->write(record_of(1));
    if (!log->drain(kDrainNs)) return 2;
    if (std::filesystem::exists(folder_.file("decisions.ring"))) return 3;
    const rlimit all{RLIM_INFINITY, RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &all);
    log->write(record_of(2));
    return log->drain(kDrainNs) ? 0 : 4;
  });
  EXPECT_EQ(code, 0);
  EXPECT_THAT(status(), HasSubstr("\"cycles\": 2"));
  EXPECT_THAT(text_of_file(folder_.file("log.csv")), ::testing::StartsWith("utc,"));
  EXPECT_EQ(newest_of(*opened(settings())).cycle, 2);
}

/// A larger log has no room: the existing one continues, with its contents.
TEST_F(Log, ALogThatCannotGrowContinuesAtItsSize) {
  {
    const auto log = opened(settings());
    log->write(record_of(1));
    ASSERT_TRUE(log->drain(kDrainNs));
  }
  const auto size = std::filesystem::file_size(folder_.file("decisions.ring"));
  EventLogSettings larger = settings();
  larger.ring_days = 30;
  const int code = exit_code_with_room_for(size, [&] {
    const auto log = std::make_unique<EventLog>();
    CycleRecord newest;
    if (!log->open(larger, RunIdentity{}, error_)) return 1;
    if (!log->newest(newest) || newest.cycle != 1) return 2;
    log->write(record_of(2));
    return log->drain(kDrainNs) ? 0 : 3;
  });
  EXPECT_EQ(code, 0);
  EXPECT_EQ(std::filesystem::file_size(folder_.file("decisions.ring")), size);
  EXPECT_FALSE(std::filesystem::exists(folder_.file("decisions.ring.old")));
  EXPECT_FALSE(std::filesystem::exists(folder_.file("decisions.ring.new")));
  EXPECT_EQ(newest_of(*opened(larger)).cycle, 2);
  EXPECT_GT(std::filesystem::file_size(folder_.file("decisions.ring")), size);
}

TEST_F(Log, AMetricsFolderThatVanishesIsAFailureOfThatFileOnly) {
  EventLogSettings s = settings();
  std::filesystem::create_directory(folder_.file("metrics"));
  s.metrics = folder_.file("metrics/bess.prom").c_str();
  const auto log = opened(s);
  std::filesystem::remove_all(folder_.file("metrics"));
  const std::string journal = journal_of(*log, {record_of(1), record_of(2)});
  EXPECT_EQ(std::ranges::count_if(lines_of(journal), is_about_a_file), 1) << journal;
  EXPECT_THAT(status(), HasSubstr("\"cycles\": 2"));
  EXPECT_THAT(status(), HasSubstr("\"disk_is_failing\": true"));
}

/// A disk fault does not change this: the line makes no false promise.
TEST_F(Log, TheLineOfAFailingDiskSaysWhatTheControllerDoes) {
  struct Case {
    bool control;
    Mode mode;
    Reason reason, trip;
    const char* codes;
  };
  const Case cases[] = {{true, Mode::kRunning, Reason::kLink, Reason::kStudent, ""},
                        {false, Mode::kRunning, Reason::kLink, Reason::kStudent, ""},
                        {true, Mode::kSafe, Reason::kNoPrice, Reason::kStudent, "no_price"},
                        {true, Mode::kSafe, Reason::kLink, Reason::kStateLost, "state_lost"}};
  std::set<std::string> reported;
  for (const Case& one : cases) {
    EventLogSettings s = settings();
    s.metrics = folder_.file("metrics").c_str();
    RunIdentity identity;
    identity.control = one.control;
    const auto log = opened(s, identity);
    std::filesystem::remove(folder_.file("metrics"));
    std::filesystem::create_directory(folder_.file("metrics"));
    CycleRecord record = record_of(1);
    record.mode = one.mode;
    record.reason = one.reason;
    record.is_tripped = one.trip != Reason::kStudent;
    record.trip = {.reason = one.trip, .utc_s = 1};
    const std::vector<std::string> lines = lines_of(journal_of(*log, {record}));
    const auto line = std::ranges::find_if(lines, is_about_a_file);
    ASSERT_NE(line, lines.end());
    EXPECT_THAT(*line, Names(one.codes));
    EXPECT_TRUE(reported.insert(*line).second) << *line;
    std::filesystem::remove(folder_.file("metrics"));
  }
}

TEST_F(Log, WhatCannotBeOpenedStopsTheStartWithOneLine) {
  EventLogSettings s = settings();
  s.metrics = "/nonexistent/bess.prom";
  EXPECT_FALSE(std::make_unique<EventLog>()->open(s, RunIdentity{}, error_));
  EXPECT_THAT(error_.c_str(), Names("/nonexistent/bess.prom"));
}

}  // namespace
}  // namespace bess
