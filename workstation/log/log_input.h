// What every command on a controller's log takes: its files, settled prices, days, and the battery.
#pragma once

#include <string>
#include <vector>

#include "shared/host/command_line.h"
#include "workstation/log/logged_days.h"
#include "workstation/student/student_file.h"

namespace bess {

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
