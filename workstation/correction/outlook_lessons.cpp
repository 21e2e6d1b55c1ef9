#include "workstation/correction/outlook_lessons.h"

#include <span>
#include <vector>

#include "shared/host/user_error.h"
#include "workstation/base/in_parallel.h"
#include "workstation/rl/transition.h"

namespace bess {
namespace {

constexpr std::uint64_t kSeedOutlook = 14;
constexpr int kPasses = 4;
constexpr double kExploration = 0.1;
constexpr double kElsewhereShare = 0.25;  ///< of lessons at another price and SoC
constexpr double kElsewhereEurPerMwh = 200;
constexpr int kRows = kNetworkInputs + kActionCount;

/// A day traded once, from its own SoC, at prices that are moved as a whole.
struct Pass {
  double soc_frac;
  double shift_eur_per_mwh;
};

class LessonBook {
 public:
  LessonBook(const Teacher& teacher, const BatteryParameters& battery)
      : teacher_(teacher), per_eur_(learned_per_eur(battery)), x_(kNetworkInputs, 1) {}

  /// Adds a lesson; returns what the teacher would do.
  Action add(const MarketStep& step, double soc_frac, double shift_eur_per_mwh,
             OutlookProgram::Plan& plan) {
    auto worth_eur = teacher_.outlook->action_values(step, soc_frac, plan);
    if (teacher_.is_residual()) teacher_.add_network(step, soc_frac, x_, tile_, worth_eur);
    const std::int32_t break_even_centi = teacher_.book->break_even_centi(step, soc_frac);
    const std::int16_t context_class =
        teacher_.context.class_of(step.month, break_even_centi + price_centi_of(shift_eur_per_mwh));
    float x[kRows];
    write_input(network_context(step.minute_of_quarter_hour, step.quarter_hour, context_class,
                                teacher_.price_map(step.observed_eur_per_mwh + shift_eur_per_mwh)),
                soc_frac, x);
    for (int a = 0; a < kActionCount; ++a) {
      x[kNetworkInputs + a] = static_cast<float>((worth_eur[a] - worth_eur[1]) * per_eur_);
    }
    all_.insert(all_.end(), x, x + kRows);
    return argmax_action(worth_eur.data());
  }
  [[nodiscard]] Eigen::Map<const Matrix> lessons() const {
    return {all_.data(), kRows, static_cast<Eigen::Index>(all_.size() / kRows)};
  }

 private:
  const Teacher& teacher_;
  double per_eur_;
  Matrix x_;
  MlpTile tile_;
  std::vector<float> all_;
};

MarketStep elsewhere(MarketStep step, Random& random) {
  if (random.uniform() < 0.5) {
    step.observed_eur_per_mwh = kLatticePriceMinEurPerMwh + random.uniform() * (kPriceCount - 1);
  } else {
    step.observed_eur_per_mwh += kElsewhereEurPerMwh * random.normal();
  }
  return step;
}

/// Draws a day's lessons in the order of time; `add` adds one and returns what the teacher does.
template <typename Add>
void trade_day(std::span<const MarketStep> steps, const BatteryParameters& battery,
               double level_shift_eur_per_mwh, Random& random, Add add) {
  const double window_frac = battery.soc_max_frac - battery.soc_min_frac;
  std::vector<Pass> passes;
  for (int p = 0; p < kPasses; ++p) {
    const double soc_frac = battery.soc_min_frac + random.uniform() * window_frac;
    passes.push_back({soc_frac, p == 0 ? 0.0 : level_shift_eur_per_mwh * random.normal()});
  }
  for (const MarketStep& step : steps) {
    for (Pass& pass : passes) {
      Action action = add(step, pass.soc_frac, pass.shift_eur_per_mwh);
      if (random.uniform() < kElsewhereShare) {
        const MarketStep other = elsewhere(step, random);
        add(other, battery.soc_min_frac + random.uniform() * window_frac, pass.shift_eur_per_mwh);
      }
      if (random.uniform() < kExploration) action = static_cast<Action>(random.index(kActionCount));
      const double wanted_w = power_sign(action) * battery.power_w_at(step.quarter_hour);
      pass.soc_frac = battery_step(battery, pass.soc_frac, wanted_w, kHoursPerStep).soc_frac;
    }
  }
}

Matrix joined(const std::vector<LessonBook>& books) {
  Eigen::Index count = 0;
  for (const LessonBook& book : books) count += book.lessons().cols();
  Matrix all(kRows, count);
  Eigen::Index at = 0;
  for (const LessonBook& book : books) {
    all.middleCols(at, book.lessons().cols()) = book.lessons();
    at += book.lessons().cols();
  }
  return all;
}

}  // namespace

Matrix outlook_lessons(const Teacher& teacher, const MarketSteps& market,
                       const BatteryParameters& battery, const DistilOptions& options) {
  if (market.day_ahead == nullptr) {
    fail("this teacher plans on day-ahead prices: give their file to distil with --day-ahead");
  }
  const std::vector<MarketDay> days = market.days_of(Split::kTrain);
  const auto trade = [&](std::size_t d, Random& random, auto add) {
    trade_day(market.of(days[d]), battery, options.level_shift_eur_per_mwh, random, add);
  };
  // What is drawn hangs on nothing that is planned: where each day's draws begin is known before.
  Random random(derive_seed(options.seed, kSeedOutlook));
  std::vector<Random> draws;
  for (std::size_t d = 0; d < days.size(); ++d) {
    draws.push_back(random);
    trade(d, random, [](const MarketStep&, double, double) { return Action::kIdle; });
  }
  std::vector<LessonBook> books(days.size(), LessonBook(teacher, battery));
  in_parallel(days.size(), options.threads, [&](std::size_t d) {
    OutlookProgram::Plan plan;
    trade(d, draws[d], [&](const MarketStep& step, double soc_frac, double shift_eur_per_mwh) {
      if (!plan.serves(step)) plan = teacher.outlook->plan_of(step);
      return books[d].add(step, soc_frac, shift_eur_per_mwh, plan);
    });
  });
  return joined(books);
}

}  // namespace bess
