#include "workstation/runs/run/refresh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <map>
#include <optional>

#include "shared/host/file.h"
#include "shared/host/json_reader.h"
#include "shared/host/user_error.h"
#include "shared/utc_text.h"
#include "workstation/correction/student/student_policy.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/runs/chain/chain_steps.h"
#include "workstation/runs/chain/common_options.h"
#include "workstation/runs/chain/folder_lock.h"
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

Json candidate_json(const CandidateRun& candidate) {
  return Json::object({{"days", candidate.before.days.size()},
                       {"decisions", candidate.decisions},
                       {"differing", candidate.differing.size()},
                       {"before_eur", Decimals{total_eur(candidate.before), 4}},
                       {"now_eur", Decimals{total_eur(candidate.now), 4}},
                       {"gain_eur_per_day_per_mwh", Decimals{candidate.gain.mean, 4}},
                       {"standard_error", Decimals{candidate.gain.errors.plain, 4}},
                       {"standard_error_by_month", Decimals{candidate.gain.errors.by_month, 4}}});
}

namespace fs = std::filesystem;
using namespace run_file;

// Files of a candidate, in addition to those of a run.
constexpr const char* kMarket = "market.csv.gz";
constexpr const char* kDayAhead = "day_ahead.csv.gz";
constexpr const char* kDecisions = "differing_decisions.csv";
constexpr const char* kText = "proposal.txt";
constexpr const char* kCandidateVerdict = "proposal.json";

struct CandidateVerdict {
  std::string against;  ///< mark of the student that it was compared with
  std::string refusal;  ///< reason against adoption; may be empty
  std::string last_day;
};

