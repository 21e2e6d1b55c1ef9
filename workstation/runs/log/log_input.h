// The input of every command on a controller's log: its files, settled prices, days and battery;
// and the logged days made of them.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "shared/context_classes.h"
#include "shared/host/command_line.h"
#include "shared/host/exchanged_days.h"
#include "workstation/correction/student/student_file.h"
#include "workstation/data/env/cycle_log.h"
#include "workstation/data/env/evaluate.h"

namespace bess {

// What a controller's log says of its local days: energy and money as `bess-edge earned` counts
// them, by the same code (exchanged_days.h), and the market that other policies are run on.
//
// Of the two conventions the edge's counts the battery: what flowed is reconstructed to the second
// and paid by quarter-hours, as a bill is. Every policy beside it is counted by evaluate(), with
// its order from tick to tick: some 3 s early, 0.5 % of a month. Costs, wear and the charge left at
// the end are those of the workstation for all.

/// Local days as 20231126, both ends included.
struct LoggedSpan {
  std::int32_t first_day = 0;
  std::int32_t last_day = 99'999'999;

  [[nodiscard]] bool holds(std::int32_t day) const { return day >= first_day && day <= last_day; }
};

struct LoggedDay {
  std::string date;  ///< "2023-11-26"
  ExchangedDay exchanged{};
  double soc_start_frac = 0, soc_end_frac = 0;  ///< first and last reading
  bool has_reading = false;
  int cycles = 0, driven_cycles = 0;
  int missing = 0;                       ///< ticks without a row
  int switches = 0;                      ///< changes between charging, rest and discharging
  std::map<std::string, int> stopped{};  ///< cycles by reason, where the student did not decide
};

/// `settled.csv` of bess-prices: "quarter_hour_utc,eur_per_mwh,state"; an empty path: none. Throws
/// UserError naming file, line and column.
std::vector<SettledQuarter> read_settled(const std::string& path);

/// What the log's quarter-hours are paid at.
QuarterPrices prices_of(const CycleLog& log, const std::vector<SettledQuarter>& settled);

/// The days of `span` that have a cycle, oldest first. Costs, wear and capacity are of `battery`.
std::vector<LoggedDay> days_of(const CycleLog& log, const QuarterPrices& prices,
                               const BatteryParameters& battery, const LoggedSpan& span);

/// Those days as an evaluation, SoC carried over; the charge left is not valued yet.
Evaluation evaluation_of(const std::vector<LoggedDay>& days, const BatteryParameters& battery);

/// A step for each cycle of `dates` with a price that can be decided on: in the others all rest.
/// The level of the steps is that of the log; by outlook it is the break-even price that the log
/// has, which is known at the battery's own charge alone.
MarketSteps market_of_log(const CycleLog& log, const QuarterPrices& prices, const LoggedSpan& span,
                          ContextKind context);
/// Of one cycle with a price; the price that is paid stays 0.
MarketStep step_of(const LoggedCycle& cycle, ContextKind context);

/// Largest order of either direction, W.
double most_ordered_w(const CycleLog& log);

/// Throws UserError where the orders of the log are not those of a battery of this power; `config`
/// names where it came from.
void require_same_battery(const CycleLog& log, const BatteryParameters& battery,
                          const std::string& config);

struct ReadLog {
  CycleLog log;
  BatteryParameters battery;
  LoggedSpan span;
  QuarterPrices prices;
  std::vector<LoggedDay> days;  ///< not empty
};

class LogInput {
 public:
  /// Declares the files, --from and --to, and where money is counted --config and --settled.
  void add(ProgramCommand& command, bool counts_money);
  /// Tells on the standard error what of the log was passed over. Throws UserError.
  [[nodiscard]] ReadLog read() const;
  /// Refuses an output that is read.
  void require_not_read(const std::string& option, const std::string& output) const;

 private:
  std::vector<std::string> files_;
  std::string settled_, from_, to_, config_;
  bool counts_money_ = false;
};

/// "compiled", a student's file, or a run's folder. By outlook it decides on the break-even price
/// that the log has. Throws UserError.
StudentFile student_for_log(const std::string& name);

}  // namespace bess
