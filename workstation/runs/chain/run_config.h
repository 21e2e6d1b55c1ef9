// Run configuration: all keys with default, range and meaning in one list (run_config.cpp). Errors
// in its TOML file name file, line and remedy. `bess-train config` prints the list as a commented
// file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "shared/battery_model.h"
#include "shared/host/toml_document.h"
#include "workstation/base/answer.h"
#include "workstation/correction/distillation/distil.h"
#include "workstation/data/env/market_steps.h"
#include "workstation/policy/rl/train.h"

namespace bess {

struct RunConfig {
  MarketOptions market;
  BatteryParameters battery;
  TrainOptions train;
  DistilOptions distil;
  double initial_soc_frac = 0.5;

  /// The same seed and thread count for training, distillation and proof.
  void set_seed(std::uint64_t seed) { train.seed = distil.seed = seed; }
  void set_threads(int threads) { train.threads = distil.threads = threads; }
};

/// Defaults overlaid with the file's keys; an empty path gives the defaults. `unless_said` is the
/// default context.
RunConfig load_run_config(const std::filesystem::path& path,
                          ContextKind unless_said = ContextKind::kLevel);
RunConfig parse_run_config(std::string_view text, const std::string& name);

/// Sets one key, "section.name"; errors name file, line and remedy. Call require_consistent() after
/// the last key.
void set_config_key(RunConfig& config, std::string_view key, const TomlValue& value);
/// Sets the keys of a TOML text; other keys keep their value.
void apply_config_text(RunConfig& config, std::string_view text, const std::string& name);
/// Throws UserError naming the keys that are contradictory or implausible, such as MW instead of W;
/// warns about unusual efficiencies. `name` is the file's.
void require_consistent(const RunConfig& config, const std::string& name);

/// Warning on stderr when the training of a network takes more than an hour.
void warn_long_training(const RunConfig& config);

/// Every key as "[section] name", with its value in TOML.
Entries config_entries(const RunConfig& config);

/// Configuration as commented TOML; reading it gives the same values.
std::string format_run_config(const RunConfig& config);

// Differences of a configuration from another one.

struct ChangedKey {
  std::string key;  ///< "[section] name"
  std::string value;
  std::string standard;
};

/// In the order of the list of keys; without seed, threads and rules.
std::vector<ChangedKey> changed_keys(const RunConfig& config, const RunConfig& standard = {});

/// "[market] observation_delay_min = 2 (default 1); ...", or that all keys have their default.
std::string changed_keys_text(const RunConfig& config);

// Learning class: configurations with the same student. The battery is scaled to the default
// capacity at its C-rate, so that 4 MW / 8 MWh and 4 kW / 8 kWh, whose students would differ only
// by rounding, are one class.

/// `config` at the canonical size, with the C-rate rounded to twelve digits. With a step it becomes
/// the nearest of 1, 1 + step, (1 + step)^2, ... and their reciprocals.
RunConfig canonical(RunConfig config, double rate_step_percent = 0);

/// Keys of a configuration that change a student, one per line, and rules; the other keys are of
/// evaluation alone.
std::string learning_key(const RunConfig& config, const std::string& rules);

}  // namespace bess
