#include "workstation/correction/rules/rule.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "shared/host/file.h"
#include "shared/host/text.h"
#include "shared/host/toml_reader.h"
#include "shared/host/user_error.h"

namespace bess {
namespace {

constexpr std::string_view kNameCharacters =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789 -_.,:()%+";
constexpr int kSocStepsPerOne = kSocCount - 1;

/// "17:00" as a quarter-hour; "24:00" is the end of the day. False for other texts.
bool parse_hour(std::string_view text, int& quarter_hour) {
  int hours = 0;
  int minutes = 0;
  if (text.size() != 5 || text[2] != ':' || !read_number(text.substr(0, 2), hours) ||
      !read_number(text.substr(3), minutes)) {
    return false;
  }
  if (hours < 0 || minutes < 0 || minutes > 59 || minutes % kMinutesPerQuarterHour != 0) {
    return false;
  }
  quarter_hour = hours * 4 + minutes / kMinutesPerQuarterHour;
  return quarter_hour <= kQuarterHourCount;
}

/// Reads one [[rule]].
class RuleReader {
 public:
  explicit RuleReader(TomlTable& table) : table_(table) {}

  Rule read() {
    read_name();
    read_hours();
    const bool has_months = table_.has("months");
    if (has_months && table_.has("context_classes")) {
      table_.fail("context_classes", "conflicts with months: remove one");
    }
    read_members("months", rule_.box.months);
    read_members("context_classes", rule_.box.context_classes);
    read_soc("soc_min", rule_.box.soc_index_min);
    read_soc("soc_max", rule_.box.soc_index_max);
    refuse_reversed("soc_min", rule_.box.soc_index_min, "soc_max", rule_.box.soc_index_max);
    read_price("price_min", rule_.box.price_min_eur_per_mwh);
    read_price("price_max", rule_.box.price_max_eur_per_mwh);
    refuse_reversed("price_min", rule_.box.price_min_eur_per_mwh, "price_max",
                    rule_.box.price_max_eur_per_mwh);
    table_.boolean("enforce", rule_.enforce);
    read_demand();
    table_.finish();
    return rule_;
  }

 private:
  void read_name() {
    table_.require("name");
    const std::string* name = table_.text("name");
    if (name == nullptr) return;
    const bool plain = name->find_first_not_of(kNameCharacters) == std::string::npos;
    if (name->empty() || name->size() > kNameLengthMax || !plain) {
      table_.fail("name", fmt::format("must have 1 to {} letters, digits, spaces or -_.,:()%+",
                                      kNameLengthMax));
    }
    rule_.name = *name;
  }

  void read_hours() {
    const std::string* text = table_.text("hours");
    if (text == nullptr) return;
    const std::size_t dash = text->find('-');
    int first = 0;
    int end = 0;
    if (dash == std::string::npos || !parse_hour(std::string_view(*text).substr(0, dash), first) ||
        !parse_hour(std::string_view(*text).substr(dash + 1), end) || first == kQuarterHourCount) {
      return table_.fail("hours", "must be two times in quarter-hours, like \"17:00-20:15\"");
    }
    const int count = (end - first + kQuarterHourCount) % kQuarterHourCount;
    if (count == 0) return table_.fail("hours", "covers the whole day or nothing: remove it");
    rule_.box.quarter_hour_first = first;
    rule_.box.quarter_hour_count = count;
  }

  void read_members(std::string_view key, std::int32_t& bits) {
    const TomlArray* list = table_.array(key);
    if (list == nullptr) return;
    bits = 0;
    for (const TomlValue& value : *list) {
      const auto* member = value.as<std::int64_t>();
      if (member == nullptr || *member < 1 || *member > 12) {
        return table_.fail(key, "must list whole numbers from 1 to 12");
      }
      bits |= 1 << (*member - 1);
    }
    if (bits == 0) table_.fail(key, "is empty: the rule would never apply; remove the key");
  }

  void read_soc(std::string_view key, std::int32_t& index) {
    const TomlValue* node = table_.node(key);
    if (node == nullptr) return;
    const auto value = node->number();
    if (!value || !(*value >= 0 && *value <= 1)) {
      return table_.fail(key, "must be a fraction between 0 and 1");
    }
    const double steps = *value * kSocStepsPerOne;
    if (std::fabs(steps - std::round(steps)) > 1e-6) {
      return table_.fail(key, "must be a multiple of 0.005: the resolution of the student's SoC");
    }
    index = static_cast<std::int32_t>(std::lround(steps));
  }

  void read_price(std::string_view key, std::int32_t& price) {
    table_.integer(key, price, -kThresholdMaxEurPerMwh, kThresholdMaxEurPerMwh);
  }

  void refuse_reversed(std::string_view low_key, int low, std::string_view high_key, int high) {
    if (low <= high) return;
    table_.fail(high_key, fmt::format("is below {}: the rule would never apply", low_key));
  }

