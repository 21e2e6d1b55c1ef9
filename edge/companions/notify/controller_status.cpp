#include "edge/companions/notify/controller_status.h"

#include "edge/records/account/settled_prices.h"
#include "shared/host/run_program.h"
#include "shared/host/text.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr int kStatusMsMax = 10'000;
constexpr std::int64_t kEarnedSMax = 30;

}  // namespace

ControllerStatus ask_controller(const ControllerPlaces& controller) {
  ControllerStatus status;
  ProgramResult result = run_program(
      {controller.program, "status", "--json", "--no-lock", "--config", controller.config_path}, "",
      kStatusMsMax);
  status.trouble = std::move(result.trouble);
  if (!status.trouble.empty()) return status;
  Json json = Json::parse(result.output);
  if (json.value()["health"].text() == nullptr) {
    status.trouble = controller.program + " status gives no status (exit code " +
                     std::to_string(result.exit_code) + ")";
    return status;
  }
  status.json = std::move(json);
  return status;
}

Json ask_earned(const ControllerPlaces& controller, std::vector<std::string> words) {
  words.insert(words.begin(), {controller.program, "earned"});
  words.insert(words.end(), {"--json", "--config", controller.config_path});
  return Json::parse(run_and_capture(words, kEarnedSMax).output);
}

SeenAlert seen_alert(Alert alert, const std::string& found) {
  return {.key = std::string(info_of(alert).code), .text = one_line(alert_line(alert, found))};
}

std::vector<SeenAlert> seen_alerts(const ControllerStatus& status) {
  if (!status.trouble.empty()) return {seen_alert(Alert::kNoStatus, status.trouble)};
  std::vector<SeenAlert> seen;
  for (const JsonValue alert : status.json.value()["alerts"]) {
    seen.push_back(
        {.key = one_line(alert["code"].text_or("")), .text = one_line(alert["line"].text_or(""))});
  }
  return seen;
}

std::string settled_trouble(const std::string& file, std::int64_t now_utc_s) {
  constexpr std::int64_t kLateS = 4 * kSecondsPerDay;  // a day is published on the next day
  SettledPrices prices;
  const std::string loss = prices.read(file);
  if (!loss.empty()) return loss;
  if (prices.quarters().empty()) return "no settled price received yet";
  const std::int64_t newest_utc_s = prices.quarters().back().start_utc_s;
  if (now_utc_s - newest_utc_s <= kLateS) return "";
  return "no settled price is newer than " + std::string(utc_text(newest_utc_s).view());
}

}  // namespace bess