std::optional<CandidateVerdict> load_verdict(const RunFolder& candidate) {
  const fs::path path = candidate.file(kCandidateVerdict);
  if (!fs::exists(path)) return std::nullopt;
  const Json json = Json::parse(read_file(path));
  const JsonReader in(json.value(), path.string(), "a candidate's verdict");
  return CandidateVerdict{in.text("against"), in.text("refusal"), in.text("last_day")};
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
  explicit Refresh(const RefreshRequest& request)
      : request_(request), run_{fs::weakly_canonical(request.run)} {
    if (!run_.path.has_filename()) run_.path = run_.path.parent_path();  // trailing slash
    candidate_ = {sibling("proposal")};
  }

  void go() const {
    finish_adoption();
    const RunRecord present = load_run_summary(run_).record;
    const FolderLock lock(run_.path);
    fs::create_directories(candidate_.path);
    const FolderLock proposal_lock(candidate_.path);
    if (!load_verdict(candidate_) && !make_proposal(present)) {
      fs::remove_all(candidate_.path);
      return;
    }
    const CandidateVerdict verdict = *load_verdict(candidate_);
    report_line("{}", read_file(candidate_.file(kText)));
    if (verdict.against != file_mark(run_.file(kStudent))) {
      fail("{}: evaluated against another student than that of {}; remove the folder and repeat",
           candidate_.path.string(), run_.path.string());
    }
    if (!verdict.refusal.empty()) return refuse(verdict);
    if (request_.adopt) return adopt(verdict);
    report_line("{}: not worse; to adopt it: bess-train refresh --run {} --adopt\n",
                candidate_.path.string(), run_.path.string());
  }

 private:
  template <typename... Args>
  void report_line(fmt::format_string<Args...> format, Args&&... args) const {
    fmt::print(format, std::forward<Args>(args)...);
    std::fflush(stdout);
  }

  [[nodiscard]] fs::path sibling(const std::string& what) const {
    return run_.path.string() + "." + what;
  }

  /// Completes an adoption that was interrupted between its two renames.
  void finish_adoption() const {
    if (fs::exists(run_.path)) return;
    const std::optional<CandidateVerdict> verdict = load_verdict(candidate_);
    if (!verdict || !verdict->refusal.empty()) return;
    if (!fs::exists(sibling("before-" + verdict->last_day))) return;
    fs::rename(candidate_.path, run_.path);
    report_line("{}: completed an interrupted adoption\n", run_.path.string());
  }

  /// False, with a message, when there is no candidate.
  [[nodiscard]] bool make_proposal(const RunRecord& present) const {
    std::optional<RunRecord> record = load_run_record(candidate_);
    if (!record) {
      try {
        record = begin(present);
      } catch (...) {
        std::error_code failed;
        fs::remove(candidate_.path, failed);  // unless it has a download to continue
        throw;
      }
    }
    if (!record) return false;
    const MinuteSeries series = read_minute_file(candidate_.file(kMarket));
    end_when_interrupted("finished stages are kept: repeat the command to continue");
    RunStages stages(candidate_, *record, series, stdout);
    const FoldDays days = *parse_fold_days(record->value(kFoldKey));
    Json json = Json::object(
        {{"against", file_mark(run_.file(kStudent))}, {"last_day", format_local_date(days.last)}});
    try {
      stages.finish();
      note(judge_refit(load_student(run_.file(kStudent)), load_student(candidate_.file(kStudent)),
                       stages.market(), record->config(candidate_)),
           json);
    } catch (const ProofFailed& failed) {
      json.set("refusal", "not proved");
      write_file(candidate_.file(kText), fmt::format("{}\n", failed.what()));
    }
    write_file(candidate_.file(kCandidateVerdict), json.text());
    return true;
  }

  /// Past days that a candidate may need, and ten for the price level to settle.
  [[nodiscard]] FetchSpan fetched_span() const {
    constexpr int kSettlingDays = 10;
    const LocalDate yesterday = add_days(local_date_of(std::time(nullptr)), -1);
    return {add_days(yesterday, -kJudgedDays - request_.window_days - kSettlingDays), yesterday};
  }

  void provide_prices(const fs::path& out) const {
    if (!request_.prices.empty()) {
      return write_minute_file(out, request_.price_input.read_joined(request_.prices).series,
                               "From " + file_names(request_.prices));
    }
    watch_interruption();
    const auto fetched = fetch_prices({.span = fetched_span(),
                                       .out = out,
                                       .base_url = checked_base_url(request_.source, "--base-url"),
                                       .now_utc_s = std::time(nullptr),
                                       .retry = {},
                                       .allow_gaps = true,  // incomplete days are skipped
                                       .accepted = request_.price_input.accepted(),
                                       .sleep = sleep_unless},
                                      interruption());
    if (!fetched) throw Interrupted{};
    fmt::print("{}", fetched->description);
  }

  void fetch_day_ahead_to(const fs::path& out) const {
    watch_interruption();
    const std::string url = checked_base_url(request_.day_ahead_source, "--day-ahead-base-url");
    const auto fetched = fetch_day_ahead({.span = fetched_span(),
                                          .base_url = url,
                                          .now_utc_s = std::time(nullptr),
                                          .retry = {},
                                          .allow_gaps = true,
                                          .sleep = sleep_unless},
                                         interruption());
    if (!fetched) throw Interrupted{};
    write_day_ahead_file(out, fetched->series, "Day-ahead prices fetched from " + url);
  }

  void provide_day_ahead(const fs::path& out, const MinuteSeries& settled) const {
    if (!request_.day_ahead.path.empty()) {
      write_file(out, read_file(request_.day_ahead.path));
    } else if (request_.prices.empty()) {
      fetch_day_ahead_to(out);
    } else {
      fail(
          "the run plans on day-ahead prices: with --prices, also give their file with "
          "--day-ahead");
    }
    (void)read_day_ahead(out, settled, request_.price_input.accepted(), kDayAheadPublishedMin);
  }

  /// Provides prices and creates the record of the candidate; none without new days.
  [[nodiscard]] std::optional<RunRecord> begin(const RunRecord& present) const {
    const RunConfig config = present.config(run_);
    provide_prices(candidate_.file(kMarket));
    const MinuteSeries series = read_minute_file(candidate_.file(kMarket));
    const MarketSteps market = market_of(series, config.market, "these prices");
    const std::string learnt = present.figures->last_learnt_day;
    const std::optional<FoldDays> days = fold_of(market, learnt, request_.window_days);
    if (!days) {
      report_line(
          "{}: trained on days up to {}, and prices end on {}: a candidate needs {} days after "
          "training\n",
          run_.path.string(), learnt, market.days.back().date(), kJudgedDaysMin);
      return std::nullopt;
    }
    (void)market_of_fold(market, days->name());  // throws if days are missing
    const RunRecord record = record_of(config, present.is_lean(), series, *days);
    for (const fs::path& place : {run_.path, sibling("refused-" + format_local_date(days->last))}) {
      const std::optional<RunRecord> there = load_run_record({place});
      if (!there || !differences(there->identity, record.identity).empty()) continue;
      report_line("{}: already trained on these days; no candidate\n", place.string());
      return std::nullopt;
    }
    save_run_record(candidate_, record);
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
    provide_day_ahead(candidate_.file(kDayAhead), series);
    record.identity.emplace_back(kDayAheadKey, file_mark(candidate_.file(kDayAhead)));
    return record;
  }

  void note(const CandidateRun& candidate, Json& json) const {
    write_file(candidate_.file(kDecisions), differing_decisions_csv(candidate));
    write_file(candidate_.file(kText), candidate_text(candidate));
    json.set("refusal", candidate.is_worse() ? "worse by more than its standard error" : "");
    json.set("judged", candidate_json(candidate));
  }

  void refuse(const CandidateVerdict& verdict) const {
    fs::path place = candidate_.path;
    if (request_.adopt) {
      place = free_name(sibling("refused-" + verdict.last_day));
      fs::rename(candidate_.path, place);
    }
    report_line("{}: rejected: {}; {} is unchanged\n", place.string(), verdict.refusal,
                run_.path.string());
  }

  void adopt(const CandidateVerdict& verdict) const {
    const fs::path before = free_name(sibling("before-" + verdict.last_day));
    fs::rename(run_.path, before);
    fs::rename(candidate_.path, run_.path);
    report_line(
        "{}: adopted; the previous run is {}\nto install it on a controller: tools/flash "
        "update-weights HOST --student {}\n",
        run_.path.string(), before.string(), run_.file(kStudent).string());
  }

  const RefreshRequest& request_;
  RunFolder run_, candidate_;
};

}  // namespace

