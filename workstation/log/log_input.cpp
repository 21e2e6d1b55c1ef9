#include "workstation/log/log_input.h"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

#include "shared/host/file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/chain/run_config.h"
#include "workstation/market/series/local_date.h"

namespace bess {
namespace {

std::int32_t day_of(const std::string& text, const char* option, std::int32_t otherwise) {
  if (text.empty()) return otherwise;
  const auto [year, month, day] = parse_local_date(text, option);
  return (year * 100 + month) * 100 + day;
}

void tell(const std::string& file, const CycleLog& log, const std::vector<LoggedDay>& days) {
  int missing = 0;
  for (const LoggedDay& day : days) missing += day.missing;
  const auto tell_one = [&](int count, const char* noun, const char* what) {
    if (count == 0) return;
    fmt::print(stderr, "{}: {} {}\n", file, counted(static_cast<std::size_t>(count), noun), what);
  };
  tell_one(log.torn, "last line", "without a line end: passed over");
  tell_one(log.duplicates, "row", "of a time that there is already: passed over");
  tell_one(missing, "tick", "without a row: what flowed there is told by the state of charge");
}

}  // namespace

void LogInput::add(ProgramCommand& command, bool counts_money) {
  counts_money_ = counts_money;
  command.option("files", files_, "Of bess-edge log --csv, or [log] csv; several are one log")
      .required();
  command.option("--from", from_, "First local day, YYYY-MM-DD (default: that of the log)");
  command.option("--to", to_, "Last local day, YYYY-MM-DD");
  if (!counts_money) return;
  command.option("--settled", settled_,
                 "settled.csv of bess-prices; without: the last minute's price, an estimate");
  command.option("--config", config_, "TOML file with [battery] and [costs] of the log's battery");
}

ReadLog LogInput::read() const {
  const BatteryParameters battery = load_run_config(config_).battery;
  CycleLog log = read_cycle_log(files_);
  if (counts_money_) require_same_battery(log, battery, config_);
  const LoggedSpan span{day_of(from_, "--from", 0), day_of(to_, "--to", 99'999'999)};
  QuarterPrices prices = prices_of(log, read_settled(settled_));
  std::vector<LoggedDay> days = days_of(log, prices, battery, span);
  if (days.empty()) fail("{}: the log holds no cycle of these days", files_.front());
  tell(files_.front(), log, days);
  return {std::move(log), battery, span, std::move(prices), std::move(days)};
}

void LogInput::require_not_read(const std::string& option, const std::string& output) const {
  std::vector<GivenPath> inputs = given_paths("", files_);
  inputs.push_back({"--settled", settled_});
  inputs.push_back({"--config", config_});
  require_distinct({{option, output}}, inputs);
}

StudentFile student_for_log(const std::string& name) {
  const bool is_run = std::filesystem::is_directory(name);
  StudentFile student = name == "compiled" ? compiled_student()
                                           : load_student(is_run ? name + "/student.json" : name);
  student.outlook = nullptr;
  return student;
}

}  // namespace bess
