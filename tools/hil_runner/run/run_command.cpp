// bess-hil: runs scenarios with the edge, in one or both times, and judges them by the battery
// trace.
//   exit 0 all passed   1 one failed, or a file is bad   2 the command line is bad
#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iterator>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <thread>

#include "edge/records/log/log_text.h"
#include "shared/host/command_line.h"
#include "shared/host/file.h"
#include "shared/host/json.h"
#include "shared/host/user_error.h"
#include "shared/local_time.h"
#include "shared/utc_text.h"
#include "tools/hil_runner/base/stop_request.h"
#include "tools/hil_runner/real/real_options.h"
#include "tools/hil_runner/run/agreement.h"
#include "tools/hil_runner/run/report_page.h"
#include "tools/hil_runner/run/run_scenario.h"
#include "tools/hil_runner/scenario/rules.h"
#include "tools/simulators/battery_sim/battery_record.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

enum class TimeModes : std::uint8_t { kVirtual, kWall, kBoth };

struct RunOptions {
  std::vector<std::string> places;
  TimeModes times = TimeModes::kVirtual;
  int jobs = 8;
  bool list = false;
  bool list_invariants = false;
  bool json = false;
  bool each_part = false;
  bool agree = false;
  int draw = 0;  ///< number of scenarios; 0: all
  std::uint64_t seed = 0;
  std::string junit, report, pinned, records, edge, simulators;
  RealBattery real;
};

/// Files as given; scenarios of folders by name.
std::vector<std::string> scenario_files(const std::vector<std::string>& places) {
  std::vector<std::string> files;
  for (const std::string& place : places) {
    if (!fs::is_directory(place)) {
      files.push_back(place);
      continue;
    }
    std::vector<std::string> inside;
    for (const auto& entry : fs::directory_iterator(place)) {
      if (entry.path().extension() == ".toml") inside.push_back(entry.path().string());
    }
    std::ranges::sort(inside);
    files.insert(files.end(), inside.begin(), inside.end());
  }
  if (files.empty()) fail("no scenario: give files, or a folder with scenarios (*.toml)");
  return files;
}

/// Default: next to this program.
std::string program(const std::string& given, const char* name) {
  if (!given.empty()) return given;
  return (fs::read_symlink("/proc/self/exe").parent_path() / name).string();
}

void print_line(const Outcome& outcome) {
  if (!outcome.skipped.empty()) {
    fmt::print("skip  {:7} {:32} {}\n", outcome.time(), outcome.scenario.name, outcome.skipped);
  } else if (outcome.passed()) {
    fmt::print("ok    {:7} {:32} {:6.2f} s  {}\n", outcome.time(), outcome.scenario.name,
               outcome.seconds, outcome.scenario.title);
  } else {
    fmt::print("FAIL  {:7} {:32} {:6.2f} s  {}{}\n", outcome.time(), outcome.scenario.name,
               outcome.seconds, complaint(outcome),
               outcome.kept_folder.empty() ? "" : " (files: " + outcome.kept_folder + ")");
  }
  std::fflush(stdout);
}

Json json_of(const Outcome& outcome) {
  Json json = Json::object({{"scenario", outcome.scenario.name},
                            {"time", outcome.time()},
                            {"passed", outcome.passed()},
                            {"verdict", outcome.verdict()},
                            {"seconds", Decimals{outcome.seconds, 3}}});
  if (!outcome.skipped.empty()) json.set("skipped", outcome.skipped);
  if (!outcome.error.empty()) json.set("error", outcome.error);
  if (outcome.signature != 0) json.set("signature", fmt::format("{:016x}", outcome.signature));
  json.set("findings", Json::list_from(outcome.findings, [](const Finding& f) {
             return Json::object({{"rule", f.rule},
                                  {"utc", utc_text(f.utc_s).view()},
                                  {"expected", f.expected},
                                  {"seen", f.seen}});
           }));
  return json;
}