CandidateRun judge_refit(const StudentFile& before, const StudentFile& now,
                         const MarketSteps& market, const RunConfig& config) {
  const std::vector<MarketDay> days = market.days_of(Split::kTest);
  std::vector<StepRecord> path;
  const auto traded = [&](Policy& policy, std::vector<StepRecord>* records) {
    return evaluate_carried_over(market, days, policy, config.battery, config.initial_soc_frac,
                                 records);
  };
  const auto own = exported_policy(before);
  const auto refit = exported_policy(now);
  CandidateRun candidate{traded(*own, &path), traded(*refit, nullptr), {}, 0, {}};
  candidate.gain = paired_difference(candidate.now, candidate.before);
  for (const MarketDay& day : days) {
    for (const MarketStep& step : market.of(day)) {
      const double soc_frac = path[candidate.decisions++].soc_frac;
      const Action was = own->decide(step, 0, soc_frac);
      const Action is = refit->decide(step, 0, soc_frac);
      if (was != is) candidate.differing.push_back({step, soc_frac, was, is});
    }
  }
  return candidate;
}

std::string differing_decisions_csv(const CandidateRun& candidate) {
  std::string csv = "utc,price_eur_mwh,paid_eur_mwh,soc,before,now\n";
  for (const auto& [step, soc_frac, before, now] : candidate.differing) {
    csv += fmt::format("{},{},{},{:.4f},{},{}\n", utc_text(step.utc_s).view(),
                       step.observed_eur_per_mwh, step.paid_eur_per_mwh, soc_frac,
                       action_name(before), action_name(now));
  }
  return csv;
}

std::string candidate_text(const CandidateRun& candidate) {
  const auto& days = candidate.before.days;
  std::string text =
      fmt::format("evaluated on {} days, {} to {}, not used in training; SoC carried over\n",
                  days.size(), days.front().date, days.back().date);
  for (const auto& [name, of] : {std::pair("the run's student", &candidate.before),
                                 std::pair("the candidate's student", &candidate.now)}) {
    text += fmt::format("  {:<24} {:>9.1f} EUR per day and MWh {:>13.2f} EUR in total\n", name,
                        of->profit_eur_per_day_per_mwh(), total_eur(*of));
  }
  text += fmt::format("  {:<24} {:>+9.1f} standard error {:.1f} (by month {})\n",
                      "gain, day by day", candidate.gain.mean, candidate.gain.errors.plain,
                      error_text(candidate.gain.errors.by_month, 1));
  text +=
      fmt::format("  {} of {} decisions differ\n", candidate.differing.size(), candidate.decisions);
  std::map<std::string, int> changes;
  for (const DifferingDecision& d : candidate.differing) {
    ++changes[fmt::format("{} -> {}", action_name(d.before), action_name(d.now))];
  }
  for (const auto& [change, count] : changes) text += fmt::format("  {:>9} {}\n", count, change);
  return text;
}

void refresh(const RefreshRequest& request) { Refresh(request).go(); }

}  // namespace bess
