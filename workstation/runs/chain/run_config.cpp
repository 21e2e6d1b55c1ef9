#include "workstation/runs/chain/run_config.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "shared/battery_keys.h"
#include "shared/host/file.h"
#include "shared/host/text.h"
#include "shared/host/toml_reader.h"
#include "shared/host/user_error.h"

namespace bess {
namespace {

struct Key {
  std::string section;
  std::string name;
  std::string comment;
  std::function<void(TomlTable&)> read;
  std::function<std::string()> get;
  bool is_learning = true;  ///< else of evaluation alone
};

/// Keys bound to the fields of one configuration.
struct KeyList {
  std::vector<Key> keys;
  std::string present_section;

  explicit KeyList(RunConfig& c);

  void section(std::string name) { present_section = std::move(name); }

  void number(const char* name, double& field, double low, double high, const char* comment) {
    keys.push_back({present_section, name, fmt::format("{} ({:g} .. {:g})", comment, low, high),
                    [=, &field](TomlTable& table) { table.number(name, field, low, high); },
                    [&field] { return fmt::format("{}", field + 0.0); }});  // + 0.0 avoids -0
  }
  template <typename Integer>
  void integer(const char* name, Integer& field, std::int64_t low, std::int64_t high,
               const char* comment) {
    keys.push_back({present_section, name, fmt::format("{} ({} .. {})", comment, low, high),
                    [=, &field](TomlTable& table) { table.integer(name, field, low, high); },
                    [&field] { return fmt::format("{}", field); }});
  }
  void boolean(const char* name, bool& field, const char* comment) {
    keys.push_back({present_section, name, comment,
                    [name, &field](TomlTable& table) { table.boolean(name, field); },
                    [&field] { return std::string(field ? "true" : "false"); }});
  }
  template <typename Enum>
  void choice(const char* name, Enum& field, std::initializer_list<std::string_view> choices,
              const char* comment) {
    const std::vector<std::string_view> names(choices);
    keys.push_back({present_section, name, fmt::format("{} ({})", comment, fmt::join(names, " | ")),
                    [=, &field](TomlTable& table) {
                      int index = static_cast<int>(field);
                      table.choice(name, index, names);
                      field = static_cast<Enum>(index);
                    },
                    [names, &field] {
                      return fmt::format("\"{}\"", names[static_cast<std::size_t>(field)]);
                    }});
  }

