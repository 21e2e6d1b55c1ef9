#include "workstation/cli/commands.h"

namespace bess {

void add_commands(CLI::App& app) { add_prices_commands(app); }

}  // namespace bess
