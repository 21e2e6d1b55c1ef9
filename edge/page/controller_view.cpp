#include "edge/page/controller_view.h"

#include <algorithm>

#include "edge/control/policy.h"
#include "edge/log/log_reader.h"
#include "shared/host/run_program.h"
#include "shared/host/text.h"
#include "shared/local_time.h"
#include "shared/scaled_clock.h"

namespace bess {
namespace {

constexpr std::int64_t kAnswerS = 10;

Answer ask(const PageSettings& settings, std::vector<std::string> words) {
  words.insert(words.begin(), settings.program);
  words.insert(words.end(), {"--config", settings.config_path});
  const ProgramResult result = run_and_hear(words, kAnswerS);
  Answer answer;
  answer.json = Json::parse(result.output);
  if (!answer.json.value().exists()) {
    answer.json = Json::object();
    answer.trouble = result.complaint();
  }
  return answer;
}

/// Cycles of the day, oldest first: a clock that was stepped may have written one twice, and then
/// the newer counts.
void read_day(const PageSettings& settings, ControllerView& view) {
  EventLogSettings places;
  if (!places.ring.assign(settings.ring) || !places.run_ring.assign(settings.run_ring)) return;
  LogReader log;
  FileMessage ignored;
  CycleRecord record;
  if (!log.open(places, ignored) || !log.newest(record)) return;
  view.day = day_span_at(record.utc_s);
  for (std::uint64_t n = log.newest_number(); n >= log.oldest_number() && n > 0; --n) {
    if (!log.read(n, record)) continue;
    if (record.utc_s < view.day.start_utc_s) break;
    const bool is_later =
        !view.day_records.empty() && record.utc_s >= view.day_records.back().utc_s;
    if (!is_later && record.mode != Mode::kStopping) view.day_records.push_back(record);
  }
  std::reverse(view.day_records.begin(), view.day_records.end());
}

PriceThresholds thresholds_of(JsonValue why) {
  const auto whole = [&](const char* key, std::int32_t otherwise) {
    return static_cast<std::int32_t>(why["thresholds"][key].number().value_or(otherwise));
  };
  PriceThresholds thresholds;
  thresholds.low_eur_per_mwh = whole("charge_at_or_below_eur_per_mwh", thresholds.low_eur_per_mwh);
  thresholds.high_eur_per_mwh =
      whole("discharge_at_or_above_eur_per_mwh", thresholds.high_eur_per_mwh);
  return thresholds;
}

void map_decisions(ControllerView& view) {
  if (view.day_records.empty()) return;
  const CycleRecord& newest = view.day_records.back();
  if (!newest.has_student_action || newest.context_class == 0) return;
  const std::int32_t price_centi = newest.price.price_centi_eur_per_mwh;
  const LatticeState at = make_lattice_state(local_minute_of(newest.utc_s), newest.context_class,
                                             newest.measurement.soc_e4, price_centi);
  view.map = make_decision_map(at, thresholds_of(view.why.json.value()), decide_with_student);
  view.now = {newest.measurement.soc_e4 / 100.0, static_cast<double>(price_centi) / kCentiPerEur};
}

}  // namespace

ControllerView look_at_controller(const PageSettings& settings) {
  ControllerView view;
  view.status = ask(settings, {"status", "--json", "--no-lock"});
  view.why = ask(settings, {"why", "--json"});
  view.month = ask(settings, {"earned", "month", "--json"});
  const ProgramResult metrics = run_and_hear(
      {settings.program, "status", "--prometheus", "--no-lock", "--config", settings.config_path},
      kAnswerS);
  // A degraded controller says so by the exit code, and gives its metrics.
  if (metrics.trouble.empty()) view.metrics = metrics.output;
  const ProgramResult history = run_and_hear({settings.program, "history", "--json"}, kAnswerS);
  view.history.json = Json::parse(history.output);
  if (!history.is_well() || !view.history.json.value().exists()) {
    view.history.json = Json::list();
    view.history.trouble = history.complaint();
  }
  read_day(settings, view);
  map_decisions(view);
  view.made_monotonic_ns = clock_ns(CLOCK_MONOTONIC);
  view.made_utc_s = clock_ns(CLOCK_REALTIME) / kNanosecondsPerSecond;
  return view;
}

bool ControllerViews::is_fresh() const {
  if (view_ == nullptr || is_expired_) return false;
  const std::int64_t age_ns = clock_ns(CLOCK_MONOTONIC) - view_->made_monotonic_ns;
  return age_ns < settings_.refresh_s * kNanosecondsPerSecond;
}

std::shared_ptr<const ControllerView> ControllerViews::newest() {
  std::unique_lock making(making_, std::defer_lock);
  {
    const std::scoped_lock lock(view_lock_);
    if (is_fresh()) return view_;
    // Somebody is at it: what there is must do, but for the very first.
    if (!making.try_lock() && view_ != nullptr) return view_;
  }
  if (!making.owns_lock()) making.lock();
  {
    const std::scoped_lock lock(view_lock_);
    if (is_fresh()) return view_;
    is_expired_ = false;  // what is ordered from here on is not in the view that is made now
  }
  auto made = std::make_shared<const ControllerView>(look_at_controller(settings_));
  const std::scoped_lock lock(view_lock_);
  view_ = std::move(made);
  return view_;
}

void ControllerViews::expire() {
  const std::scoped_lock lock(view_lock_);
  is_expired_ = true;
}

}  // namespace bess
