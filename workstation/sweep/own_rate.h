// What a student that was learnt at a rounded C-rate earns at the one that its site has.
#pragma once

#include <map>
#include <optional>

#include "shared/host/minute_file.h"
#include "workstation/sweep/collected.h"

namespace bess {

class OwnRates {
 public:
  explicit OwnRates(const SweepFolder& folder) : folder_(folder) {}

  struct Earned {
    double profit = 0;  ///< as TaskFigures::profit
    /// A student of its own would not earn more than this besides: the best profit grows with the
    /// power, and at most in proportion. But for chance: two students of one rate differ too.
    double loss_at_most = 0;
  };
  /// By the student of a proved task; none where the site's C-rate is the task's.
  std::optional<Earned> earned(const CollectedTask& task, const Site& site);

 private:
  std::optional<Earned> evaluated(const CollectedTask& task, double rate_per_h);

  SweepFolder folder_;
  std::optional<RunConfig> base_;
  std::optional<MinuteSeries> prices_;
  std::map<std::pair<int, double>, std::optional<Earned>> known_;  ///< by task and C-rate
};

}  // namespace bess