/// Input of `bess-sim settle`: NAME.TIME.battery.csv, NAME.TIME.edge.csv.
void write_records(const fs::path& folder, const Outcome& outcome) {
  const std::string place = (folder / (outcome.scenario.name + "." + outcome.time())).string();
  write_battery_record(place + ".battery.csv", outcome.evidence.minutes);
  char line[kLogLineBytes];
  std::string text(line, format_csv_header(line));
  for (const CycleRecord& record : outcome.evidence.log) {
    text += '\n';
    text.append(line, format_csv_line(record, line));
  }
  write_file(place + ".edge.csv", text + '\n');
}

class Runner {
 public:
  explicit Runner(const RunOptions& options)
      : options_(options),
        site_{.edge = program(options.edge, "bess-edge"),
              .simulators = program(options.simulators, "bess-sim"),
              .battery = real_battery(options.real)} {
    for (const std::string& file : scenario_files(options.places)) {
      scenarios_.push_back(read_scenario(file));
    }
    if (options.agree) {
      std::erase_if(scenarios_, [](const Scenario& s) { return !s.runs_virtual || !s.runs_wall; });
    }
    if (options.draw > 0) draw();
    if (site_.battery) refuse_unsuited();
    if (!options.pinned.empty()) {
      pinned_.emplace(options.pinned, std::getenv("BESS_UPDATE_GOLDEN") != nullptr);
    }
  }

  [[nodiscard]] const std::vector<Scenario>& scenarios() const { return scenarios_; }

  std::vector<Outcome> run() {
    watch_for_stop();
    if (site_.battery) {
      run_on_real_battery();
      return std::move(outcomes_);
    }
    const TimeModes times = options_.agree ? TimeModes::kBoth : options_.times;
    if (times != TimeModes::kWall) {
      for (const Scenario& scenario : scenarios_) take(run_virtually(scenario));
      if (pinned_) pinned_->write();
    }
    if (times != TimeModes::kVirtual) run_in_wall_time();
    return std::move(outcomes_);
  }

 private:
  void draw() {
    std::vector<Scenario> drawn;
    std::ranges::sample(scenarios_, std::back_inserter(drawn), options_.draw,
                        std::mt19937_64(options_.seed));
    scenarios_ = std::move(drawn);
  }

  /// Unsuited scenarios of a folder are skipped; a named one is an error.
  void refuse_unsuited() const {
    for (const Scenario& scenario : scenarios_) {
      const bool was_named =
          std::ranges::find(options_.places, scenario.path) != options_.places.end();
      const std::string why = why_not_real(scenario, *site_.battery);
      if (was_named && !why.empty()) {
        fail("{}: not for a real battery: {} (--list shows suitable ones)", scenario.path, why);
      }
    }
  }

  [[nodiscard]] Outcome run_virtually(const Scenario& scenario) {
    Outcome outcome = run_scenario(scenario, true, site_);
    if (pinned_ && outcome.skipped.empty() && outcome.passed()) {
      outcome.findings = pinned_->judge(outcome);
    }
    if (options_.each_part && outcome.skipped.empty() && outcome.passed()) {
      outcome.findings = judge_parts(outcome);
    }
    return outcome;
  }

  /// One after the other; an incomplete run ends all.
  void run_on_real_battery() {
    require_programs();
    for (const Scenario& scenario : scenarios_) {
      take(run_scenario(scenario, false, site_));
      if (!outcomes_.back().error.empty()) return;
    }
  }

  void require_programs() const {
    for (const std::string& path : {site_.edge, site_.simulators}) {
      if (access(path.c_str(), X_OK) != 0) {
        fail("{}: {}; build it, or give its path (see --help)", path,
             fs::exists(path) ? "not executable by this user" : "not found");
      }
    }
  }

