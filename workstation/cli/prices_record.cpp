// bess-train prices record: live minutes into daily files, with their time of arrival.
#include <fmt/core.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <memory>

#include "shared/host/json.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/utc_text.h"
#include "workstation/base/answer.h"
#include "workstation/chain/common_options.h"
#include "workstation/chain/interruption.h"
#include "workstation/cli/commands.h"
#include "workstation/market/feed/elia_fetch.h"
#include "workstation/market/feed/price_recorder.h"

namespace bess {
namespace {

struct PricesRecordArguments {
  std::string out;
  std::string base_url = kEliaBaseUrl;
  double poll_s = 20;
  std::string duration, until;
  bool json = false;
};

constexpr double kDurationMax_s = 3650 * 86'400.0;

/// Seconds of "90s", "30m", "12h" or "7d".
std::int64_t duration_s(const std::string& text) {
  const std::string_view units = "smhd";
  constexpr double kSeconds[] = {1, 60, 3600, 86'400};
  char* unit = nullptr;
  const double number = std::strtod(text.c_str(), &unit);
  const std::size_t at = *unit == '\0' || unit[1] != '\0' ? units.npos : units.find(*unit);
  const double seconds = at != units.npos ? number * kSeconds[at] : 0;
  if (!(seconds >= 1 && seconds <= kDurationMax_s)) {
    fail("--for \"{}\" is not a duration; write it as 90s, 30m, 12h or 7d", one_line(text, 40));
  }
  return static_cast<std::int64_t>(seconds);
}

std::optional<std::int64_t> end_utc_s(const PricesRecordArguments& options) {
  if (!options.duration.empty()) return std::time(nullptr) + duration_s(options.duration);
  if (options.until.empty()) return std::nullopt;
  std::int64_t utc_s = 0;
  if (!parse_utc(options.until, utc_s)) {
    fail("--until \"{}\" is not an instant; write it as 2025-06-15T22:00:00Z",
         one_line(options.until, 40));
  }
  if (utc_s <= std::time(nullptr)) {
    fail("--until {} is over; give an instant to come, in UTC", options.until);
  }
  return utc_s;
}

/// Lines on stderr, what repeats in place on a terminal; or JSON objects on stdout.
class Teller {
 public:
  explicit Teller(bool json) : json_(json), terminal_(isatty(STDERR_FILENO) == 1) {}
  ~Teller() {
    if (in_place_) fmt::print(stderr, "\n");
  }
  Teller(const Teller&) = delete;
  Teller& operator=(const Teller&) = delete;

  void tell(const RecorderEvent& event) {
    if (json_) {
      Json json = answer("recorder_event");
      json.set("event", name_of(event.kind));
      json.set("utc", utc_text(std::time(nullptr)).view());
      json.set("subject", text_or_null(event.subject));
      json.set("message", event.text);
      print_json(json);
    } else if (event.kind == RecorderEvent::Kind::kRecorded) {
      if (terminal_) fmt::print(stderr, "\r\033[Krecord: {}", event.text);
      in_place_ = terminal_;
    } else {
      fmt::print(stderr, "{}{} {}: {}\n", in_place_ ? "\n" : "",
                 utc_text(std::time(nullptr)).view(), event.subject, event.text);
      in_place_ = false;
    }
    std::fflush(stderr);
  }

  static void print_json(const Json& json) {
    fmt::print("{}\n", json.line());
    std::fflush(stdout);
  }

 private:
  static const char* name_of(RecorderEvent::Kind kind) {
    switch (kind) {
      case RecorderEvent::Kind::kRecorded:
        return "recorded";
      case RecorderEvent::Kind::kOutage:
        return "outage";
      case RecorderEvent::Kind::kOver:
        return "over";
      case RecorderEvent::Kind::kMended:
        return "mended";
      case RecorderEvent::Kind::kClock:
        return "clock";
      case RecorderEvent::Kind::kDay:
        return "day";
    }
    return "";
  }

  bool json_;
  bool terminal_;
  bool in_place_ = false;
};

void print_summary(const RecordSummary& summary, const PricesRecordArguments& options) {
  if (options.json) {
    const bool any_seen = summary.lateness.seen > 0;
    Json json = answer("recorder_summary");
    json.set("event", "end");
    json.set("utc", utc_text(std::time(nullptr)).view());
    json.set("lines", summary.lines);
    json.set("prices", summary.prices);
    json.set("imbalances", summary.imbalances);
    json.set("revised", summary.revised);
    json.set("seen", summary.lateness.seen);
    json.set("found", summary.lateness.found);
    json.set("late_s_median", any_seen ? summary.lateness.median_s : NAN);
    json.set("late_s_p95", any_seen ? summary.lateness.p95_s : NAN);
    Teller::print_json(json);
    return;
  }
  fmt::print("{}: {}, {}, {}\n{}", options.out, counted(summary.prices, "minute price"),
             counted(summary.imbalances, "system imbalance"), counted(summary.revised, "revision"),
             describe_lateness(summary.lateness));
}

void run_prices_record(const PricesRecordArguments& options) {
  watch_interruption();
  using Steady = std::chrono::steady_clock;
  RecordSummary summary;
  {
    Teller teller(options.json);
    summary = record_prices(
        {.folder = options.out,
         .base_url = checked_base_url(options.base_url, "--url"),
         .poll_s = options.poll_s,
         .until_utc_s = end_utc_s(options),
         .clock = {
             .utc_s = [] { return static_cast<std::int64_t>(std::time(nullptr)); },
             .steady_s =
                 [] {
                   return std::chrono::duration<double>(Steady::now().time_since_epoch()).count();
                 },
             .sleep = sleep_unless},
         .tell = [&teller](const RecorderEvent& event) { teller.tell(event); }},
        interruption());
  }
  print_summary(summary, options);
  if (!summary.answered && !interruption()) {
    fail("{}: nothing was recorded: {}; check --url and the network", options.base_url,
         summary.trouble.empty() ? "no time to look" : summary.trouble);
  }
}

}  // namespace

void add_prices_record(ProgramCommand& prices) {
  auto options = std::make_shared<PricesRecordArguments>();
  ProgramCommand command = prices.subcommand(
      "record", "Follow live minutes into daily files, each with its time of arrival");
  command.option("--out", options->out, "Folder of the daily files, one a local day").required();
  command.option("--url,--base-url", options->base_url, "API root, ends in /api/explore/v2.1")
      .with_default();
  command.option("--poll-s", options->poll_s, "Seconds between two looks")
      .range(15.0, 60.0)
      .with_default();
  command.option("--for", options->duration, "Stop after this long: 90s, 30m, 12h, 7d");
  command.option("--until", options->until, "Stop at this instant, e.g. 2025-06-15T22:00:00Z")
      .excludes("--for");
  command.flag("--json", options->json, "Events and the summary as JSON, one object a line");
  command.footer(
      "Runs until Ctrl-C or SIGTERM, which end it in order with exit code 0. Start it again at "
      "any\n"
      "time: it takes what the source still has of today and writes no row twice. Rows that were\n"
      "there already are marked \"found\" and count in no figure of how late prices arrive.\n"
      "Prices are ods161, system imbalances ods169. No settled prices: join those of ods134 "
      "later.\n"
      "Examples:\n"
      "  bess-train prices record --out recorded\n"
      "  bess-train prices record --out recorded --for 12h --json\n"
      "  bess-train prices import recorded/*.csv ods134.csv --out recorded.csv.gz\n"
      "  bess-train prices stats recorded/2025-06-15.csv");
  command.runs([options] { run_prices_record(*options); });
}

}  // namespace bess
