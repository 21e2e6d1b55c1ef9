#include "workstation/runs/run/refresh.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "shared/host/file.h"
#include "shared/host/json_reader.h"
#include "shared/host/user_error.h"
#include "shared/utc_text.h"
#include "workstation/correction/student/exported_policy.h"
#include "workstation/data/env/charge_left.h"
#include "workstation/runs/chain/chain_steps.h"
#include "workstation/runs/chain/folder_lock.h"
#include "workstation/runs/chain/price_input.h"
#include "workstation/runs/run/run_backtest.h"
#include "workstation/runs/run/run_report.h"
#include "workstation/runs/run/run_stages.h"

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
  std::string text =
      fmt::format("evaluated on {} days, {} to {}, not used in training; SoC carried over\n",
                  days.size(), days.front().date, days.back().date);
  for (const auto& [name, of] : {std::pair("the run's student", &proposal.before),
                                 std::pair("the candidate's student", &proposal.now)}) {
    text += fmt::format("  {:<24} {:>9.1f} EUR per day and MWh {:>13.2f} EUR in total\n", name,
                        of->profit_eur_per_day_per_mwh(), total_eur(*of));
  }
  text += fmt::format("  {:<24} {:>+9.1f} standard error {:.1f} (by month {})\n",
                      "gain, day by day", proposal.gain.mean, proposal.gain.standard_error,
                      error_text(proposal.gain.standard_error_by_month, 1));
  text +=
      fmt::format("  {} of {} decisions differ\n", proposal.differing.size(), proposal.decisions);
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

namespace {

namespace fs = std::filesystem;
using namespace run_file;

// Files of a candidate, in addition to those of a run.
constexpr const char* kMarket = "market.csv.gz";
constexpr const char* kDayAhead = "day_ahead.csv.gz";
constexpr const char* kDecisions = "differing_decisions.csv";
constexpr const char* kText = "proposal.txt";
constexpr const char* kJudgement = "proposal.json";

struct Judgement {
  std::string against;  ///< mark of the student that it was compared with
  std::string refusal;  ///< reason against adoption; may be empty
  std::string last_day;
};

std::optional<Judgement> load_judgement(const RunFolder& proposal) {
  const fs::path path = proposal.file(kJudgement);
  if (!fs::exists(path)) return std::nullopt;
  const Json json = Json::parse(read_file(path));
  const JsonReader in(json.value(), path.string(), "a candidate's verdict");
  return Judgement{in.text("against"), in.text("refusal"), in.text("last_day")};
}

/// Appends a number if the folder exists.
fs::path free_name(const fs::path& path) {
  fs::path name = path;
  for (int n = 2; fs::exists(name); ++n) name = fmt::format("{}-{}", path.string(), n);
  return name;
}

/// Latest days that the run's student was not trained on; none when they are too few.
std::optional<FoldDays> fold_of(const MarketSteps& market, const std::string& last_learnt,
                                int window_days) {
  const LocalDate last = parse_local_date(market.days.back().date(), "prices");
  const LocalDate learnt = parse_local_date(last_learnt, "run.json: last_learnt_day");
  const LocalDate first = std::max(add_days(last, 1 - kJudgedDays), add_days(learnt, 1));
  const auto judged = std::ranges::count_if(market.days, [&](const MarketDay& day) {
    return LocalDate{day.year, day.month, day.day} >= first;
  });
  if (judged < kJudgedDaysMin) return std::nullopt;
  return FoldDays{first, last, window_days};
}

class Refresh {
 public:
  Refresh(const RefreshRequest& request, std::FILE* messages)
      : request_(request), messages_(messages), run_{fs::weakly_canonical(request.run)} {
    if (!run_.path.has_filename()) run_.path = run_.path.parent_path();  // trailing slash
    proposal_ = {beside("proposal")};
  }

  void go() const {
    finish_adoption();
    const RunRecord present = load_run_summary(run_).record;
    const FolderLock lock(run_.path);
    fs::create_directories(proposal_.path);
    const FolderLock proposal_lock(proposal_.path);
    if (!load_judgement(proposal_) && !make_proposal(present)) return;
    const Judgement judgement = *load_judgement(proposal_);
    tell("{}", read_file(proposal_.file(kText)));
    if (judgement.against != file_mark(run_.file(kStudent))) {
      fail("{}: evaluated against another student than that of {}; remove the folder and repeat",
           proposal_.path.string(), run_.path.string());
    }
    if (!judgement.refusal.empty()) return refuse(judgement);
    if (request_.adopt) return adopt(judgement);
    tell("{}: not worse; to adopt it: bess-train refresh --run {} --adopt\n",
         proposal_.path.string(), run_.path.string());
  }

 private:
  template <typename... Args>
  void tell(fmt::format_string<Args...> format, Args&&... args) const {
    fmt::print(messages_, format, std::forward<Args>(args)...);
    std::fflush(messages_);
  }

  [[nodiscard]] fs::path beside(const std::string& what) const {
    return run_.path.string() + "." + what;
  }

