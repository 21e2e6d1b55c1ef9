#include "workstation/chain/day_ahead_input.h"

#include <fmt/core.h>

#include <filesystem>

#include "shared/host/file.h"
#include "workstation/market/series/day_ahead_plausibility.h"

namespace bess {

void DayAheadInput::add(ProgramCommand& command) {
  command.option("--day-ahead", path_,
                 "Day-ahead prices to plan on: a file of 'prices fetch --day-ahead', "
                 "'prices import --day-ahead' or 'prices simulate --day-ahead-out'");
}

std::shared_ptr<const DayAheadPublication> DayAheadInput::read(const MinuteSeries& settled,
                                                               const AcceptedFindings& accepted,
                                                               int published_min) const {
  return path_.empty() ? nullptr : read_day_ahead(path_, settled, accepted, published_min);
}

std::shared_ptr<const DayAheadPublication> read_day_ahead(const std::string& path,
                                                          const MinuteSeries& settled,
                                                          const AcceptedFindings& accepted,
                                                          int published_min) {
  const std::string text = read_file(path);
  DayAheadSeries series = parse_day_ahead_csv(text, path);
  std::vector<Finding> found = implausible_day_ahead(series);
  for (Finding& finding : shifted_day_ahead(series, settled)) found.push_back(std::move(finding));
  judge(found, accepted, {{path, text}});
  return std::make_shared<DayAheadPublication>(std::move(series), published_min);
}

void write_judged_day_ahead(const JoinedDayAhead& joined, const AcceptedFindings& accepted,
                            const std::vector<std::string>& files, const std::string& provenance,
                            const std::string& out) {
  std::vector<Finding> found = joined.findings;
  for (Finding& finding : implausible_day_ahead(joined.series)) found.push_back(std::move(finding));
  std::vector<std::string> contents;
  contents.reserve(files.size());  // the texts are views of them
  std::vector<PriceText> texts;
  for (const std::string& file : files) {
    contents.push_back(!found.empty() && std::filesystem::is_regular_file(file) ? read_file(file)
                                                                                : std::string());
    texts.push_back({file, contents.back()});
  }
  judge(found, accepted, texts);
  const std::string description = describe_day_ahead(joined);
  write_day_ahead_file(out, joined.series, provenance + "\n" + description);
  fmt::print("{}written to {}\n", description, out);
}

}  // namespace bess
