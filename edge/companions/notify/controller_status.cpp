#include "edge/companions/notify/controller_status.h"

#include <string_view>

#include "edge/records/account/settled_prices.h"
#include "shared/host/run_program.h"
#include "shared/host/text.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr int kStatusMsMax = 10'000;
constexpr std::int64_t kEarnedSMax = 30;

/// Key of a line: numbers and level (WARN, CRITICAL) do not distinguish troubles.
std::string key_of_line(std::string_view line) {
  for (const std::string_view level : {"WARN: ", "CRITICAL: "}) {
    if (line.starts_with(level)) line.remove_prefix(level.size());
  }
  std::string key;
  for (const char c : line) {
    const bool is_digit = c >= '0' && c <= '9';
    if (!is_digit)
      key += c;
    else if (key.empty() || key.back() != '#')
      key += '#';
  }
  return key;
}

/// One outage is one trouble, from the first failed answer to the following safe mode.
std::string key_of(std::string_view line, std::string_view reason) {
  const bool is_mode = line.starts_with("WARN: mode is ");
  if (is_mode ? reason == "link" : line.starts_with("WARN: battery: no usable ")) return "battery";
  const bool is_late = reason == "no_price" || reason == "price_age" || reason == "price_qh";
  if (is_mode ? is_late : line.starts_with("WARN: prices: no usable ")) return "prices";
  // Mode holding becomes safe with the same reason.
  return is_mode ? "not running: " + std::string(reason) : key_of_line(line);
}

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
                     std::to_string(result.exit_code) + "): run it manually";
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

std::vector<Trouble> troubles_of(const ControllerStatus& status) {
  if (!status.trouble.empty()) return {{.key = "no status", .text = one_line(status.trouble)}};
  const JsonValue json = status.json.value();
  std::vector<Trouble> troubles;
  for (const JsonValue reason : json["health_reasons"]) {
    const std::string line = one_line(reason.text_or(""));
    troubles.push_back({.key = key_of(line, json["last"]["reason"].text_or("")), .text = line});
  }
  return troubles;
}

std::string settled_trouble(const std::string& file, std::int64_t now_utc_s) {
  constexpr std::int64_t kLateS = 4 * kSecondsPerDay;  // a day is published on the next day
  constexpr const char* kMend = ": bess-prices --settle shows the cause";
  SettledPrices prices;
  const std::string loss = prices.read(file);
  if (!loss.empty()) return loss;
  if (prices.quarters().empty()) return std::string("no settled price received yet") + kMend;
  const std::int64_t newest_utc_s = prices.quarters().back().start_utc_s;
  if (now_utc_s - newest_utc_s <= kLateS) return "";
  return "no settled price is newer than " + std::string(utc_text(newest_utc_s).view()) + kMend;
}

}  // namespace bess
