#include "workstation/sweep/sites.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "shared/host/csv.h"
#include "shared/host/file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/chain/rule_files.h"
#include "workstation/rules/rule_file.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSitesHeader = "id,class,power_w,capacity_wh,initial_soc,region";

/// Files that many sites name are read once.
class FilesBeside {
 public:
  explicit FilesBeside(fs::path folder) : folder_(std::move(folder)) {}

  const std::string& text(const std::string& name) {
    const auto [at, is_new] = texts_.try_emplace(name);
    if (is_new) at->second = read_file(folder_ / name, kTomlBytesMax);
    return at->second;
  }
  const RuleSet& rules(const std::string& names) {
    const auto [at, is_new] = rules_.try_emplace(names);
    if (!is_new) return at->second;
    std::vector<std::string> paths;
    for (std::size_t from = 0; from < names.size();) {
      const std::size_t end = std::min(names.find(' ', from), names.size());
      if (end > from) paths.push_back((folder_ / names.substr(from, end - from)).string());
      from = end + 1;
    }
    at->second = load_rules(paths);
    return at->second;
  }

 private:
  fs::path folder_;
  std::map<std::string, std::string> texts_;
  std::map<std::string, RuleSet> rules_;
};

/// "LOW:HIGH" as two keys of a configuration.
std::string thresholds_text(const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == text.npos) fail("thresholds \"{}\": write LOW:HIGH, such as 0:300", one_line(text));
  return fmt::format("[correction]\nlow_price_eur_per_mwh = {}\nhigh_price_eur_per_mwh = {}\n",
                     text.substr(0, colon), text.substr(colon + 1));
}

/// The columns of the CSV that are known, each by its place; those of keys by their name.
class Columns {
 public:
  Columns(std::string_view header, const CsvTable& table, const std::string& name) {
    CsvFields fields(header);
    for (std::string_view field; fields.take(field);) {
      const std::string column(field);
      if (column.find('.') != column.npos) {
        keys_.emplace_back(column, table.column(column));
      } else if (std::ranges::find(kKnown, column) != std::end(kKnown)) {
        places_[column] = table.column(column);
      } else {
        fail(
            "{}: unknown column \"{}\"; use id, battery, contract, rules, thresholds, region, or "
            "a key such as battery.power_w",
            name, one_line(column, 40));
      }
    }
    (void)table.column("id");
  }
  [[nodiscard]] std::string of(const CsvTable& table, std::size_t row, const char* name) const {
    const auto found = places_.find(name);
    return found == places_.end() ? std::string() : table.text(row, found->second);
  }
  [[nodiscard]] const std::vector<std::pair<std::string, std::size_t>>& keys() const {
    return keys_;
  }

 private:
  static constexpr std::string_view kKnown[] = {"id",    "battery",    "contract",
                                                "rules", "thresholds", "region"};
  std::map<std::string, std::size_t> places_;
  std::vector<std::pair<std::string, std::size_t>> keys_;
};

/// One site's configuration as it is written.
struct SiteConfig {
  RunConfig config;
  std::string rules;
};

SiteConfig config_of_site(const CsvTable& table, std::size_t row, const Columns& columns,
                          const RunConfig& base, FilesBeside& files) {
  SiteConfig site{base, {}};
  for (const char* column : {"battery", "contract"}) {
    const std::string file = columns.of(table, row, column);
    if (!file.empty()) apply_config_text(site.config, files.text(file), file);
  }
  const std::string thresholds = columns.of(table, row, "thresholds");
  if (!thresholds.empty())
    apply_config_text(site.config, thresholds_text(thresholds), "thresholds");
  for (const auto& [key, place] : columns.keys()) {
    const std::string& value = table.text(row, place);
    if (value.empty()) continue;
    const std::size_t dot = key.find('.');
    apply_config_text(
        site.config, fmt::format("[{}]\n{} = {}\n", key.substr(0, dot), key.substr(dot + 1), value),
        "column " + key);
  }
  const std::string rules = columns.of(table, row, "rules");
  if (!rules.empty()) use_rules(site.config, files.rules(rules), site.config.train.context);
  if (!site.config.distil.rules.empty()) site.rules = format_rules(site.config.distil.rules);
  return site;
}

}  // namespace

