#include "workstation/runs/chain/common_options.h"

#include <fmt/format.h>

#include <cstdlib>
#include <memory>
#include <thread>

#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/correction/rules/rule.h"
#include "workstation/correction/rules/rule_conflicts.h"
#include "workstation/correction/rules/ruled_policy.h"
#include "workstation/correction/student/prove.h"
#include "workstation/correction/student/student_policy.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/data/market/feed/elia_fetch.h"

namespace bess {

namespace {

namespace fs = std::filesystem;

constexpr int kThreadsMax = 256;

/// Relative to the current folder if inside it.
fs::path shortened(const fs::path& path) {
  std::error_code error;
  const fs::path relative = fs::relative(path, error);
  return error || relative.empty() || *relative.begin() == ".." ? path : relative;
}

}  // namespace

void CommonOptions::add_config(ProgramCommand& command) {
  command.option("--config", config_path,
                 "configuration file (TOML); 'bess-train config' prints all keys");
}

void CommonOptions::add_threads(ProgramCommand& command) {
  command.option("--threads", threads, "threads (default: all cores)").range(1, kThreadsMax);
}

void CommonOptions::add_market(ProgramCommand& command) {
  command.option("--delay", delay_min, "observation delay, minutes (default 1)").range(0, 5);
  command.option("--settlement", settlement, "settlement per minute or per step (default minute)")
      .one_of({"minute", "step"});
  command.option("--initial-soc", initial_soc_frac, "initial SoC, 0 to 1 (default 0.5)");
}

RunConfig CommonOptions::resolve(ContextKind unless_said) const {
  return resolve(load_run_config(config_path, unless_said));
}

RunConfig CommonOptions::resolve(RunConfig config) const {
  config.set_seed(seed.value_or(1));
  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  config.set_threads(threads.value_or(cores));
  if (delay_min) config.market.observation_delay_min = *delay_min;
  if (settlement) config.market.settlement = parse_settlement(*settlement);
  if (initial_soc_frac) {
    const BatteryParameters& battery = config.battery;
    if (!(*initial_soc_frac >= battery.soc_min_frac && *initial_soc_frac <= battery.soc_max_frac)) {
      fail("--initial-soc {}: use {:g} to {:g}, the battery's SoC window", *initial_soc_frac,
           battery.soc_min_frac, battery.soc_max_frac);
    }
    config.initial_soc_frac = *initial_soc_frac;
  }
  return config;
}

std::vector<double> numbers_in(const std::vector<std::string>& texts, double low, double high,
                               const std::string& option, const std::string& usage) {
  std::vector<double> numbers;
  for (const std::string& text : texts) {
    double number = 0;
    if (!read_number(text, number) || !(number >= low && number <= high)) {
      fail("{} {}: use {}", option, text, usage);
    }
    numbers.push_back(number);
  }
  return numbers;
}

std::string checked_base_url(std::string url, const std::string& option) {
  const std::string given = url;
  while (url.ends_with('/')) url.pop_back();
  const std::size_t scheme = url.starts_with("http://") ? 7 : url.starts_with("https://") ? 8 : 0;
  const std::string host = url.substr(scheme, url.find('/', scheme) - scheme);
  const std::size_t colon = host.rfind(':');
  const bool has_port = colon != host.npos && host.find(']', colon) == host.npos;
  const long port = has_port ? std::strtol(host.c_str() + colon + 1, nullptr, 10) : 1;
  if (scheme == 0 || url.size() <= scheme || host.empty() || colon == 0 || port < 1 ||
      port > 65'535 || url.find_first_of(" \t\r\n") != url.npos) {
    fail("{} \"{}\" is not a web address; use the form {}", option, one_line(given, 80),
         kEliaBaseUrl);
  }
  return url;
}

std::optional<fs::path> header_in_tree_around(const fs::path& folder) {
  for (fs::path at = folder; !at.empty(); at = at.parent_path()) {
    const fs::path header = at / "edge" / "generated" / "student_weights.h";
    if (fs::exists(header) && fs::exists(at / "edge" / "CMakeLists.txt")) return header;
    if (at == at.root_path()) break;
  }
  return std::nullopt;
}

fs::path header_to_replace() {
  std::error_code error;
  if (const auto header = header_in_tree_around(fs::current_path())) return shortened(*header);
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (const auto header = header_in_tree_around(program.parent_path())) return shortened(*header);
  fail(
      "no source tree with edge/generated/student_weights.h around {} or {}; change to it, or name "
      "the header with --out",
      fs::current_path().string(), program.string());
}

std::string rule_count_lines(const Certificate& certificate) {
  std::string text;
  for (std::size_t r = 0; r < certificate.rule_counts().size(); ++r) {
    const Rule& rule = certificate.rules.rules[r];
    const RuleCount& count = certificate.rule_counts()[r];
    const std::string found =
        count.binds_student ? fmt::format("{} violations in {}", count.violations, count.states)
                            : "enforced by the guard only";
    text += fmt::format("  rule \"{}\", {}: {}\n", rule.name, rule.text(), found);
  }
  return text;
}

void add_certificate(const Certificate& certificate, Json& json) {
  json.set("states_checked", certificate.states_checked);
  json.set("states_evaluated", certificate.states_evaluated);
  json.set("low_price_eur_per_mwh", certificate.thresholds.low_eur_per_mwh);
  json.set("high_price_eur_per_mwh", certificate.thresholds.high_eur_per_mwh);
  json.set("violations", certificate.violations());
  add_property_violations(certificate, json);
  Json list = Json::list();
  for (std::size_t r = 0; r < certificate.rule_counts().size(); ++r) {
    const Rule& rule = certificate.rules.rules[r];
    const RuleCount& count = certificate.rule_counts()[r];
    list.add(Json::object({{"rule", rule.name},
                           {"binds_student", count.binds_student},
                           {"enforced", rule.enforce},
                           {"states", count.states},
                           {"violations", count.violations}}));
  }
  json.set("rules", std::move(list));
}

std::string broken_rule_lines(const StudentFile& student, const MarketSteps& market,
                              const RunConfig& config) {
  const Certificate& certificate = student.certificate;
  RuleSet broken;
  std::string text;
  for (std::size_t r = 0; r < certificate.rule_counts().size(); ++r) {
    const RuleCount& count = certificate.rule_counts()[r];
    if (count.violations == 0) continue;
    const Rule& rule = certificate.rules.rules[r];
    broken.rules.push_back(rule);
    const auto worst = worst_state(student.net, rule, count);
    if (worst) {
      text += fmt::format("  worst for \"{}\": {} at {}\n", rule.name, action_name(worst->action),
                          state_text(worst->state, student.net.context.kind));
    } else if (!count.counterexamples.empty()) {
      text += fmt::format("  one for \"{}\": {}\n", rule.name,
                          state_text(count.counterexamples.front(), student.net.context.kind));
    }
  }
  if (broken.empty() || market.days.empty()) return text;
  if (student.net.context.is_outlook()) {
    return text + "  shares of decisions are not counted: this student needs day-ahead prices\n";
  }
  RuleWatch watch(std::make_shared<StudentPolicy>(student.net), broken, student.net.context, 0,
                  config.train.seed);
  evaluate(market, market.days, watch, {config.battery, config.initial_soc_frac, true});
  for (std::size_t r = 0; r < broken.rules.size(); ++r) {
    if (!can_be_projected(broken.rules[r])) {
      text += fmt::format(
          "  \"{}\" compares pairs of states: it cannot be counted in single decisions\n",
          broken.rules[r].name);
      continue;
    }
    const WatchCount& count = watch.counts()[r];
    text += fmt::format(
        "  \"{}\" is broken in {} of {} decisions ({:.3f} %)\n", broken.rules[r].name,
        count.visited_broken, watch.decisions(),
        100.0 * static_cast<double>(count.visited_broken) / static_cast<double>(watch.decisions()));
  }
  return text;
}

ProgramOption RuleFiles::add(ProgramCommand& command, const std::string& help) {
  return command.option("--rules", paths, help);
}

RuleSet RuleFiles::read() const { return load_rules(paths); }

void use_rules(RunConfig& config, const RuleSet& rules, ContextKind kind) {
  PriceThresholds& thresholds = config.distil.correction.thresholds;
  require_consistent(rules, thresholds, kind);
  config.distil.rules = rules;
  thresholds = rules.thresholds(thresholds);
}

void RuleFiles::apply(RunConfig& config, ContextKind kind) const {
  if (!paths.empty()) use_rules(config, read(), kind);
}

}  // namespace bess
