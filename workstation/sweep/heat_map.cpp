#include "workstation/sweep/heat_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "workstation/report/figures/html.h"
#include "workstation/report/figures/sort_table.h"

namespace bess {
namespace {

std::string value_of(const FoldedSettings& row, const std::string& name) {
  const auto found = std::ranges::find(row.settings, name, &Entries::value_type::first);
  return found == row.settings.end() ? std::string() : found->second;
}

/// Numbers as numbers, other values as texts.
bool comes_before(const std::string& a, const std::string& b) {
  char* end_a = nullptr;
  char* end_b = nullptr;
  const double x = std::strtod(a.c_str(), &end_a);
  const double y = std::strtod(b.c_str(), &end_b);
  const bool are_numbers = !a.empty() && !b.empty() && *end_a == 0 && *end_b == 0;
  return are_numbers ? x < y : a < b;
}

std::vector<std::string> values_of(const std::vector<FoldedSettings>& rows,
                                   const std::string& name) {
  std::vector<std::string> values;
  for (const FoldedSettings& row : rows) {
    const std::string value = value_of(row, name);
    if (std::ranges::find(values, value) == values.end()) values.push_back(value);
  }
  std::ranges::sort(values, comes_before);
  return values;
}

struct Mean {
  double sum = 0;
  int count = 0;
  [[nodiscard]] double value() const { return sum / count; }
};

using Means = std::map<std::pair<std::string, std::string>, Mean>;

/// Faint for the lowest, strong for the highest: both leave the number legible, light and dark.
std::string cell_html(const Mean& mean, double low, double high, const std::string& label) {
  const double share = high > low ? (mean.value() - low) / (high - low) : 0.5;
  return fmt::format(
      "<td data-label=\"{}\" style=\"background:color-mix(in srgb, var(--charge) {:.0f}%, "
      "var(--paper))\"><span>{}</span></td>",
      html_escaped(label), 4 + 38 * share,
      html_escaped(with_true_minus(fmt::format("{:.1f}", mean.value()))));
}

std::string shown(const std::string& value) { return value.empty() ? "as configured" : value; }

}  // namespace

std::string heat_map_html(const std::vector<FoldedSettings>& rows, const std::string& across,
                          const std::string& down, const std::string& what, const std::string& id) {
  Means means;
  double low = 0, high = 0;
  for (const FoldedSettings& row : rows) {
    if (row.proved == 0) continue;
    Mean& mean = means[{value_of(row, down), value_of(row, across)}];
    mean.sum += row.mean;
    ++mean.count;
  }
  for (bool is_first = true; const auto& [at, mean] : means) {
    low = is_first ? mean.value() : std::min(low, mean.value());
    high = is_first ? mean.value() : std::max(high, mean.value());
    is_first = false;
  }
  const std::vector<std::string> columns = values_of(rows, across);
  std::string text = fmt::format(
      "<div class=\"wide\"><table id=\"{}\">\n<caption style=\"white-space:nowrap\">{}: "
      "{} across{}</caption>\n"
      "<thead><tr><th scope=\"col\">{}</th>",
      html_escaped(id), html_escaped(what), html_escaped(across),
      down.empty() ? "" : ", " + html_escaped(down) + " down",
      html_escaped(down.empty() ? "all" : down));
  for (const std::string& column : columns) {
    text += fmt::format("<th scope=\"col\">{}</th>", html_escaped(shown(column)));
  }
  text += "</tr></thead>\n<tbody>\n";
  for (const std::string& row :
       down.empty() ? std::vector<std::string>{""} : values_of(rows, down)) {
    text += fmt::format("<tr><th scope=\"row\">{}</th>",
                        html_escaped(down.empty() ? "mean" : shown(row)));
    for (const std::string& column : columns) {
      const auto found = means.find({row, column});
      text += found == means.end() ? fmt::format("<td data-label=\"{}\"><span>{}</span></td>",
                                                 html_escaped(shown(column)), kNoValue)
                                   : cell_html(found->second, low, high, shown(column));
    }
    text += "</tr>\n";
  }
  return text + "</tbody></table></div>\n";
}

}  // namespace bess
