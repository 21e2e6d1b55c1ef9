// Input of the log commands: files, settled prices, days and battery; the logged days, and what the
// commands make of them.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "shared/context_classes.h"
#include "shared/host/command_line.h"
#include "shared/host/exchange.h"
#include "workstation/correction/student/student_file.h"
#include "workstation/data/env/cycle_log.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/report/comparison.h"

namespace bess {

// Local days of a log: energy and money as in `bess-edge earned` (exchange.h), and the market
// on which other policies run.
//
// The battery is accounted as on the edge: energy is reconstructed to the second and paid by
// quarter-hour, as on a bill. Other policies are accounted by evaluate(), from tick to tick: about
// 3 s early, 0.5 % of a month. Costs, wear and final charge are those of the workstation for all.

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
  int switches = 0;                      ///< changes between charging, idle and discharging
  std::map<std::string, int> stopped{};  ///< cycles not decided by the student, by reason
};

/// `settled.csv` of bess-prices: "quarter_hour_utc,eur_per_mwh,state"; an empty path: none. Throws
/// UserError naming file, line and column.
std::vector<SettledQuarter> read_settled(const std::string& path);

/// Prices of the log's quarter-hours.
QuarterPrices prices_of(const CycleLog& log, const std::vector<SettledQuarter>& settled);

/// Days of `span` with a cycle, oldest first. Costs, wear and capacity from `battery`.
std::vector<LoggedDay> days_of(const CycleLog& log, const QuarterPrices& prices,
                               const BatteryParameters& battery, const LoggedSpan& span);

/// The days as an evaluation, SoC carried over; final charge not valued.
Evaluation evaluation_of(const std::vector<LoggedDay>& days, const BatteryParameters& battery);

/// One step for each cycle of `span` with a usable price; in other cycles all policies are idle.
/// The level of the steps is that of the log; by outlook it is the logged break-even price, which
/// is known only at the battery's own SoC.
MarketSteps market_of_log(const CycleLog& log, const QuarterPrices& prices, const LoggedSpan& span,
                          ContextKind context);
/// Step of one cycle with a price; the paid price stays 0.
MarketStep step_of(const LoggedCycle& cycle, ContextKind context);

/// Largest order in either direction, W.
double most_ordered_w(const CycleLog& log);

/// Throws UserError when the orders of the log do not fit the power of `battery`; `config` names
/// its file.
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
  /// Declares files, --from and --to, and with `counts_money` --config and --settled.
  void add(ProgramCommand& command, bool counts_money);
  /// Reports ignored rows on stderr. Throws UserError.
  [[nodiscard]] ReadLog read() const;
  /// Refuses an output that is also an input.
  void require_not_read(const std::string& option, const std::string& output) const;

 private:
  std::vector<std::string> files_;
  std::string settled_, from_, to_, config_;
  bool counts_money_ = false;
};

/// Statement of the days as a printable, self-contained page, to compare with the bill: HTML
/// that is also XML. `days` is not empty; costs and wear from `battery`.
std::string statement_page(const std::vector<LoggedDay>& days, const BatteryParameters& battery);

/// "compiled", a student file or a run folder. By outlook it decides on the logged break-even
/// price. Throws UserError.
StudentFile student_for_log(const std::string& name);

// Log comparison: other policies in the same control cycles, with the
// controller's prices and their delay, from the same SoC.

inline constexpr const char* kThisBattery = "this battery";

/// This battery, `policies` and foresight; SoC carried over, final charge valued. A policy is
/// "rbc", "rbc:LOW:HIGH" or a name for student_for_log(). Throws UserError.
std::vector<NamedEvaluation> compare_log(const ReadLog& read,
                                         const std::vector<std::string>& policies);

/// Earnings of the whole battery over all days, EUR.
struct NetEarnings {
  double paid_eur;    ///< net of costs and wear
  double charge_eur;  ///< value of the final charge
};
NetEarnings net_earnings_of(const Evaluation& evaluation);

// Log replay with another student, to check it before adoption.
//
// The value of a changed decision is an estimate: two minutes at the highest logged power, bought
// or sold at that price and offset at the day's mean price.

struct ReplayedDay {
  std::string date;
  int compared = 0;  ///< cycles decided by the student
  int differing = 0;
  double gained_eur = 0;          ///< by changed decisions
  double prices_eur_per_mwh = 0;  ///< sum over cycles with a price
  int priced = 0;
  double mwh_moved = 0;  ///< additional charge by the new decisions
};

/// Cycle with a changed decision.
struct ReplayedCycle {
  std::int64_t utc_s = 0;
  double price_eur_per_mwh = 0;
  double soc_frac = 0;
  Action before{};
  Action now{};
};

struct LogReplay {
  std::uint32_t student_hash = 0;
  std::vector<ReplayedDay> days;      ///< days with a compared cycle, oldest first
  std::vector<ReplayedCycle> others;  ///< all changed decisions, oldest first
  /// [logged decision][new decision].
  std::array<std::array<int, kActionCount>, kActionCount> decisions{};
  int compared = 0;  ///< not 0
  int differing = 0;
  int without_context = 0;  ///< by outlook: cycles without a break-even price
  double gained_eur = 0;

  [[nodiscard]] double differing_percent() const { return 100.0 * differing / compared; }
  [[nodiscard]] std::string text() const;
  /// Answer of --json (answers.schema.json).
  [[nodiscard]] Json json() const;
};

/// Throws UserError when the log has no decision to compare.
LogReplay replay_log(const CycleLog& log, const LoggedSpan& span, const StudentNet& student);

}  // namespace bess
