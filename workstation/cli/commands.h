// Commands of bess-train: one file each in this folder, with options, help and action.
#pragma once

#include "shared/host/command_line.h"

namespace bess {

void add_prices_commands(ProgramCommand& app);
void add_rules_commands(ProgramCommand& app);
void add_train_command(ProgramCommand& app);
void add_distil_command(ProgramCommand& app);
void add_verify_command(ProgramCommand& app);
void add_evaluate_command(ProgramCommand& app);
void add_backtest_command(ProgramCommand& app);
void add_size_command(ProgramCommand& app);
void add_impact_command(ProgramCommand& app);
void add_omega_sweep_command(ProgramCommand& app);
void add_export_command(ProgramCommand& app);
void add_refresh_command(ProgramCommand& app);
void add_report_command(ProgramCommand& app);
void add_run_command(ProgramCommand& app);
void add_runs_commands(ProgramCommand& app);  ///< compare
void add_sweep_commands(ProgramCommand& app);
void add_battery_commands(ProgramCommand& app);  ///< fit
void add_log_commands(ProgramCommand& app);

/// All of them, grouped and ordered as in the help.
void add_commands(ProgramCommand& app);

}  // namespace bess
