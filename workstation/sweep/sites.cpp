#include "workstation/sweep/sites.h"

#include <fmt/format.h>

#include <set>
#include <sstream>

#include "shared/host/csv.h"
#include "shared/host/file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/base/binary_file.h"
#include "workstation/chain/learning_class.h"
#include "workstation/chain/rule_files.h"
#include "workstation/rules/rule_file.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSitesHeader = "id,class,power_w,capacity_wh,region";

/// Of the CSV, each by its name.
using Columns = std::map<std::string, std::size_t>;

Columns columns_of(std::string_view header, const CsvTable& table, const std::string& name) {
  const std::set<std::string> known{"id", "battery", "contract", "rules", "region"};
  Columns columns;
  CsvFields fields(header);
  for (std::string_view field; fields.take(field);) {
    const std::string column(field);
    if (column.find('.') == column.npos && !known.contains(column)) {
      fail(
          "{}: unknown column \"{}\"; use id, battery, contract, rules, region, or "
          "a key such as battery.power_w",
          name, one_line(column, 40));
    }
    columns[column] = table.column(column);
  }
  return columns;
}

/// One line of the CSV.
struct SiteRow {
  const CsvTable& table;
  const Columns& columns;
  std::size_t row;
  fs::path folder;  ///< that files are named from

  [[nodiscard]] std::string value(const char* column) const {
    const auto found = columns.find(column);
    return found == columns.end() ? std::string() : table.text(row, found->second);
  }
};

RuleSet rules_of(const SiteRow& site) {
  std::vector<std::string> paths;
  std::istringstream names(site.value("rules"));
  for (std::string name; names >> name;) paths.push_back((site.folder / name).string());
  return load_rules(paths);
}

RunConfig config_of(const SiteRow& site, RunConfig config) {
  for (const char* column : {"battery", "contract"}) {
    const std::string file = site.value(column);
    if (file.empty()) continue;
    apply_config_text(config, read_file(site.folder / file, kTomlBytesMax), file);
  }
  for (const auto& [key, place] : site.columns) {
    const std::string& value = site.table.text(site.row, place);
    if (value.empty() || key.find('.') == key.npos) continue;
    apply_config_text(config, fmt::format("{} = {}\n", key, value), "column " + key);
  }
  const RuleSet rules = rules_of(site);
  if (!rules.empty()) use_rules(config, rules, config.train.context);
  return config;
}

}  // namespace

Sites read_sites(const fs::path& csv, const RunConfig& base, double rate_step_percent) {
  const std::string text = read_file(csv);
  const CsvTable table(text, csv.string());
  const Columns columns = columns_of(csv_header(text), table, csv.string());
  Sites read;
  std::map<std::string, std::string> names;  // of keys
  std::set<std::string> ids, used;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    const std::string where = fmt::format("{}:{}", csv.string(), table.line(row));
    const SiteRow own{table, columns, row, csv.parent_path()};
    const std::string id = own.value("id");
    if (id.empty() || id.find_first_of("\t\n,/") != id.npos) {
      fail("{}: \"{}\" is no id of a site: it may not be empty or hold a comma, slash or tab",
           where, one_line(id, 40));
    }
    if (!ids.insert(id).second) fail("{}: site \"{}\" stands there twice", where, id);
    try {
      const RunConfig config = config_of(own, base);
      require_consistent(config, where);
      const RuleSet& rules = config.distil.rules;
      const std::string rules_text = rules.empty() ? "" : format_rules(rules);
      const RunConfig learnt = canonical(config, rate_step_percent);
      const std::string key = learning_key(learnt, rules_text);
      const auto [at, is_new] = names.try_emplace(key, fmt::format("{:016x}", fnv1a(key)));
      if (is_new && !used.insert(at->second).second) fail("two classes named {}", at->second);
      if (is_new) read.classes.push_back({at->second, learnt, rules_text});
      read.sites.push_back({id, own.value("region"), config.battery.power_w_max,
                            config.battery.capacity_wh, at->second});
    } catch (const UserError& error) {
      if (std::string_view(error.what()).starts_with(where)) throw;
      fail("{}: site \"{}\": {}", where, id, error.what());
    }
  }
  return read;
}

std::string format_sites(const std::vector<Site>& sites) {
  std::string text = fmt::format("{}\n", kSitesHeader);
  for (const Site& site : sites) {
    text += fmt::format("{},{},{},{},{}\n", csv_field(site.id), site.student, site.power_w,
                        site.capacity_wh, csv_field(site.region));
  }
  return text;
}

std::vector<Site> parse_sites(const std::string& text, const std::string& name) {
  const CsvTable table(text, name, kSitesHeader);
  std::vector<Site> sites;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    sites.push_back({table.text(row, 0), table.text(row, 4), table.number(row, 2),
                     table.number(row, 3), table.text(row, 1)});
  }
  return sites;
}

}  // namespace bess
