// Run folder: refusals, and defaults, before anything is written.
#include "workstation/runs/run/run_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "shared/host/file.h"
#include "tests/support/small_market.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/support/user_error_of.h"
#include "workstation/correction/student/student_file.h"
#include "workstation/runs/chain/folder_lock.h"
#include "workstation/runs/run/run_record.h"
#include "workstation/runs/run/run_stages.h"

namespace bess {
namespace {

using testing::AllOf;
using testing::Not;

namespace fs = std::filesystem;

class RunPlanning : public testing::Test {
 protected:
  RunPlanning() {
    write_minute_file(prices_, small_series(), "");
    request_.prices = prices_;
    request_.out = folder_.file("run");
    request_.common.seed = 5;
    request_.common.threads = 3;
    request_.common.config_path = folder_.write("my.toml", "[battery]\npower_w = 5000000\n");
    const RunPlan plan = plan_run(request_);
    save_run_record(plan.folder, plan.record);  // as `run` starts
  }

  /// Only the folder is given.
  static RunRequest resumed(const fs::path& out) {
    RunRequest request;
    request.out = out;
    request.resume = true;
    return request;
  }
  static std::string refusal(const RunRequest& request) {
    return refusal_of([&] { plan_run(request); });
  }

  TemporaryFolder folder_;
  std::string prices_ = folder_.file("prices.csv.gz");
  RunRequest request_;
};

TEST_F(RunPlanning, AnotherRunIsRefusedNamingEveryKeyAndBothValues) {
  const std::string before = read_file(fs::path(request_.out) / "run.json");
  RunRequest other = request_;
  other.common.seed = 6;
  other.common.config_path =
      folder_.write("other.toml", "[battery]\npower_w = 2500000\n[distil]\nepochs = 7\n");
  for (const bool resume : {false, true}) {
    other.resume = resume;
    EXPECT_THAT(refusal(other),
                AllOf(Names("seed 5 6 [battery] power_w 5000000 2500000 [distil] epochs 7 --out"),
                      Not(Names("threads"))));
  }
  EXPECT_EQ(read_file(fs::path(request_.out) / "run.json"), before);
  EXPECT_EQ(std::distance(fs::directory_iterator(request_.out), {}), 1) << "something was written";
}

TEST_F(RunPlanning, OtherPricesAreRefused) {
  RunRequest other = request_;
  other.resume = true;
  other.prices = folder_.file("others.csv.gz");
  write_minute_file(other.prices, small_series(59, 8), "");
  EXPECT_THAT(refusal(other), Names("prices crc32 --out"));
}

/// Day-ahead prices make it one by outlook, and are part of its inputs.
TEST_F(RunPlanning, DayAheadPricesAreTheFoldersAndOthersAreRefused) {
  const auto priced = [&](const char* name, double eur_per_mwh) {
    const MinuteSeries series = small_series();
    DayAheadSeries day_ahead;
    for (std::int64_t t = series.utc_s(0); t < series.utc_s(series.size() - 1);
         t += kSecondsPerQuarterHour) {
      EXPECT_TRUE(append_day_ahead(day_ahead, {t, eur_per_mwh + static_cast<double>(t % 7), 15}));
    }
    write_day_ahead_file(folder_.file(name), day_ahead, "");
    return DayAheadInput{folder_.file(name)};
  };
  RunRequest request = request_;
  request.day_ahead = priced("a.csv", 70);
  request.out = folder_.file("outlook");
  const RunPlan plan = plan_run(request);
  save_run_record(plan.folder, plan.record);
  EXPECT_EQ(plan.record.config(plan.folder).train.context, ContextKind::kOutlook);
  EXPECT_EQ(plan.record.config(plan.folder).train.method, Method::kC51);
  RunRequest bare = resumed(request.out);
  EXPECT_EQ(plan_run(bare).record.day_ahead, folder_.file("a.csv"));
  bare.day_ahead = priced("b.csv", 80);
  EXPECT_THAT(refusal(bare), Names("day-ahead crc32 --out"));
  request.out = folder_.file("blind");
  request.day_ahead = {};
  request.common.config_path = folder_.write("o.toml", "[train]\ncontext = \"outlook\"\n");
  EXPECT_THAT(refusal(request), Names("[train] context --day-ahead"));
  request.day_ahead = {folder_.file("a.csv")};
  request.common.config_path = folder_.write("level.toml", "[train]\ncontext = \"level\"\n");
  request.out = folder_.file("named");
  const RunPlan named = plan_run(request);
  EXPECT_EQ(named.record.config(named.folder).train.context, ContextKind::kLevel);
}

TEST_F(RunPlanning, TheSameRunIsResumedOnlyOnRequest) {
  EXPECT_THAT(refusal(request_), Names("--resume --out"));
  request_.resume = true;
  EXPECT_EQ(refusal(request_), "");
}

TEST_F(RunPlanning, WhatIsNotGivenIsTheFolders) {
  const RunRequest bare = resumed(request_.out);
  const RunPlan plan = plan_run(bare);
  const RunConfig config = plan.record.config(plan.folder);
  EXPECT_EQ(config.battery.power_w_max, 5e6);
  EXPECT_EQ(config.train.seed, 5U);
  EXPECT_EQ(config.distil.threads, 3);
  EXPECT_EQ(plan.record.prices, prices_);
  EXPECT_EQ(plan.series.settled, read_minute_file(prices_).settled);
}

/// A silent change is an error: the inputs of a run are in run.json.
TEST_F(RunPlanning, AnEditedConfigurationIsRefusedNamingKeyAndBothValues) {
  request_.resume = true;
  const RunPlan plan = plan_run(request_);
  const fs::path file = fs::path(request_.out) / "config.toml";
  const std::string written = format_run_config(plan.record.config(plan.folder));
  write_file(file, written);
  const RunRequest bare = resumed(request_.out);
  EXPECT_EQ(refusal(bare), "");
  write_file(file, "# only a remark\n" + written);
  EXPECT_EQ(refusal(bare), "") << "says the same";
  write_file(file, written + "\n");
  std::string edited = written;
  const std::size_t at = edited.find("\npower_w = 5000000");
  ASSERT_NE(at, std::string::npos);
  edited.replace(at + 11, 7, "4000000");
  write_file(file, edited);
  for (const RunRequest& request : {bare, request_}) {
    EXPECT_THAT(refusal(request), Names("config.toml [battery] power_w 5000000 4000000 --config " +
                                        file.string() + " --out"));
  }
  EXPECT_EQ(read_file(file), edited) << "left as it is";
}

/// An older model does not contain its training conditions: then the run next to it does.
TEST_F(RunPlanning, AModelTrainedForOthersIsReported) {
  request_.resume = true;
  const RunPlan plan = plan_run(request_);
  const fs::path model = fs::path(request_.out) / "student.json";
  save_student(model, compiled_student());
  RunConfig config = plan.record.config(plan.folder);
  const auto otherwise = [&] {
    return learnt_otherwise(learnt_for_of(model), circumstances_of(config_entries(config)));
  };
  EXPECT_EQ(otherwise(), "");
  config.battery.power_w_max = 1e6;
  config.battery.costs.import_adder_eur_per_mwh = 42;
  config.market.observation_delay_min = 3;
  config.distil.epochs = 7;
  EXPECT_THAT(otherwise(),
              AllOf(Names("[battery] power_w 5000000 1000000 [costs] import_adder_eur_per_mwh 0 42 "
                          "[market]"),
                    Not(Names("epochs"))));
  EXPECT_TRUE(learnt_for_of("rbc-tuned").empty());
}

/// A key newer than the model is reported when it is set, not for being new.
TEST_F(RunPlanning, AModelOlderThanAKeyIsNotReported) {
  RunConfig config;
  Entries here = circumstances_of(config_entries(config));
  Entries before = here;
  std::erase_if(
      before, [](const auto& entry) { return entry.first == "[market] day_ahead_published_min"; });
  ASSERT_EQ(before.size() + 1, here.size());
  EXPECT_EQ(learnt_otherwise(before, here), "");
  config.market.day_ahead_published_min = 840;
  here = circumstances_of(config_entries(config));
  EXPECT_THAT(learnt_otherwise(before, here), Names("[market] day_ahead_published_min 840"));
}

/// A lock on a whole folder excludes all others in it; single files are made in parallel, each by
/// one program.
TEST_F(RunPlanning, OneProgramAtATimeIsAtWork) {
  const fs::path folder = request_.out;
  using LockScope = FolderLock::LockScope;
  const auto is_busy = [](auto lock) { return !refusal_of(lock).empty(); };
  const auto whole = [&] { const FolderLock lock(folder); };
  const auto part = [&] { const FolderLock lock(folder, LockScope::kOneFile); };
  const auto file = [&] { const FileLock lock(folder / "teacher.bin"); };
  {
    const FolderLock lock(folder);
    EXPECT_TRUE(is_busy(whole));
    EXPECT_TRUE(is_busy(part));
  }
  {
    const FolderLock lock(folder, LockScope::kOneFile);
    const FileLock of_file(folder / "teacher.bin");
    EXPECT_TRUE(is_busy(whole));
    EXPECT_FALSE(is_busy(part)) << "another file of the folder";
    EXPECT_TRUE(is_busy(file));
  }
  EXPECT_FALSE(is_busy(whole));
  EXPECT_FALSE(is_busy(file));
  EXPECT_FALSE(fs::exists(folder / "teacher.bin.lock"));
}

TEST_F(RunPlanning, PricesThatMovedAreTheSamePrices) {
  const std::string moved = folder_.file("moved.csv.gz");
  fs::rename(prices_, moved);
  request_.prices = moved;
  request_.resume = true;
  EXPECT_EQ(plan_run(request_).record.prices_name, "prices.csv.gz");
}

TEST_F(RunPlanning, FilesOfARunWithoutItsRecordAreNotOverwritten) {
  fs::remove(fs::path(request_.out) / "run.json");
  write_file(fs::path(request_.out) / "teacher.bin", "of another run");
  for (const bool resume : {false, true}) {
    request_.resume = resume;
    EXPECT_THAT(refusal(request_), Names("teacher.bin run.json --out"));
  }
}

TEST_F(RunPlanning, ARecordOfAnotherKindIsNamed) {
  for (const char* text : {"{", "{\"version\":\"0.1.0\",\"prices\":\"a.csv\"}", "[]"}) {
    write_file(fs::path(request_.out) / "run.json", text);
    EXPECT_THAT(refusal(request_), Names("run.json"));
  }
}

TEST_F(RunPlanning, AStageHoldsOnlyWhileItsFilesAreWhatTheyWere) {
  request_.resume = true;
  RunPlan plan = plan_run(request_);
  const fs::path in = plan.folder.path / "in";
  const fs::path out = plan.folder.path / "out";
  write_file(in, "in");
  write_file(out, "out");
  plan.record.stages.push_back({"work", {{"in", file_mark(in)}}, {{"out", file_mark(out)}}, false});
  save_run_record(plan.folder, plan.record);
  const RunRecord record = *load_run_record(plan.folder);
  EXPECT_NE(record.holds("work", {"in"}, plan.folder), nullptr);
  EXPECT_EQ(record.holds("other work", {"in"}, plan.folder), nullptr);
  for (const fs::path& changed : {in, out}) {
    const std::string before = read_file(changed);
    write_file(changed, "ouT");
    EXPECT_EQ(record.holds("work", {"in"}, plan.folder), nullptr);
    write_file(changed, before);
  }
  fs::remove(out);
  EXPECT_EQ(record.holds("work", {"in"}, plan.folder), nullptr);
}

// The table of stages: inputs exist before they are read.

TEST(StageTable, EachStageReadsWhatAnEarlierOneWrote) {
  std::set<std::string> written;
  int number = 0;
  for (const RunStages::Stage& stage : RunStages::stages()) {
    for (const std::string& input : stage.inputs) EXPECT_TRUE(written.contains(input)) << input;
    EXPECT_GE(stage.number, number) << stage.name;
    number = stage.number;
    written.insert(stage.outputs.begin(), stage.outputs.end());
  }
  EXPECT_EQ(RunStages::count(), number);
}

}  // namespace
}  // namespace bess
