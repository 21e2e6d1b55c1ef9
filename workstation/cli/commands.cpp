#include "workstation/cli/commands.h"

#include <fmt/core.h>

#include <memory>

#include "workstation/report/figures/html.h"
#include "workstation/runs/chain/run_config.h"

namespace bess {

namespace {

// bess-train config: every key with its default, range and meaning.

void add_config_command(ProgramCommand& app) {
  auto path = std::make_shared<std::string>();
  ProgramCommand command = app.subcommand("config", "print the configuration as commented TOML");
  command.option("--config", *path, "file whose values replace the defaults");
  command.footer(
      "Examples:\n"
      "  bess-train config > my.toml\n"
      "  bess-train config --config my.toml     # checks it and shows the values in force");
  command.runs([path] { fmt::print("{}", format_run_config(load_run_config(*path))); });
}

// bess-train schema: members of the --json answers and columns of the tables.

void add_schema_command(ProgramCommand& app) {
  ProgramCommand command =
      app.subcommand("schema", "print the JSON schema of --json answers and table columns");
  command.footer(
      "JSON Schema, draft 2020-12. Each answer has \"schema_version\" and its kind as "
      "\"answer\".\n"
      "Examples:\n"
      "  bess-train schema > answers.schema.json");
  command.runs([] { fmt::print("{}", page_file("answers.schema.json")); });
}

}  // namespace

void add_commands(ProgramCommand& app) {
  add_run_command(app);
  add_report_command(app);
  add_runs_commands(app);
  add_refresh_command(app);
  add_sweep_commands(app);
  app.group("Run commands", {"run", "report", "runs", "refresh", "sweep"});
  add_prices_commands(app);
  add_battery_commands(app);
  add_rules_commands(app);
  app.group("Input commands", {"prices", "battery", "rules"});
  add_train_command(app);
  add_distil_command(app);
  add_verify_command(app);
  add_export_command(app);
  add_omega_sweep_command(app);
  app.group("Single-stage commands", {"train", "distil", "verify", "export", "omega-sweep"});
  add_evaluate_command(app);
  add_backtest_command(app);
  add_size_command(app);
  add_impact_command(app);
  add_log_commands(app);
  app.group("Evaluation commands", {"evaluate", "backtest", "size", "impact", "log"});
  add_config_command(app);
  add_schema_command(app);
  app.group("Reference commands", {"config", "schema"});
}

}  // namespace bess