  /// Completes an adoption that was interrupted between its two renames.
  void finish_adoption() const {
    if (fs::exists(run_.path)) return;
    const std::optional<Judgement> judgement = load_judgement(proposal_);
    if (!judgement || !judgement->refusal.empty()) return;
    if (!fs::exists(beside("before-" + judgement->last_day))) return;
    fs::rename(proposal_.path, run_.path);
    tell("{}: completed an interrupted adoption\n", run_.path.string());
  }

  /// False, with a message, when there is no candidate.
  [[nodiscard]] bool make_proposal(const RunRecord& present) const {
    std::optional<RunRecord> record = load_run_record(proposal_);
    if (!record && !(record = begin(present))) {
      fs::remove_all(proposal_.path);
      return false;
    }
    const MinuteSeries series = read_minute_file(proposal_.file(kMarket));
    end_when_interrupted("finished stages are kept: repeat the command to continue");
    RunStages stages(proposal_, *record, series, messages_);
    const FoldDays days = *parse_fold_days(record->value(kFoldKey));
    Json json = Json::object(
        {{"against", file_mark(run_.file(kStudent))}, {"last_day", format_local_date(days.last)}});
    try {
      stages.finish();
      note(judge_refit(load_student(run_.file(kStudent)), load_student(proposal_.file(kStudent)),
                       stages.market(), record->config(proposal_)),
           json);
    } catch (const ProofFailed& failed) {
      json.set("refusal", "not proved");
      write_file(proposal_.file(kText), fmt::format("{}\n", failed.what()));
    }
    write_file(proposal_.file(kJudgement), json.text());
    return true;
  }

  /// Provides prices and creates the record of the candidate; none without new days.
  [[nodiscard]] std::optional<RunRecord> begin(const RunRecord& present) const {
    const RunConfig config = present.config(run_);
    request_.bring_prices(proposal_.file(kMarket));
    const MinuteSeries series = read_minute_file(proposal_.file(kMarket));
    const MarketSteps market = market_of(series, config.market, "these prices");
    const std::string learnt = present.figures->last_learnt_day;
    const std::optional<FoldDays> days = fold_of(market, learnt, request_.window_days);
    if (!days) {
      tell(
          "{}: trained on days up to {}, and prices end on {}: a candidate needs {} days after "
          "training\n",
          run_.path.string(), learnt, market.days.back().date(), kJudgedDaysMin);
      return std::nullopt;
    }
    (void)market_of_fold(market, days->name());  // throws if days are missing
    const RunRecord record = record_of(config, present.is_lean(), series, *days);
    for (const fs::path& place : {run_.path, beside("refused-" + format_local_date(days->last))}) {
      const std::optional<RunRecord> there = load_run_record({place});
      if (!there || !differences(there->identity, record.identity).empty()) continue;
      tell("{}: already trained on these days; no candidate\n", place.string());
      return std::nullopt;
    }
    save_run_record(proposal_, record);
    return record;
  }

  [[nodiscard]] RunRecord record_of(const RunConfig& config, bool is_lean,
                                    const MinuteSeries& series, const FoldDays& days) const {
    RunRecord record;
    record.prices = kMarket;
    record.prices_name = fmt::format("prices to {}", format_local_date(days.last));
    record.identity = identity_of(config, prices_hash(series), "");
    record.identity.emplace_back(kFoldKey, days.name());
    if (is_lean) record.identity.emplace_back(kStagesKey, kLean);
    if (config.train.context != ContextKind::kOutlook) return record;
    record.day_ahead = kDayAhead;
    request_.bring_day_ahead(proposal_.file(kDayAhead), series);
    record.identity.emplace_back(kDayAheadKey, file_mark(proposal_.file(kDayAhead)));
    return record;
  }

  void note(const Proposal& proposal, Json& json) const {
    write_file(proposal_.file(kDecisions), differing_decisions_csv(proposal));
    write_file(proposal_.file(kText), proposal_text(proposal));
    json.set("refusal", proposal.is_worse() ? "worse by more than its standard error" : "");
    json.set("judged", proposal_json(proposal));
  }

  void refuse(const Judgement& judgement) const {
    fs::path place = proposal_.path;
    if (request_.adopt) {
      place = free_name(beside("refused-" + judgement.last_day));
      fs::rename(proposal_.path, place);
    }
    tell("{}: rejected: {}; {} is unchanged\n", place.string(), judgement.refusal,
         run_.path.string());
  }

  void adopt(const Judgement& judgement) const {
    const fs::path before = free_name(beside("before-" + judgement.last_day));
    fs::rename(run_.path, before);
    fs::rename(proposal_.path, run_.path);
    tell(
        "{}: adopted; the previous run is {}\nto install it on a controller: tools/flash "
        "update-weights HOST --student {}\n",
        run_.path.string(), before.string(), run_.file(kStudent).string());
  }

  const RefreshRequest& request_;
  std::FILE* messages_;
  RunFolder run_, proposal_;
};

}  // namespace

void refresh(const RefreshRequest& request, std::FILE* messages) {
  Refresh(request, messages).go();
}

}  // namespace bess