  /// The last key does not change a student.
  void of_evaluation() { keys.back().is_learning = false; }
};

KeyList::KeyList(RunConfig& c) {
  section("market");
  integer("observation_delay_min", c.market.observation_delay_min, 0, 5,
          "newest row visible at minute t is t - delay; 0 is the paper's ideal");
  choice("settlement", c.market.settlement, {"minute", "step"},
         "settlement per minute, or per step at the quarter-hour of its start");
  integer("day_ahead_published_min", c.market.day_ahead_published_min, 0, 1439,
          "local minute of the previous day at which day-ahead prices are published; 780 is 13:00");
  of_evaluation();

  section("battery");
  for (const BatteryKey& key : kBatteryKeys) {
    number(key.name, key.of(c.battery), key.low, key.high, key.comment);
  }
  number("wear_eur_per_mwh", c.battery.wear_eur_per_mwh, 0, 1000,
         "wear cost of energy charged or discharged, EUR/MWh; all profits are net of it");
  number("cycles_per_day_max", c.battery.cycles_per_day_max, 0, 1000,
         "full cycles per local day, then idle until midnight; 0 is no limit");
  number("fade_percent_per_1000_cycles", c.battery.fade_percent_per_1000_cycles, 0, 100,
         "capacity fade per 1000 full cycles, %; planners ignore it");
  of_evaluation();
  number("minimum_run_min", c.battery.minimum_run_min, 0, 240,
         "minimum run time of a direction, min; planners ignore it");
  of_evaluation();
  number("initial_soc", c.initial_soc_frac, 0, 1, "SoC at the start of each evaluated day");

  section("costs");
  TradingCosts& costs = c.battery.costs;
  number("import_adder_eur_per_mwh", costs.import_adder_eur_per_mwh, 0, 1000,
         "surcharge on charged energy, EUR/MWh: grid fee, taxes, supplier");
  number("import_percent", costs.import_percent, 0, 100,
         "surcharge in % of the absolute price: at -100 and 5 %, the receipt is 95");
  number("export_fee_eur_per_mwh", costs.export_fee_eur_per_mwh, 0, 1000,
         "fee on discharged energy, EUR/MWh: grid fee, supplier");
  number("export_percent", costs.export_percent, 0, 100,
         "fee in % of the absolute price: at -100 and 5 %, the payment is 105");

  section("train");
  choice("method", c.train.method, {"c51", "dqn", "sdp"},
         "distributional or plain Q-learning, or the stochastic program (SDP)");
  choice("context", c.train.context, {"month", "level", "outlook"},
         "the student's third input: local month, class of the trailing price level, or class of "
         "the break-even price of a day-ahead plan (default with --day-ahead)");
  choice("source", c.train.source, {"counterfactual", "replay"},
         "experience: each price move for every SoC and action, or epsilon-greedy days");
  choice("horizon", c.train.horizon, {"continuing", "day"},
         "midnight truncates the episode, or ends it");
  integer("steps", c.train.steps, 1, 10'000'000, "gradient steps");
  integer("batch_size", c.train.batch_size, 1, 1 << 20, "transitions per gradient step");
  number("learning_rate", c.train.learning_rate, 1e-7, 1, "initial learning rate of Adam");
  number("learning_rate_end", c.train.learning_rate_end, 0, 1,
         "final learning rate of the cosine schedule");
  number("gamma", c.train.gamma, 0, 0.999999, "discount per step; no effect with residual");
  boolean("residual", c.train.residual,
          "c51, dqn: learn a residual on the SDP, initialised to zero");
  number("residual_gamma", c.train.residual_gamma, 0, 0.9995,
         "discount per step of the residual, instead of gamma");
  number("tau", c.train.tau, 1e-6, 1, "target <- tau * online + (1 - tau) * target, each step");
  integer("atoms", c.train.atoms, 2, 1001, "atoms of the value distribution");
  number("value_min_eur_per_h", c.train.value_min_eur_per_h, -1e9, 1e9, "lowest atom, EUR/h");
  number("value_max_eur_per_h", c.train.value_max_eur_per_h, -1e9, 1e9, "highest atom, EUR/h");
  number(
      "mean_weight", c.train.mean_weight, 0, 1000,
      "c51: weight of the squared error of the mean, added to the cross-entropy; 0 is plain C51");
  number("jitter_quarter_hours", c.train.jitter.quarter_hours, 0, 96,
         "standard deviation of a random quarter-hour shift, against overfitting");
  number("jitter_classes", c.train.jitter.classes, 0, 12, "the same for the context class");
  number("average_decay", c.train.average_decay, 0, 0.999999,
         "decay of the averaged weights that are validated and kept");
  integer("validate_every", c.train.validate_every, 1, 1'000'000, "gradient steps");

  section("distil");
  choice("method", c.distil.method, {"construction", "layer"},
         "monotone by weight signs, or the paper's optimisation layer");
  number("fidelity", c.distil.fidelity, 0, 100,
         "construction: weight of imitating the teacher relative to regret");
  number("level_shift_eur_per_mwh", c.distil.level_shift_eur_per_mwh, 0, 1000,
         "construction with an SDP-based teacher: standard deviation of price shifts, EUR/MWh");
  number("omega", c.distil.omega, 1e-8, 1,
         "layer: the paper's trade-off; larger follows the teacher more closely");
  number("temperature_eur_per_h", c.distil.temperature_eur_per_h, 1e-3, 1e6,
         "temperature of the teacher's softmax over action values, EUR/h");
  integer(
      "epochs", c.distil.epochs, 1, 1'000'000,
      "epochs of 16 Adam steps (construction), or 64 lattices and 32,768 visited states (layer)");
  integer("steps_per_epoch", c.distil.steps_per_epoch, 1, 64, "Adam steps per epoch");
  number("learning_rate", c.distil.learning_rate, 1e-7, 1,
         "initial learning rate of Adam, falling to a hundredth (construction) or a tenth (layer)");
  integer("repair_rounds", c.distil.repair_rounds, 0, 1000,
          "maximum failed proofs; each retrains on its counterexamples");
  integer("repair_epochs", c.distil.repair_epochs, 1, 1'000'000, "epochs of each repair");

  section("correction");
  PriceThresholds& thresholds = c.distil.correction.thresholds;
  integer("low_price_eur_per_mwh", thresholds.low_eur_per_mwh, -kThresholdMaxEurPerMwh,
          kThresholdMaxEurPerMwh, "property 1: charge at or below; binds the student from -500 up");
  integer("high_price_eur_per_mwh", thresholds.high_eur_per_mwh, -kThresholdMaxEurPerMwh,
          kThresholdMaxEurPerMwh,
          "property 2: discharge at or above; binds the student up to 1500");
  number("logit_margin", c.distil.correction.logit_margin, 0.01, 100,
         "logit margin at the thresholds");
  number("price_slope", c.distil.correction.price_slope, 0, 100,
         "layer: minimum logit slope over the price range");
  number("soc_slope", c.distil.correction.soc_slope, 0, 100,
         "layer: minimum logit slope over the SoC range");
}

constexpr double kPowerMin_w = 100, kCapacityMin_wh = 100;
constexpr double kRateMin_per_h = 0.05, kRateMax_per_h = 20;
constexpr double kRoundTripMin = 0.6;

/// Time per transition of C51, the slower method, core-s: 8,000 steps of 4,096 take two minutes on
/// two cores (November 2026, with vector instructions).
constexpr double kTransition_core_s = 7.3e-6;
constexpr double kLong_h = 1;

std::string duration_text(double hours) {
  if (hours < 48) return fmt::format("{:.0f} hours", hours);
  return hours < 2 * 365 * 24 ? fmt::format("{:.0f} days", hours / 24)
                              : fmt::format("{:.0f} years", hours / (365 * 24));
}

/// Expected training time of a network, h; 0 for the SDP.
double training_hours(const TrainOptions& options) {
  if (options.method == Method::kSdp) return 0;
  return kTransition_core_s * static_cast<double>(options.steps) *
         static_cast<double>(options.batch_size) / std::max(1, options.threads) / 3600;
}

/// Values in MW instead of W and unrealistic efficiencies.
void require_plausible(const RunConfig& config, const std::string& name) {
  const BatteryParameters& battery = config.battery;
  if (battery.power_w_max < kPowerMin_w) {
    fail("{}: [battery] power_w = {:g} is below {:g} W; use watts: 5 kW is 5000, 5 MW is 5000000",
         name, battery.power_w_max, kPowerMin_w);
  }
  if (battery.capacity_wh < kCapacityMin_wh) {
    fail(
        "{}: [battery] capacity_wh = {:g} is below {:g} Wh; use watt-hours: 10 MWh is "
        "10000000",
        name, battery.capacity_wh, kCapacityMin_wh);
  }
  const double rate_per_h = battery.power_w_max / battery.capacity_wh;
  if (!(rate_per_h >= kRateMin_per_h && rate_per_h <= kRateMax_per_h)) {
    fail(
        "{}: [battery] power_w = {:g} and capacity_wh = {:g} give a C-rate of {:.2g}/h, outside "
        "{:g} to {:g}/h: is one of them in kW or MW?",
        name, battery.power_w_max, battery.capacity_wh, rate_per_h, kRateMin_per_h, kRateMax_per_h);
  }
  const double round_trip = battery.charge_efficiency * battery.discharge_efficiency;
  if (round_trip < kRoundTripMin || round_trip >= 1) {
    fmt::print(
        stderr,
        "bess-train: warning: {}: [battery] charge_efficiency {:g} times "
        "discharge_efficiency {:g} gives a round-trip efficiency of {:.2f}; usual values are 0.8 "
        "to 0.95\n",
        name, battery.charge_efficiency, battery.discharge_efficiency, round_trip);
  }
}

/// Applies a document; unknown keys are an error. Throws UserError.
void apply_document(const TomlValue& document, const std::vector<Key>& keys) {
  std::string error;
  TomlTable root(&document, *document.file, "", error);
  for (auto key = keys.begin(); key != keys.end();) {
    const std::string& section = key->section;
    TomlTable table(root.table(section), *document.file, "[" + section + "]", error);
    for (; key != keys.end() && key->section == section; ++key) key->read(table);
    table.finish();
  }
  root.finish();
  if (!error.empty()) fail("{}; 'bess-train config' lists all keys", error);
}

}  // namespace

RunConfig parse_run_config(std::string_view text, const std::string& name) {
  RunConfig config;
  apply_config_text(config, text, name);
  require_consistent(config, name);
  return config;
}

RunConfig load_run_config(const std::filesystem::path& path, ContextKind unless_said) {
  RunConfig config;
  config.train.context = unless_said;
  if (path.empty()) return config;
  apply_config_text(config, read_file(path, kTomlBytesMax), path.string());
  require_consistent(config, path.string());
  return config;
}

void set_config_key(RunConfig& config, std::string_view key, const TomlValue& value) {
  const std::size_t dot = key.find('.');
  const std::string name(key.substr(dot == key.npos ? key.size() : dot + 1));
  TomlValue section = value;
  section.held = TomlMembers{{name, value}};
  TomlValue document = section;
  document.held = TomlMembers{{std::string(key.substr(0, dot)), section}};
  if (name.empty()) {
    fail("{}:{}: \"{}\" is not a configuration key: use section.key, such as distil.fidelity",
         *value.file, value.line, one_line(key));
  }
  apply_document(document, KeyList(config).keys);
}

void apply_config_text(RunConfig& config, std::string_view text, const std::string& name) {
  TomlValue document;
  std::string error;
  if (!parse_toml_text(text, name, document, error)) throw UserError(error);
  apply_document(document, KeyList(config).keys);
}

void require_consistent(const RunConfig& config, const std::string& name) {
  if (const char* wrong = battery_contradiction(config.battery)) {
    fail("{}: [battery] {}", name, wrong);
  }
  if (config.initial_soc_frac < config.battery.soc_min_frac ||
      config.initial_soc_frac > config.battery.soc_max_frac) {
    fail("{}: [battery] initial_soc {:g} is outside soc_min {:g} .. soc_max {:g}", name,
         config.initial_soc_frac, config.battery.soc_min_frac, config.battery.soc_max_frac);
  }
  if (config.train.value_min_eur_per_h >= config.train.value_max_eur_per_h) {
    fail("{}: [train] value_min_eur_per_h must be below value_max_eur_per_h", name);
  }
  if (config.train.residual && config.train.horizon != Horizon::kContinuing) {
    fail("{}: [train] horizon = \"day\" needs residual = false: the SDP has no end of day", name);
  }
  const TrainOptions& train = config.train;
  if (train.context == ContextKind::kOutlook &&
      (!train.residual || train.source != Source::kCounterfactual)) {
    fail(
        "{}: [train] context = \"outlook\" needs residual = true and source = "
        "\"counterfactual\", because the network is a residual on the plan; or set context = "
        "\"level\"",
        name);
  }
  if (config.train.residual && config.train.atoms % 2 == 0) {
    fail("{}: [train] residual needs an odd number of atoms, not {}: the middle one is zero", name,
         config.train.atoms);
  }
  if (!config.distil.correction.thresholds.are_ordered()) {
    fail("{}: [correction] low_price_eur_per_mwh must be below high_price_eur_per_mwh", name);
  }
  require_plausible(config, name);
}

void warn_long_training(const RunConfig& config) {
  const double hours = training_hours(config.train);
  if (hours <= kLong_h) return;
  fmt::print(stderr,
             "bess-train: warning: {} steps of {} transitions take about {} on {} core{}; reduce "
             "[train] steps or batch_size\n",
             config.train.steps, config.train.batch_size, duration_text(hours),
             config.train.threads, config.train.threads == 1 ? "" : "s");
}

Entries config_entries(const RunConfig& config) {
  RunConfig copy = config;
  const KeyList list(copy);
  Entries entries;
  for (const Key& key : list.keys) {
    entries.emplace_back(fmt::format("[{}] {}", key.section, key.name), key.get());
  }
  return entries;
}

std::string format_run_config(const RunConfig& config) {
  RunConfig copy = config;
  const KeyList list(copy);
  std::string text;
  std::string section;
  for (const Key& key : list.keys) {
    if (key.section != section) {
      section = key.section;
      text += fmt::format("{}[{}]\n", text.empty() ? "" : "\n", section);
    }
    text += fmt::format("{} = {}  # {}\n", key.name, key.get(), key.comment);
  }
  return text;
}

std::vector<ChangedKey> changed_keys(const RunConfig& config, const RunConfig& standard) {
  const Entries here = config_entries(config);
  const Entries there = config_entries(standard);
  std::vector<ChangedKey> changed;
  for (std::size_t k = 0; k < here.size(); ++k) {
    if (here[k].second == there[k].second) continue;
    changed.push_back({here[k].first, here[k].second, there[k].second});
  }
  return changed;
}

std::string changed_keys_text(const RunConfig& config) {
  std::string text;
  for (const ChangedKey& changed : changed_keys(config)) {
    text += fmt::format("{}{} = {} (default {})", text.empty() ? "" : "; ", changed.key,
                        changed.value, changed.standard);
  }
  return text.empty() ? "none: every key has its default" : text;
}

RunConfig canonical(RunConfig config, double rate_step_percent) {
  double rate_per_h = config.battery.power_w_max / config.battery.capacity_wh;
  if (rate_step_percent > 0) {
    const double step = std::log1p(rate_step_percent / 100);
    rate_per_h = std::exp(step * std::round(std::log(rate_per_h) / step));
  }
  const double scale = BatteryParameters{}.capacity_wh / config.battery.capacity_wh;
  config.battery.standby_w *= scale;
  config.battery.response.ramp_w_per_s *= scale;
  config.battery.capacity_wh = BatteryParameters{}.capacity_wh;
  config.battery.power_w_max =
      std::stod(fmt::format("{:.12g}", rate_per_h)) * config.battery.capacity_wh;
  return config;
}

std::string learning_key(const RunConfig& config, const std::string& rules) {
  RunConfig copy = config;
  const KeyList list(copy);
  std::string text;
  for (const Key& key : list.keys) {
    if (key.is_learning) text += fmt::format("[{}] {} = {}\n", key.section, key.name, key.get());
  }
  return text + rules;
}

}  // namespace bess
