#include "workstation/run/proposal.h"

#include <fmt/format.h>

#include <map>

#include "shared/utc_text.h"
#include "workstation/env/charge_left.h"
#include "workstation/student/exported_policy.h"

namespace bess {
namespace {

double total_eur(const Evaluation& evaluation) {
  double sum = 0;
  for (const DayResult& day : evaluation.days) sum += day.profit_eur;
  return sum;
}

std::string change_of(const DifferingDecision& d) {
  return fmt::format("{} -> {}", action_name(d.before), action_name(d.now));
}

}  // namespace

Proposal judge_refit(const StudentFile& before, const StudentFile& now, const MarketSteps& market,
                     const RunConfig& config) {
  const std::vector<MarketDay> days = market.days_of(Split::kTest);
  const double price = mean_settled_eur_per_mwh(market, days);
  std::vector<StepRecord> path;
  const auto traded = [&](Policy& policy, std::vector<StepRecord>* records) {
    Evaluation done =
        evaluate(market, days, policy, {config.battery, config.initial_soc_frac, true}, records);
    value_charge_left(done, config.battery, price);
    return done;
  };
  const auto own = exported_policy(before);
  const auto refit = exported_policy(now);
  Proposal proposal{traded(*own, &path), traded(*refit, nullptr), {}, 0, {}};
  proposal.gain = paired_difference(proposal.now, proposal.before);
  for (const MarketDay& day : days) {
    for (const MarketStep& step : market.of(day)) {
      const double soc_frac = path[proposal.decisions++].soc_frac;
      const Action was = own->decide(step, 0, soc_frac);
      const Action is = refit->decide(step, 0, soc_frac);
      if (was != is) proposal.differing.push_back({step, soc_frac, was, is});
    }
  }
  return proposal;
}

std::string differing_decisions_csv(const Proposal& proposal) {
  std::string csv = "utc,price_eur_mwh,paid_eur_mwh,soc,before,now\n";
  for (const auto& [step, soc_frac, before, now] : proposal.differing) {
    csv += fmt::format("{},{},{},{:.4f},{},{}\n", utc_text(step.utc_s).view(),
                       step.observed_eur_per_mwh, step.paid_eur_per_mwh, soc_frac,
                       action_name(before), action_name(now));
  }
  return csv;
}

std::string proposal_text(const Proposal& proposal) {
  const auto& days = proposal.before.days;
  std::string text = fmt::format(
      "judged on {} days, {} to {}, that neither student learnt from; SoC carried over\n",
      days.size(), days.front().date, days.back().date);
  for (const auto& [name, of] : {std::pair("the run's student", &proposal.before),
                                 std::pair("the proposal's student", &proposal.now)}) {
    text += fmt::format("  {:<24} {:>9.1f} EUR a day and MWh {:>13.2f} EUR in all\n", name,
                        of->profit_eur_per_day_per_mwh(), total_eur(*of));
  }
  text += fmt::format("  {:<24} {:>+9.1f} with a standard error of {:.1f} (by month {})\n",
                      "gain, day by day", proposal.gain.mean, proposal.gain.standard_error,
                      error_text(proposal.gain.standard_error_by_month, 1));
  text += fmt::format("  {} of {} decisions would differ\n", proposal.differing.size(),
                      proposal.decisions);
  std::map<std::string, int> changes;
  for (const DifferingDecision& d : proposal.differing) ++changes[change_of(d)];
  for (const auto& [change, count] : changes) text += fmt::format("  {:>9} {}\n", count, change);
  return text;
}

Json proposal_json(const Proposal& proposal) {
  return Json::object(
      {{"days", proposal.before.days.size()},
       {"decisions", proposal.decisions},
       {"differing", proposal.differing.size()},
       {"before_eur", Decimals{total_eur(proposal.before), 4}},
       {"now_eur", Decimals{total_eur(proposal.now), 4}},
       {"gain_eur_per_day_per_mwh", Decimals{proposal.gain.mean, 4}},
       {"standard_error", Decimals{proposal.gain.standard_error, 4}},
       {"standard_error_by_month", Decimals{proposal.gain.standard_error_by_month, 4}}});
}

}  // namespace bess
