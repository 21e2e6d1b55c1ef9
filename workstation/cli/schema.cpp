// bess-train schema: what the answers of --json and the tables hold.
#include <fmt/core.h>

#include "workstation/cli/commands.h"
#include "workstation/report/figures/page_files.h"

namespace bess {

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

}  // namespace bess
