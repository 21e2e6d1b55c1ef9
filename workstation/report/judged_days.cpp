#include "workstation/report/judged_days.h"

#include <fmt/core.h>

#include <algorithm>
#include <set>

#include "shared/host/text.h"

namespace bess {
namespace {

/// As the split is made in env/market_steps.cpp.
struct SplitMeaning {
  Split split;
  const char* name;
  const char* local_days;
};
constexpr SplitMeaning kMeanings[] = {
    {Split::kTrain, "Training days", "1 to 20"},
    {Split::kValidation, "Validation days", "21 to 25"},
    {Split::kTest, "Test days", "26 to the end"},
    {Split::kHeldOut, "Validation and test days", "21 to the end"},
    {Split::kAll, "All days", "1 to the end"},
};

const SplitMeaning& meaning_of(Split split) {
  return *std::ranges::find(kMeanings, split, &SplitMeaning::split);
}

}  // namespace

std::size_t JudgedDays::before_last_learnt() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(dates, [&](const std::string& date) { return date < last_learnt; }));
}

std::size_t JudgedDays::months() const {
  std::set<std::string> months;
  for (const std::string& date : dates) months.insert(date.substr(0, 7));
  return months.size();
}

std::string last_learnt_day(const MarketSteps& market) {
  std::string last;
  for (const MarketDay& day : market.days) {
    if (day.split == Split::kTrain || day.split == Split::kValidation) last = day.date();
  }
  return last;
}

JudgedDays judged_days(const MarketSteps& market, Split split) {
  JudgedDays judged{split, {}, last_learnt_day(market)};
  for (const MarketDay& day : market.days_of(split)) judged.dates.push_back(day.date());
  return judged;
}

std::string judged_days_text(const JudgedDays& judged) {
  const SplitMeaning& meaning = meaning_of(judged.split);
  const std::size_t days = judged.dates.size();
  std::string text =
      fmt::format("{}: local days {} of each month, {} in {} from {} to {}.", meaning.name,
                  meaning.local_days, counted(days, "day"), counted(judged.months(), "month"),
                  judged.dates.front(), judged.dates.back());
  if (judged.last_learnt.empty()) return text;
  const std::size_t earlier = judged.before_last_learnt();
  if (earlier == 0) {
    return text + fmt::format(" All of them come after the days that were learnt from, to {}.",
                              judged.last_learnt);
  }
  return text + fmt::format(
                    " Learning saw days to {}, later than {} of them: what is learnt before it "
                    "trades may earn less.",
                    judged.last_learnt, earlier == days ? "all" : fmt::format("{}", earlier));
}

Json judged_days_json(const JudgedDays& judged) {
  Json json = Json::object({{"split", split_name(judged.split)},
                            {"local_days", meaning_of(judged.split).local_days},
                            {"days", judged.dates.size()},
                            {"months", judged.months()},
                            {"from", judged.dates.front()},
                            {"to", judged.dates.back()}});
  const bool is_told = !judged.last_learnt.empty();
  json.set("last_learnt_day", is_told ? Json(judged.last_learnt) : Json::null());
  json.set("days_before_last_learnt", is_told ? Json(judged.before_last_learnt()) : Json::null());
  return json;
}

}  // namespace bess