  void read_demand() {
    if (table_.node("switches_max") != nullptr) {  // of an earlier version
      return table_.fail(
          "switches_max",
          "is no longer supported: by property 3 the action changes at most twice with the "
          "price; for a single change without idling write is_not = \"idle\"; against "
          "frequent changes use a dead band, is = \"idle\" with price_min and price_max");
    }
    const DemandKind* kind = nullptr;
    std::string_view found;
    std::vector<std::string_view> keys;
    for (const DemandKind& candidate : demand_kinds()) {
      for (const std::string_view key : candidate.keys) {
        keys.push_back(key);
        if (table_.node(key) == nullptr) continue;
        if (kind != nullptr) {
          return table_.fail(key, fmt::format("conflicts with {}: use a separate rule", found));
        }
        kind = &candidate;
        found = key;
      }
    }
    if (kind != nullptr) return kind->read(table_, found, rule_);
    table_.finish();  // reports a misspelt demand by its key
    table_.fail("", fmt::format("has no demand: add one of {}", fmt::join(keys, ", ")));
  }

  TomlTable& table_;
  Rule rule_;
};

void check_names(const RuleSet& set) {
  std::map<std::string, const Rule*> seen;
  for (const Rule& rule : set.rules) {
    const auto [first, is_new] = seen.emplace(rule.name, &rule);
    if (!is_new) {
      fail("{}: the name \"{}\" is already used at {}: rename one", rule.place, rule.name,
           first->second->place);
    }
  }
}

void check_thresholds(const RuleSet& set) {
  for (const Action action : {Action::kCharge, Action::kDischarge}) {
    const Rule* first = nullptr;
    for (const Rule& rule : set.rules) {
      if (!rule.is_threshold || rule.lowest() != action) continue;
      if (first != nullptr) {
        fail("{}: \"{}\" sets the same threshold as \"{}\" ({}): remove one", rule.place, rule.name,
             first->name, first->place);
      }
      first = &rule;
    }
  }
}

std::string members_line(std::string_view key, std::int32_t bits) {
  return bits == kAllTwelve ? "" : fmt::format("{} = [{}]\n", key, members_text(bits));
}

std::string box_lines(const RuleBox& box) {
  const RuleBox all;
  std::string text;
  if (box.quarter_hour_count != all.quarter_hour_count) {
    const int end = (box.quarter_hour_first + box.quarter_hour_count) % kQuarterHourCount;
    text += fmt::format("hours = \"{}-{}\"\n", hour_text(box.quarter_hour_first), hour_text(end));
  }
  text += members_line("months", box.months);
  text += members_line("context_classes", box.context_classes);
  const auto soc = [&text](std::string_view key, int index, int otherwise) {
    if (index != otherwise)
      text += fmt::format("{} = {:g}\n", key, index / double{kSocStepsPerOne});
  };
  soc("soc_min", box.soc_index_min, all.soc_index_min);
  soc("soc_max", box.soc_index_max, all.soc_index_max);
  const auto price = [&text](std::string_view key, int value, int otherwise) {
    if (value != otherwise) text += fmt::format("{} = {}\n", key, value);
  };
  price("price_min", box.price_min_eur_per_mwh, all.price_min_eur_per_mwh);
  price("price_max", box.price_max_eur_per_mwh, all.price_max_eur_per_mwh);
  return text;
}

void append_rules(std::string_view text, const std::string& name, RuleSet& set) {
  TomlValue document;
  std::string error;
  if (!parse_toml_text(text, name, document, error)) throw UserError(error);
  TomlTable top(&document, name, "", error);
  const TomlValue* const single = document.find("rule");
  if (single != nullptr && single->as<TomlMembers>() != nullptr) {
    fail("{}:{}: write [[rule]] instead of [rule]; a file may have several", name, single->line);
  }
  const TomlArray* list = top.array("rule");
  top.finish();
  if (!error.empty()) throw UserError(error);
  if (list == nullptr || list->empty()) fail("{}: has no [[rule]]", name);
  for (const TomlValue& value : *list) {
    if (value.as<TomlMembers>() == nullptr) fail("{}: rule must be written as [[rule]]", name);
    TomlTable table(&value, name, "[[rule]]", error);
    Rule rule = RuleReader(table).read();
    if (!error.empty()) throw UserError(error);
    rule.place = fmt::format("{}:{}", name, value.line);
    set.rules.push_back(std::move(rule));
  }
  check_names(set);
  check_thresholds(set);
}

}  // namespace

RuleSet parse_rules(std::string_view text, const std::string& name) {
  RuleSet set;
  append_rules(text, name, set);
  return set;
}

RuleSet load_rules(const std::vector<std::string>& paths) {
  RuleSet set;
  for (const std::string& path : paths) append_rules(read_file(path, kTomlBytesMax), path, set);
  return set;
}

std::string format_rules(const RuleSet& rules) {
  std::string text;
  for (const Rule& rule : rules.rules) {
    text += fmt::format("{}[[rule]]\nname = \"{}\"\n", text.empty() ? "" : "\n", rule.name);
    if (!rule.is_threshold) {
      text += box_lines(rule.box) + rule.demand->line();
    } else if (rule.lowest() == Action::kCharge) {
      text += fmt::format("charge_at_or_below = {}\n", rule.box.price_max_eur_per_mwh);
    } else {
      text += fmt::format("discharge_at_or_above = {}\n", rule.box.price_min_eur_per_mwh);
    }
    if (rule.enforce) text += "enforce = true\n";
  }
  return text;
}

}  // namespace bess
