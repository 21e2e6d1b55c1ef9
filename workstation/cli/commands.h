// The subcommands of bess-train: one file each in this folder, which declares its options, its help
// with examples, and runs it as the subcommand's callback.
#pragma once

#include <CLI/CLI.hpp>

#include <string>

#include "workstation/rl/train.h"

namespace bess {

/// Thrown when Ctrl-C stopped a command after it saved what it had.
struct Interrupted {};

void add_prices_commands(CLI::App& app);  ///< simulate, reconstruct, import, fetch, stats
void add_train_command(CLI::App& app);
void add_distil_command(CLI::App& app);
void add_verify_command(CLI::App& app);
void add_evaluate_command(CLI::App& app);
void add_delays_command(CLI::App& app);
void add_export_command(CLI::App& app);
void add_report_command(CLI::App& app);
void add_run_command(CLI::App& app);
void add_config_command(CLI::App& app);

// --- Pieces that `run` shares with the single subcommands ---------------------------------------

/// One line for the files made from this training.
std::string training_provenance(const std::string& prices, const TrainOptions& options,
                                const TrainResult& result);
/// One line on stderr when the support of C51 is too narrow for the values met.
void warn_narrow_support(const TrainOptions& options, const TrainResult& result);

/// Every subcommand, in the order of the help.
void add_commands(CLI::App& app);

}  // namespace bess
