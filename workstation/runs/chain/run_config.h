// Everything that can be set about learning and evaluating, with its defaults, ranges and meaning
// in one list (run_config.cpp). Read from TOML; an unknown key, a wrong type or a value out of
// range names the file, the line and the mend. `bess-train config` prints the list as a commented
// file.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "shared/battery_model.h"
#include "shared/host/toml_document.h"
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

  /// One seed and one number of threads serve training, distillation and proof.
  void set_seed(std::uint64_t seed) { train.seed = distil.seed = seed; }
  void set_threads(int threads) { train.threads = distil.threads = threads; }
};

/// Defaults overlaid with the file's keys; an empty path gives the defaults. `unless_said` is the
/// context where the file names none.
RunConfig load_run_config(const std::filesystem::path& path,
                          ContextKind unless_said = ContextKind::kLevel);
RunConfig parse_run_config(std::string_view text, const std::string& name);

/// Sets one key, "section.name", and says file, line and mend of a value that it cannot have. What
/// keys are to each other is looked at by require_consistent() once all are set.
void set_config_key(RunConfig& config, std::string_view key, const TomlValue& value);
/// Sets the keys of a TOML text as a configuration's file has them; the others stay.
void apply_config_text(RunConfig& config, std::string_view text, const std::string& name);
/// Throws UserError when keys contradict each other or cannot be meant; `name` is the file's.
void require_consistent(const RunConfig& config, const std::string& name);

/// Who reads a key. What only evaluation reads changes no byte of a student; each key says it where
/// it is defined, and none is without.
enum class KeyUse : std::uint8_t { kLearning, kEvaluation };
struct ConfigKey {
  std::string name;  ///< "[section] name"
  KeyUse use;
};
std::vector<ConfigKey> config_keys();

/// Every key as "[section] name", and its value as TOML writes it.
std::vector<std::pair<std::string, std::string>> config_entries(const RunConfig& config);

/// The configuration as a commented TOML file that reads back to the same values.
std::string format_run_config(const RunConfig& config);

}  // namespace bess
