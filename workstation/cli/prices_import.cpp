// bess-train prices import: downloaded CSV and JSON to one minute file.
#include <fmt/format.h>

#include <memory>

#include "workstation/cli/prices.h"
#include "workstation/market/market_files.h"
#include "workstation/market/market_join.h"

namespace bess {
namespace {

struct Options {
  std::vector<std::string> files;
  std::string out;
};

void run(const Options& options) {
  const JoinedMarket market = join_market(read_market_files(options.files), options.files.front());
  const std::string description = describe_join(market);
  write_minute_file(options.out, market.series,
                    fmt::format("Source: Elia open data (CC BY 4.0), imported by bess-train {}\n{}",
                                BESS_VERSION, description));
  fmt::print("{}written to {}. Source: Elia open data (CC BY 4.0)\n", description, options.out);
}

}  // namespace

void add_prices_import(CLI::App& prices) {
  auto options = std::make_shared<Options>();
  CLI::App* command = prices.add_subcommand(
      "import",
      "Join downloaded minute and quarter-hour files (Elia CSV or JSON) to a minute file");
  command
      ->add_option("files", options->files,
                   "Downloads of ods046, ods047, ods133, ods134, ods161, ods162; plain or .gz")
      ->required();
  command->add_option("--out", options->out, "Minute file to write (.csv or .csv.gz)")->required();
  command->footer(
      "Later files win where two have the same minute.\n"
      "Examples:\n"
      "  bess-train prices import ods133.csv ods134.csv --out prices.csv.gz\n"
      "  bess-train prices import today/*.json --out today.csv");
  command->callback([options] { run(*options); });
}

}  // namespace bess
