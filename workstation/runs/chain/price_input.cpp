#include "workstation/runs/chain/price_input.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "workstation/data/market/model/simulated_market.h"
#include "workstation/data/market/series/local_date.h"
#include "workstation/data/market/series/plausibility.h"

namespace bess {

namespace {

constexpr LocalDate kStart{2023, 1, 1};
constexpr int kDays = 365;
constexpr std::uint64_t kSeed = 1;

/// Reads the files again to name rows, only if there are findings.
void judge_files(const std::vector<Finding>& found, const std::vector<std::string>& files,
                 const AcceptedFindings& accepted) {
  if (found.empty()) return;
  std::vector<std::string> contents;
  contents.reserve(files.size());  // keeps the views of `texts` valid
  std::vector<PriceText> texts;
  for (const std::string& file : files) {
    contents.push_back(std::filesystem::is_regular_file(file) ? read_file(file) : std::string());
    texts.push_back({file, contents.back()});
  }
  judge(found, accepted, texts);
}

/// A month with fewer days is not reported.
constexpr int kDaysWorthNaming = 5;

std::string untrained_months(const MarketSteps& market, bool learns_by_month) {
  struct Days {
    int all = 0, training = 0;
  };
  std::map<std::string, Days> days_of;
  for (int month = 1; learns_by_month && month <= 12; ++month) days_of[fmt::format("{:02}", month)];
  for (const MarketDay& day : market.days) {
    const std::string name = fmt::format("{:04}-{:02}", day.year, day.month);
    Days& days = days_of[learns_by_month ? name.substr(5) : name];
    ++days.all;
    days.training += day.split == Split::kTrain ? 1 : 0;
  }
  std::string names;
  for (const auto& [name, days] : days_of) {
    if (days.training > 0 || (!learns_by_month && days.all < kDaysWorthNaming)) continue;
    names.append(names.empty() ? "" : ", ").append(name);
  }
  return names;
}

}  // namespace

MinuteSeries built_in_market() {
  const UtcSpan period{local_midnight_utc_s(kStart), local_midnight_utc_s(add_days(kStart, kDays))};
  return minutes_on_quarter_hours(simulate_quarter_hours(period, kSeed), kSeed);
}

std::string built_in_market_provenance() {
  return fmt::format("{}: {}, seed {}", kSimulatedProvenance, kBuiltInMarketName, kSeed);
}

void DayAheadInput::add(ProgramCommand& command) {
  command.option("--day-ahead", path,
                 "day-ahead prices for planning: file of 'prices fetch --day-ahead', "
                 "'prices import --day-ahead' or 'prices simulate --day-ahead-out'");
}

void DayAheadInput::attach_to(MarketSteps& market, const MinuteSeries& settled,
                              const AcceptedFindings& accepted,
                              const MarketOptions& options) const {
  if (path.empty()) return;
  attach_day_ahead(market,
                   read_day_ahead(path, settled, accepted, options.day_ahead_published_min));
}

std::shared_ptr<const DayAheadPublication> read_day_ahead(const std::string& path,
                                                          const MinuteSeries& settled,
                                                          const AcceptedFindings& accepted,
                                                          int published_min) {
  const std::string text = read_file(path);
  DayAheadSeries series = parse_day_ahead_csv(text, path);
  std::vector<Finding> found = implausible_day_ahead(series);
  for (Finding& finding : shifted_day_ahead(series, settled)) found.push_back(std::move(finding));
  judge(found, accepted, {{path, text}});
  return std::make_shared<DayAheadPublication>(std::move(series), published_min);
}

void write_judged_day_ahead(const JoinedDayAhead& joined, const AcceptedFindings& accepted,
                            const std::vector<std::string>& files, const std::string& provenance,
                            const std::string& out) {
  std::vector<Finding> found = joined.findings;
  for (Finding& finding : implausible_day_ahead(joined.series)) found.push_back(std::move(finding));
  judge_files(found, files, accepted);
  const std::string description = describe_day_ahead(joined);
  write_day_ahead_file(out, joined.series, provenance + "\n" + description);
  fmt::print("{}written to {}\n", description, out);
}

void PriceInput::add(ProgramCommand& command) {
  command
      .option("--accept", accept, "price checks to downgrade from errors to warnings, NAME[,NAME]")
      .value_name("NAMES")
      .check([](const std::string& list) -> std::string {
        try {
          static_cast<void>(AcceptedFindings(list));
        } catch (const UserError& error) {
          const std::string what = error.what();  // CLI11 adds the option name
          constexpr std::string_view kOption = "--accept: ";
          return what.starts_with(kOption) ? what.substr(kOption.size()) : what;
        }
        return {};
      });
}

MinuteSeries PriceInput::read(const std::string& path) const {
  return read_judged_minutes(path, accepted());
}

JoinedMarket PriceInput::read_joined(const std::vector<std::string>& files,
                                     std::set<MarketSource>* sources,
                                     const CustomCsvFormat& own) const {
  MarketRows rows = read_market_files(files, own);
  if (sources != nullptr) *sources = rows.sources;
  JoinedMarket market = join_market(std::move(rows), files.front());
  judge_market(market.series, market.report.findings, files, accepted());
  return market;
}

MarketSteps market_of(const MinuteSeries& series, const MarketOptions& options,
                      const std::string& name) {
  try {
    return make_market_steps(series, options);
  } catch (const UserError& error) {
    fail("{}: {}", name, error.what());
  }
}

void judge_market(const MinuteSeries& series, std::vector<Finding> found,
                  const std::vector<std::string>& files, const AcceptedFindings& accepted) {
  for (Finding& finding : implausible(series)) found.push_back(std::move(finding));
  judge_files(found, files, accepted);
}

void warn_untrained_months(const MarketSteps& market, bool learns_by_month) {
  const std::string names = untrained_months(market, learns_by_month);
  if (names.empty()) return;
  fmt::print(stderr,
             "bess-train: warning: no training day (local days 1 to 20) in {}{}: {} "
             "[untrained-months]\n",
             learns_by_month ? "months " : "", names,
             learns_by_month ? "a student by month is not trained for them; use a whole year or "
                               "[train] context = \"level\""
                             : "these days only validate and test");
}

}  // namespace bess
