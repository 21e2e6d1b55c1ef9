// bess-train prices import: downloaded CSV and JSON to one minute file.
#include <fmt/format.h>

#include <filesystem>
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

std::string file_names(const std::vector<std::string>& paths) {
  std::string names;
  for (const std::string& path : paths) {
    names += (names.empty() ? "" : ", ") + std::filesystem::path(path).filename().string();
  }
  return names;
}

void run(const Options& options) {
  const JoinedMarket market = join_market(read_market_files(options.files), options.files.front());
  const std::string description = describe_join(market);
  write_minute_file(
      options.out, market.series,
      fmt::format("Imported by bess-train {} from {}\nElia open data: source Elia, CC BY 4.0\n{}",
                  BESS_VERSION, file_names(options.files), description));
  fmt::print("{}written to {}. Elia open data: source Elia, CC BY 4.0\n", description, options.out);
}

}  // namespace

void add_prices_import(CLI::App& prices) {
  auto options = std::make_shared<Options>();
  CLI::App* command = prices.add_subcommand(
      "import", "Join downloaded minute and quarter-hour files to a minute file");
  command
      ->add_option("files", options->files,
                   "Downloads of ods046, ods047, ods133, ods134, ods161, ods162, or ENTSO-E A85 "
                   "(XML); plain or .gz")
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
