#include "edge/companions/page/controller_answers.h"

#include "edge/core/control/policy.h"
#include "edge/records/log/log_text.h"
#include "shared/host/json.h"
#include "shared/host/run_program.h"
#include "shared/local_time.h"
#include "shared/scaled_clock.h"
#include "shared/utc_text.h"

namespace bess {

DecisionMap make_decision_map(LatticeState at, const PriceThresholds& thresholds) {
  DecisionMap map;
  for (int i = 0; i < kSocCount; ++i) {
    at.soc_index = static_cast<std::int16_t>(i);
    map[static_cast<std::size_t>(i)] = find_margins(at, 0, thresholds, decide_with_student);
  }
  return map;
}

Json decision_map_of(JsonValue why) {
  const auto whole = [](JsonValue value, std::int32_t otherwise) {
    return static_cast<std::int32_t>(value.number().value_or(otherwise));
  };
  std::int64_t utc_s = 0;
  const std::int32_t context = whole(why["context_class"], 0);
  const bool is_decided = why["margins"].is_object() && parse_utc(why["utc"].text_or(""), utc_s) &&
                          context >= 1 && context <= kContextClassCount;
  if (!is_decided || why["is_other_student"].boolean().value_or(true)) {
    return Json::object({{"columns", Json::list()}});
  }
  PriceThresholds thresholds;
  const JsonValue set = why["thresholds"];
  thresholds.low_eur_per_mwh =
      whole(set["charge_at_or_below_eur_per_mwh"], thresholds.low_eur_per_mwh);
  thresholds.high_eur_per_mwh =
      whole(set["discharge_at_or_above_eur_per_mwh"], thresholds.high_eur_per_mwh);
  const LatticeState at =
      make_lattice_state(local_minute_of(utc_s), static_cast<std::int16_t>(context), 0, 0);
  const DecisionMap map = make_decision_map(at, thresholds);
  Json columns = Json::list();
  for (int i = 0; i < kSocCount; ++i) {
    const Margins& column = map[static_cast<std::size_t>(i)];
    columns.add(Json::object(
        {{"soc_percent", Decimals{100.0 * i / (kSocCount - 1), 1}},
         {"charge_up_to_eur_per_mwh", Decimals{eur_of(column.charge_up_to_centi), 2}},
         {"discharge_from_eur_per_mwh", Decimals{eur_of(column.discharge_from_centi), 2}}}));
  }
  return Json::object({{"columns", std::move(columns)}});
}

namespace {

constexpr std::int64_t kAnswerS = 10;
constexpr int kSignalled = 128;  ///< exit codes from here on are signals

}  // namespace

std::int64_t Answer::age_ns() const { return clock_ns(CLOCK_MONOTONIC) - made_monotonic_ns; }

Answer ask_controller(const PageSettings& settings, std::vector<std::string> words, bool is_json) {
  words.insert(words.begin(), settings.program);
  words.insert(words.end(), {"--config", settings.config_path});
  ProgramResult result = run_and_capture(words, kAnswerS);
  // A degraded or stopped controller has another exit code and still gives an answer.
  const bool has_ended = result.trouble.empty() && result.exit_code < kSignalled;
  const bool is_answer =
      is_json ? Json::parse(result.output).value().exists() : !result.output.empty();
  Answer answer;
  if (has_ended && is_answer) {
    answer.text = std::move(result.output);
  } else {
    answer.trouble = result.complaint();
  }
  answer.made_monotonic_ns = clock_ns(CLOCK_MONOTONIC);
  return answer;
}

std::shared_ptr<const Answer> CachedAnswer::fresh() {
  const std::scoped_lock lock(lock_);
  const bool is_fresh = kept_ != nullptr && kept_->age_ns() < keep_s_ * kNanosecondsPerSecond;
  return is_fresh ? kept_ : nullptr;
}

std::shared_ptr<const Answer> CachedAnswer::newest() {
  if (auto answer = fresh()) return answer;
  std::unique_lock making(making_, std::try_to_lock);
  if (!making.owns_lock()) {
    // Another thread is fetching: use the old answer, except for the first.
    {
      const std::scoped_lock lock(lock_);
      if (kept_ != nullptr) return kept_;
    }
    making.lock();
  }
  if (auto answer = fresh()) return answer;
  auto made = std::make_shared<const Answer>(make_());
  const std::scoped_lock lock(lock_);
  return kept_ = std::move(made);
}

}  // namespace bess