  /// Mostly waiting: several in parallel, the longest first.
  void run_in_wall_time() {
    require_programs();
    std::ranges::stable_sort(scenarios_, std::greater<>(), [](const Scenario& s) {
      return s.runs_wall ? s.minutes / s.time_scale : 0;
    });
    std::atomic<std::size_t> next = 0;
    std::vector<std::thread> threads;
    for (int i = 0; i < options_.jobs; ++i) {
      threads.emplace_back([&] {
        for (std::size_t s = next++; s < scenarios_.size(); s = next++) {
          try {
            take(run_scenario(scenarios_[s], false, site_));
          } catch (const Interrupted&) {
            return;
          }
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
    throw_if_stopped();
  }

  void take(Outcome outcome) {
    const std::lock_guard lock(mutex_);
    if (!options_.json && !options_.agree) print_line(outcome);
    if (!options_.records.empty() && outcome.skipped.empty()) {
      write_records(options_.records, outcome);
    }
    outcomes_.push_back(std::move(outcome));
  }

  const RunOptions& options_;
  WallSite site_;
  std::optional<PinnedRuns> pinned_;
  std::vector<Scenario> scenarios_;
  std::mutex mutex_;
  std::vector<Outcome> outcomes_;
};

void list_scenarios(const std::vector<Scenario>& scenarios, bool as_json) {
  Json list = Json::list();
  for (const Scenario& s : scenarios) {
    const char* const times = !s.runs_wall ? "virtual" : s.runs_virtual ? "both" : "wall";
    const bool is_real = why_not_real(s).empty();
    if (as_json) {
      list.add(Json::object({{"scenario", s.name},
                             {"file", s.path},
                             {"title", s.title},
                             {"time", times},
                             {"real", is_real},
                             {"minutes", Decimals{s.minutes, 1}}}));
    } else {
      fmt::print("{:32} {:7} {:4} {:5.0f} min  {}\n", s.name, times, is_real ? "real" : "-",
                 s.minutes, s.title);
    }
  }
  if (as_json) fmt::print("{}\n", Json::object({{"scenarios", std::move(list)}}).line());
}

/// Agreement of the two times, independent of the judge.
void report_agreement(const RunOptions& options, const std::vector<Outcome>& outcomes) {
  const std::vector<Agreement> agreements = agreements_of(outcomes);
  if (agreements.empty()) fail("no scenario among these runs in both times");
  if (options.json) {
    fmt::print("{}\n", agreement_json(agreements).line());
  } else {
    fmt::print("{}{}\n", agreement_table(agreements), agreement_line(agreements));
  }
  const auto broken =
      std::ranges::count_if(agreements, [](const Agreement& a) { return !a.holds(); });
  if (broken > 0) fail("{} of {} scenarios have different orders", broken, agreements.size());
}

void run(const RunOptions& options) {
  if (options.list_invariants) {
    for (const RuleInfo& info : kRuleInfos) fmt::print("{:12} {}\n", info.name, info.text);
    return;
  }
  for (const std::string& path : {options.junit, options.report}) {
    if (!path.empty()) require_writable(path);
  }
  if (!options.records.empty()) require_writable(fs::path(options.records) / "records");
  Runner runner(options);
  if (options.list) return list_scenarios(runner.scenarios(), options.json);
  const std::vector<Outcome> outcomes = runner.run();
  if (options.agree) return report_agreement(options, outcomes);
  const auto failed = std::ranges::count_if(outcomes, [](const Outcome& o) { return o.failed(); });
  const auto late = std::ranges::count_if(outcomes, [](const Outcome& o) { return o.is_late; });
  const auto skipped =
      std::ranges::count_if(outcomes, [](const Outcome& o) { return !o.skipped.empty(); });
  const auto ran = std::ssize(outcomes) - skipped;
  if (options.json) {
    fmt::print("{}\n", Json::object({{"passed", ran - failed},
                                     {"failed", failed - late},
                                     {"late", late},
                                     {"skipped", skipped},
                                     {"runs", Json::list_from(outcomes, json_of)}})
                           .line());
  } else {
    fmt::print("{} passed, {} failed, {} skipped{}\n", ran - failed, failed - late, skipped,
               late == 0 ? "" : fmt::format(", {} not judged: this machine was late", late));
    const std::string agreement = agreement_line(agreements_of(outcomes));
    if (!agreement.empty()) fmt::print("{}\n", agreement);
  }
  if (!options.junit.empty()) write_file(options.junit, junit_text(outcomes));
  if (!options.report.empty()) write_file(options.report, report_page(outcomes));
  if (failed > late) fail("{} of {} runs failed", failed - late, ran);
  if (late > 0) fail("{} of {} runs were not judged: this machine was late", late, ran);
  if (ran == 0) fail("no run: all scenarios were skipped");
}

void add_run_command(ProgramCommand& app) {
  auto options = std::make_shared<RunOptions>();
  ProgramCommand command =
      app.subcommand("run", "run and judge scenarios; prints one line for each");
  command.footer(
      "Examples:\n"
      "  bess-hil run tests/scenarios/quiet_hour.toml\n"
      "  bess-hil run tests/scenarios --time both --junit build/hil.xml\n"
      "  bess-hil run tests/scenarios --agree --jobs 16\n"
      "  bess-hil run mine.toml --report mine.html\n"
      "  bess-hil run tests/scenarios --list\n"
      "  bess-hil run tests/scenarios/quiet_hour.toml --real 192.168.1.20:502 "
      "--yes-drive-real-battery\n"
      "      --real-map alphaess --real-capacity-wh 8000 --real-power-w 500 --real-soc-min 0.3 "
      "--real-soc-max 0.7\n"
      "Exit codes: 0 all passed, 1 a run failed or bad file, 2 bad command line, 3 interrupted.");
  command.option("scenarios", options->places, "scenario files, or folders with scenarios")
      .value_name("SCENARIO...");
  command.choice<TimeModes>(
      "--time", options->times,
      {{"virtual", TimeModes::kVirtual}, {"wall", TimeModes::kWall}, {"both", TimeModes::kBoth}},
      "virtual (default): computed time, with the edge's code; wall: scaled time, with the real "
      "programs");
  command.option("--jobs", options->jobs, "parallel scenarios in wall time")
      .range(1, 64)
      .with_default();
  command.flag("--list", options->list, "list scenarios with times; mark those for a real battery");
  command.flag("--invariants", options->list_invariants, "list the judged rules");
  command.flag(
      "--each-part", options->each_part,
      "also run each passed virtual scenario without each of its parts; every run must differ");
  command.option("--pinned", options->pinned,
                 "compare virtual runs with the signatures in this file");
  command.flag("--agree", options->agree,
               "run scenarios in both times and compare set points by control cycle");
  command.option("--draw", options->draw, "number of scenarios to draw at random").range(1, 1'000);
  command.option("--seed", options->seed, "random seed for --draw").needs("--draw");
  command.flag("--json", options->json, "output as one JSON object");
  command.option("--junit", options->junit, "output file in JUnit XML");
  command.option("--report", options->report, "output file of the HTML report with charts");
  command
      .option("--records", options->records,
              "output folder for battery traces and decision logs (CSV), for bess-sim settle")
      .value_name("FOLDER");
  command.option("--edge", options->edge, "path of bess-edge (default: next to this program)");
  command.option("--simulators", options->simulators,
                 "path of bess-sim (default: next to this program)");
  add_real_options(command, options->real);
  command.runs([options] { run(*options); });
}

}  // namespace
}  // namespace bess

int main(int argc, char** argv) {
  bess::set_market_time_zone();
  bess::CommandLine command_line("bess-hil", "bess-hil: hardware-in-the-loop scenarios",
                                 BESS_VERSION);
  bess::ProgramCommand root = command_line.root();
  bess::add_run_command(root);
  return command_line.run(argc, argv);
}
