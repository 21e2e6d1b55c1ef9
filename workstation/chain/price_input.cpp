#include "workstation/chain/price_input.h"

#include <fmt/format.h>

#include <map>

#include "shared/host/file.h"
#include "shared/host/user_error.h"

namespace bess {
namespace {

/// Fewer days of a month say nothing of how it was meant to be split.
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

void PriceInput::add(ProgramCommand& command) {
  command
      .option(
          "--accept", accept_,
          "Findings about the prices that are meant, NAME[,NAME]: a warning instead of an error")
      .check([](const std::string& list) -> std::string {
        try {
          static_cast<void>(AcceptedFindings(list));
        } catch (const UserError& error) {
          const std::string what = error.what();  // the option is named in front of it
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
                                     std::set<MarketSource>* sources, const OwnForm& own) const {
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
  if (found.empty()) return;
  std::vector<std::string> contents;
  contents.reserve(files.size());  // the texts are views of them
  std::vector<PriceText> texts;
  for (const std::string& file : files) {
    contents.push_back(std::filesystem::is_regular_file(file) ? read_file(file) : std::string());
    texts.push_back({file, contents.back()});
  }
  judge(found, accepted, texts);
}

void warn_untrained_months(const MarketSteps& market, bool learns_by_month) {
  const std::string names = untrained_months(market, learns_by_month);
  if (names.empty()) return;
  fmt::print(stderr,
             "bess-train: warning: no training day (local days 1 to 20) in {}{}: {} "
             "[untrained-months]\n",
             learns_by_month ? "months " : "", names,
             learns_by_month ? "a student by month learns nothing of them; give a whole year or "
                               "[train] context = \"level\""
                             : "these days only validate and test");
}

}  // namespace bess
