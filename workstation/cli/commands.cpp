#include "workstation/cli/commands.h"

#include <fmt/core.h>

#include <memory>

#include "workstation/report/figures/page_files.h"
#include "workstation/runs/chain/run_config.h"

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

// bess-train config: every key with its default, range and meaning.

void add_config_command(ProgramCommand& app) {
  auto path = std::make_shared<std::string>();
  ProgramCommand command = app.subcommand("config", "Print the configuration as commented TOML");
  command.option("--config", *path, "File whose values replace the defaults");
  command.footer(
      "Examples:\n"
      "  bess-train config > my.toml\n"
      "  bess-train config --config my.toml     # checks it and shows what is in force");
  command.runs([path] { fmt::print("{}", format_run_config(load_run_config(*path))); });
}

// bess-train schema: what the answers of --json and the tables hold.

void add_schema_command(ProgramCommand& app) {
  ProgramCommand command = app.subcommand(
      "schema", "Print the JSON schema of what --json prints and of the columns of all tables");
  command.footer(
      "JSON Schema, draft 2020-12. Each answer names its \"schema_version\" and, as \"answer\", "
      "its kind.\n"
      "Examples:\n"
      "  bess-train schema > answers.schema.json");
  command.runs([] { fmt::print("{}", page_file("answers.schema.json")); });
}

// bess-train log: what a controller's log says, against other policies, another student, the bill.

void add_log_commands(ProgramCommand& app) {
  ProgramCommand log = app.subcommand(
      "log", "A controller's log: other policies, another student, a statement beside the bill");
  log.requires_subcommand();
  add_log_compare(log);
  add_log_replay(log);
  add_log_statement(log);
}

// bess-train prices: where minute files come from.

void add_prices_commands(ProgramCommand& app) {
  ProgramCommand prices = app.subcommand("prices", "Get, build or describe minute price files");
  prices.requires_subcommand();
  add_prices_simulate(prices);
  add_prices_reconstruct(prices);
  add_prices_import(prices);
  add_prices_fetch(prices);
  add_prices_stats(prices);
}

// bess-train rules: an operator's rules before anybody commits to them.

void add_rules_commands(ProgramCommand& app) {
  ProgramCommand rules = app.subcommand(
      "rules", "Your own rules: whom they bind, who breaks them, what they cost and change");
  rules.requires_subcommand();
  add_rules_check(rules);
  add_rules_price(rules);
}

// bess-train sweep: many runs, here or on a cluster.

void add_sweep_commands(ProgramCommand& app) {
  ProgramCommand sweep = app.subcommand(
      "sweep", "Many runs, here or on a cluster: plan, run, task, collect, packages");
  sweep.requires_subcommand();
  add_sweep_plan(sweep);
  add_sweep_run(sweep);
  add_sweep_task(sweep);
  add_sweep_collect(sweep);
  add_sweep_packages(sweep);
}

}  // namespace bess