std::uint64_t fnv1a(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return hash;
}

RunConfig canonical(RunConfig config, double rate_step_percent) {
  double rate_per_h = config.battery.power_w_max / config.battery.capacity_wh;
  if (rate_step_percent > 0) {
    const double step = std::log1p(rate_step_percent / 100);
    rate_per_h = std::exp(step * std::round(std::log(rate_per_h) / step));
  }
  const double scale = BatteryParameters{}.capacity_wh / config.battery.capacity_wh;
  config.battery.standby_w *= scale;
  config.battery.response.ramp_w_per_s *= scale;
  config.battery.capacity_wh = BatteryParameters{}.capacity_wh;
  config.battery.power_w_max =
      std::stod(fmt::format("{:.12g}", rate_per_h)) * config.battery.capacity_wh;
  return config;
}

std::string learning_key(const RunConfig& config, const std::string& rules) {
  const Entries entries = config_entries(config);
  const std::vector<ConfigKey> keys = config_keys();
  std::string text;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    if (keys[k].use == KeyUse::kEvaluation) continue;
    text.append(entries[k].first).append(" = ").append(entries[k].second).append("\n");
  }
  return text + rules;
}

Sites read_sites(const fs::path& csv, const RunConfig& base, double rate_step_percent) {
  const std::string text = read_file(csv);
  const CsvTable table(text, csv.string());
  const Columns columns(csv_header(text), table, csv.string());
  FilesBeside files(csv.parent_path());
  Sites read;
  std::map<std::string, std::string> names;  // of keys
  std::set<std::string> ids, used;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    const std::string where = fmt::format("{}:{}", csv.string(), table.line(row));
    const std::string id = columns.of(table, row, "id");
    if (id.empty() || id.find_first_of("\t\n,/") != id.npos) {
      fail("{}: \"{}\" is no id of a site: it may not be empty or hold a comma, slash or tab",
           where, one_line(id, 40));
    }
    if (!ids.insert(id).second) fail("{}: site \"{}\" stands there twice", where, id);
    try {
      SiteConfig own = config_of_site(table, row, columns, base, files);
      require_consistent(own.config, where);
      const BatteryParameters& battery = own.config.battery;
      Site site{id,
                columns.of(table, row, "region"),
                battery.power_w_max,
                battery.capacity_wh,
                own.config.initial_soc_frac,
                {}};
      const RunConfig config = canonical(own.config, rate_step_percent);
      const std::string key = learning_key(config, own.rules);
      const auto [at, is_new] = names.try_emplace(key);
      if (is_new) {
        at->second = fmt::format("{:016x}", fnv1a(key));
        if (!used.insert(at->second).second) fail("two classes share the name {}", at->second);
        read.classes.push_back({at->second, config, std::move(own.rules)});
      }
      site.student = at->second;
      read.sites.push_back(std::move(site));
    } catch (const UserError& error) {
      const std::string what = error.what();
      if (what.starts_with(where)) throw;
      fail("{}: site \"{}\": {}", where, id, what);
    }
  }
  return read;
}

std::string format_sites(const std::vector<Site>& sites) {
  std::string text = fmt::format("{}\n", kSitesHeader);
  for (const Site& site : sites) {
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{}\n", csv_field(site.id),
                   site.student, site.power_w, site.capacity_wh, site.initial_soc_frac,
                   csv_field(site.region));
  }
  return text;
}

std::vector<Site> parse_sites(const std::string& text, const std::string& name) {
  const CsvTable table(text, name, kSitesHeader);
  std::vector<Site> sites;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    sites.push_back({table.text(row, 0), table.text(row, 5), table.number(row, 2),
                     table.number(row, 3), table.number(row, 4), table.text(row, 1)});
  }
  return sites;
}

}  // namespace bess
