#include "edge/update/trial_cycles.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <iterator>

#include "shared/host/run_program.h"
#include "shared/host/text.h"
#include "shared/host/toml_document.h"

namespace bess {
namespace {

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    fields.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return fields;
}

/// One line under its header; what is not there is empty.
class Row {
 public:
  Row(const std::vector<std::string_view>& header, std::string_view line)
      : header_(header), fields_(fields_of(line)) {}

  [[nodiscard]] bool is_whole() const { return fields_.size() == header_.size(); }
  [[nodiscard]] std::string_view text(std::string_view name) const {
    const auto found = std::find(header_.begin(), header_.end(), name);
    const auto at = static_cast<std::size_t>(found - header_.begin());
    return at < fields_.size() ? fields_[at] : std::string_view();
  }
  [[nodiscard]] std::int64_t whole(std::string_view name) const {
    const std::string_view digits = text(name);
    std::int64_t value = 0;
    std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return value;
  }

 private:
  const std::vector<std::string_view>& header_;
  std::vector<std::string_view> fields_;
};

/// First whose fault is beyond doubt: a trip stands whatever else is away.
TrialCause cause_of(const Row& row) {
  const std::string_view reason = row.text("reason");
  const auto is_any = [&](std::initializer_list<std::string_view> names) {
    return std::find(names.begin(), names.end(), reason) != names.end();
  };
  if (row.text("trip") != "none") return TrialCause::kTrip;
  if (reason == "clock") return TrialCause::kClock;
  if (row.text("battery_status") != "ok" || reason == "link") return TrialCause::kLink;
  if (reason == "off_grid") return TrialCause::kOffGrid;
  if (is_any({"alarm", "temperature"})) return TrialCause::kAlarm;
  const bool has_price = row.text("price_minute_utc") != "none";
  if (!has_price || row.text("price_status") != "ok") return TrialCause::kPrice;
  if (is_any({"no_price", "price_age", "price_quarter_hour", "frozen_price"})) {
    return TrialCause::kPrice;
  }
  return row.text("hold_until_utc") == "none" ? TrialCause::kNone : TrialCause::kHold;
}

TrialCycle cycle_of(const Row& row, bool must_write) {
  const bool has_price = row.text("price_minute_utc") != "none" && row.text("price_status") == "ok";
  const bool is_written = !must_write || row.text("written") == "1";
  TrialCycle cycle;
  cycle.is_good = row.text("mode") == "running" && has_price &&
                  row.text("battery_status") == "ok" && is_written;
  if (!cycle.is_good) cycle.cause = cause_of(row);
  return cycle;
}

}  // namespace

std::vector<SeenCycle> cycles_of_csv(std::string_view csv, bool must_write) {
  std::vector<SeenCycle> cycles;
  const std::vector<std::string_view> header = fields_of(take_line(csv));
  std::int64_t missed_before = 0;
  while (!csv.empty()) {
    const Row row(header, take_line(csv));
    if (!row.is_whole() || row.text("utc").empty() || row.text("mode").empty()) continue;
    SeenCycle seen;
    seen.name.append(row.text("utc")).append(" ").append(row.text("cycle"));
    seen.number = row.whole("cycle");
    seen.is_cycle = row.text("mode") != "stopping";
    seen.cycle = cycle_of(row, must_write);
    const std::int64_t missed = row.whole("missed_ticks");
    const bool is_same_process = !cycles.empty() && seen.number > cycles.back().number;
    if (is_same_process)
      seen.cycle.missed_ticks = std::max<std::int64_t>(0, missed - missed_before);
    missed_before = missed;
    cycles.push_back(seen);
  }
  return cycles;
}

std::vector<SeenCycle> last_cycles(const std::string& program, const std::string& settings,
                                   bool must_write) {
  constexpr std::int64_t kAnswerS = 20;
  const ProgramResult run =
      run_and_hear({program, "log", "--csv", "--last", "60", "--config", settings}, kAnswerS);
  return run.is_well() ? cycles_of_csv(run.output, must_write) : std::vector<SeenCycle>();
}

bool wants_control(const std::string& settings) {
  TomlValue document;
  std::string ignored;
  if (!parse_toml_file(settings, document, ignored)) return false;
  const TomlValue* const control = document.find("control");
  return control != nullptr && control->as<bool>() != nullptr && *control->as<bool>();
}

bool count_new_cycles(TrialState& state, const std::vector<SeenCycle>& cycles,
                      const TrialLimits& limits) {
  auto next = std::find_if(cycles.begin(), cycles.end(),
                           [&](const SeenCycle& seen) { return seen.name == state.mark; });
  next = next == cycles.end() ? cycles.begin() : std::next(next);
  // The number that the process before had reached: the next one begins below.
  std::int64_t before = INT64_MAX;
  const std::size_t space = state.mark.rfind(' ');
  if (space != std::string::npos) {
    std::from_chars(state.mark.data() + space + 1, state.mark.data() + state.mark.size(), before);
  }
  bool is_good = false;
  for (; next != cycles.end(); ++next) {
    // The process before has left no last word: it died, and its successor has made it good.
    const bool has_before = next != cycles.begin() && std::prev(next)->is_cycle;
    const bool has_died = has_before && next->is_cycle && next->number <= std::prev(next)->number;
    const bool is_on_trial = state.is_fresh && state.phase == TrialPhase::kTrying;
    if (is_on_trial && has_died) count_cycle(state, {}, limits);
    // A process that was stopped before its first cycle leaves the number 0. Its last word bears
    // the number of its last cycle, and is no other's.
    const bool is_next = next->is_cycle && next->number <= std::max<std::int64_t>(before, 1);
    state.is_fresh = state.is_fresh || is_next;
    if (!state.is_fresh) before = next->number;
    state.mark = next->name;
    if (!state.is_fresh || !next->is_cycle) continue;
    count_cycle(state, next->cycle, limits);
    is_good = is_good || next->cycle.is_good;
  }
  return is_good;
}

}  // namespace bess
