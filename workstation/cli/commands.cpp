#include "workstation/cli/commands.h"

namespace bess {

void add_commands(ProgramCommand& app) {
  add_run_command(app);
  add_runs_commands(app);
  add_sweep_commands(app);
  add_prices_commands(app);
  add_train_command(app);
  add_distil_command(app);
  add_rules_commands(app);
  add_verify_command(app);
  add_evaluate_command(app);
  add_backtest_command(app);
  add_size_command(app);
  add_impact_command(app);
  add_omega_sweep_command(app);
  add_export_command(app);
  add_report_command(app);
  add_refresh_command(app);
  add_battery_commands(app);
  add_log_commands(app);
  add_config_command(app);
  add_schema_command(app);
}

}  // namespace bess
