#include "workstation/report/report.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "shared/units_and_limits.h"
#include "workstation/report/comparison.h"
#include "workstation/report/foresight_gap.h"
#include "workstation/report/headline.h"
#include "workstation/report/page_data.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPage = "report.html";
constexpr const char* kPageKind = "Battery arbitrage: trained, corrected and proved policy";
constexpr const char* kFailedKind = "Battery arbitrage: trained policy, proof failed";

/// "8 MW, 16 MWh" or "4 kW, 8 kWh"
std::string size_text(const BatteryParameters& battery) {
  const bool is_small = battery.power_w_max < 1e6;
  return fmt::format("{0:g} {2}W, {1:g} {2}Wh", battery.power_w_max / (is_small ? 1e3 : 1e6),
                     battery.capacity_wh / (is_small ? 1e3 : 1e6), is_small ? 'k' : 'M');
}

std::string battery_text(const BatteryParameters& battery) {
  return fmt::format("{}, round-trip efficiency {:.1f} %, SoC {:.0f} to {:.0f} %",
                     size_text(battery),
                     100 * battery.charge_efficiency * battery.discharge_efficiency,
                     100 * battery.soc_min_frac, 100 * battery.soc_max_frac);
}

/// Run, prices, battery and date, as far as known: "first, market.csv, 8 MW, 16 MWh, 2026-11-23"
std::string title_of(const RunResults& in) {
  const auto fact = [&](std::string_view name, std::string_view end) {
    const auto found = std::ranges::find(in.facts, name, &Entries::value_type::first);
    return found == in.facts.end() ? "" : found->second.substr(0, found->second.rfind(end)) + ", ";
  };
  const std::string title =
      fact("run", "\n") + fact("prices", ": ") + size_text(in.battery) + ", " + fact("date", "T");
  return title.substr(0, title.size() - 2);
}

/// Relation of the result to training days, and the walk-forward result.
std::string standing_html(const RunResults& in) {
  return fmt::format(
      "<div class=\"standing\">\n<p class=\"note\" id=\"test-days\">{}</p>\n<p class=\"note\" "
      "id=\"walk-forward\">{}</p>\n</div>\n",
      html_escaped(judged_days_text(judged_days(in.market, Split::kTest))),
      walk_forward_html(in.walk_forward));
}

std::string head_of(const RunResults& in) {
  const Certificate& certificate = in.corrected.certificate;
  const bool proved = certificate.covers_lattice_without_violation();
  const std::string text = fmt::format("<p class=\"verdict {}\">{}</p>\n",
                                       proved ? "proved" : "unproved", proof_sentence(certificate));
  const std::optional<Headline> headline = headline_of(in.evaluations);
  if (headline) return text + headline_html(*headline) + standing_html(in);
  return text + "<p>No corrected student was evaluated, so there is no policy to export.</p>\n";
}

std::string section_of(const std::string& id, const std::string& title, const std::string& body) {
  if (body.empty()) return {};
  return fmt::format("<section id=\"{}\" class=\"card\">\n<h2>{}</h2>\n{}</section>\n", id, title,
                     body);
}

std::string same_program_html(const std::vector<NamedEvaluation>& evaluations) {
  const std::string text = same_program_text(evaluations);
  return text.empty() ? text : fmt::format("<p class=\"note\">{}.</p>\n", html_escaped(text));
}

double capacity_mwh_of(const RunResults& in) { return in.battery.capacity_wh / kWattsPerMegawatt; }

std::string page_of(const RunResults& in, const PageSteps& steps,
                    const std::vector<DayLoss>& losses) {
  Entries facts = in.facts;
  facts.emplace_back("battery", battery_text(in.battery));
  const std::optional<RulePrices> prices = rule_prices_of(in.evaluations);
  const bool has_failed = !in.broken.empty();
  const Certificate& plain = in.plain->certificate;
  const Certificate& corrected = in.corrected.certificate;
  return format_report_page(
      {{"title", html_escaped(title_of(in))},
       {"kind", has_failed ? kFailedKind : kPageKind},
       {"head", head_of(in)},
       {"failure", section_of("failure", "Where the proof failed", failure_html(in.broken))},
       {"failure_link", has_failed ? "<li><a href=\"#failure\">Failed proof</a></li>\n" : ""},
       {"comparison",
        section_of("comparison", "Profit of each policy",
                   comparison_html(in.evaluations) + same_program_html(in.evaluations) +
                       whole_battery_html(in.evaluations))},
       {"lost", section_of("lost", "Gap to perfect foresight",
                           foresight_gap_html(losses, capacity_mwh_of(in)))},
       {"lost_link", "<li><a href=\"#lost\">Gap to foresight</a></li>\n"},
       {"rules", section_of("rules", "Rules",
                            rules_html(plain, corrected, in.corrected.net.context.kind,
                                       prices ? &*prices : nullptr))},
       {"rules_link", corrected.rules.empty() ? "" : "<li><a href=\"#rules\">Rules</a></li>\n"},
       {"proof", section_of("proof", "Proof", proof_html(plain, corrected))},
       {"provenance",
        section_of("provenance", "Provenance", provenance_html(facts, in.corrected.provenance))}},
      page_data(in, steps));
}

}  // namespace

std::vector<std::string> write_report(const RunResults& run, const fs::path& folder) {
  if (run.market.days_of(Split::kTest).empty()) {
    fail("no test days (local days 26 to the end) in these prices; add prices");
  }
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) fail("{}: cannot create: {}", folder.string(), error.message());
  std::vector<std::string> names{kPage};
  const std::vector<DayLoss> losses = losses_of(run);
  const PageSteps steps = page_steps(run);
  std::vector<PictureFile> pictures = page_pictures(run, steps);
  std::ranges::move(foresight_gap_files(losses, capacity_mwh_of(run)),
                    std::back_inserter(pictures));
  for (const PictureFile& picture : pictures) {
    write_file(folder / picture.name, picture.csv);
    names.push_back(picture.name);
  }
  write_file(folder / kPage, page_of(run, steps, losses));
  return names;
}

}  // namespace bess
