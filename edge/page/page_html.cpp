#include "edge/page/page_html.h"

#include "edge/page/html_number.h"
#include "shared/host/html_text.h"
#include "shared/host/text.h"
#include "shared/local_text.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr NumberStyle kPercent{1, 1, "%"};
constexpr NumberStyle kPercentOfE4{1, 100, "%"};
constexpr NumberStyle kPercentOfOne{1, 0.01, "%"};
constexpr NumberStyle kWatts{0, 1, "W"};
constexpr NumberStyle kPrice{2, 1, "EUR/MWh"};
constexpr NumberStyle kPriceOfCenti{2, 100, "EUR/MWh"};
constexpr NumberStyle kEur{2, 1, "EUR", true};
constexpr NumberStyle kKwh{1, 1, "kWh"};
constexpr NumberStyle kCount{0, 1, ""};
constexpr NumberStyle kCycles{2, 1, ""};

std::string escaped(JsonValue value, const char* otherwise = "\u2013") {
  const char* const text = value.text_or(otherwise);
  return html_escaped(*text == '\0' ? otherwise : text);
}

std::string tile(const char* name, const std::string& value, const std::string& note = "") {
  return formatted("<div class=\"tile\"><dt>%s</dt><dd>", name) + value +
         (note.empty() ? "" : " <small>" + note + "</small>") + "</dd></div>\n";
}

std::string section(const char* id, const char* title, const std::string& inside) {
  return formatted("<section id=\"%s\" aria-labelledby=\"%s-h\">\n<h2 id=\"%s-h\">%s</h2>\n", id,
                   id, id, title) +
         inside + "</section>\n";
}

std::string trouble_of(const Answer& answer) {
  if (answer.trouble.empty()) return "";
  return "<p class=\"bad\">" + html_escaped(answer.trouble) + "</p>\n";
}

std::string health_badge(const ControllerView& view) {
  const JsonValue health = view.status.json.value()["health"];
  const std::string text = health.text_or("not known");
  const char* const style = text == "ok" ? "good" : text == "degraded" ? "fair" : "bad";
  return formatted("<p class=\"badge %s\" role=\"status\">", style) + html_escaped(text) + "</p>\n";
}

std::string alarms(const ControllerView& view) {
  const JsonValue status = view.status.json.value();
  const JsonValue reasons = status["health_reasons"];
  std::string text = trouble_of(view.status);
  if (reasons.size() > 0) {
    text += "<ul class=\"alarms\">\n";
    for (const JsonValue reason : reasons) text += "<li>" + escaped(reason) + "</li>\n";
    text += "</ul>\n";
  }
  if (status["contact"].text() == nullptr) return text;
  return text + "<p>Call: " + escaped(status["contact"]) + "</p>\n";
}

/// The newest local day of the month's account; null when there is none.
JsonValue newest_day(const ControllerView& view, std::size_t& index) {
  JsonValue newest;
  const JsonValue days = view.month.json.value()["days"];
  index = days.size() == 0 ? 0 : days.size() - 1;
  for (const JsonValue day : days) newest = day;
  return newest;
}

/// Of a student by outlook.
std::string break_even_tile(JsonValue last) {
  const std::string_view source = last["outlook"].text_or("none");
  if (source == "none") return "";
  return tile("Break-even",
              html_number(last["break_even_centi"], "status/last/break_even_centi", kPriceOfCenti),
              source == "planned" ? "by day-ahead prices" : escaped(last["outlook"]));
}

std::string now_tiles(const ControllerView& view) {
  const JsonValue last = view.status.json.value()["last"];
  std::size_t day_index = 0;
  const JsonValue day = newest_day(view, day_index);
  const std::string day_path = formatted("month/days/%zu/earned_eur", day_index);
  return "<dl class=\"tiles\">\n" +
         tile("State of charge", html_number(last["soc_e4"], "status/last/soc_e4", kPercentOfE4)) +
         tile("Ordered",
              html_number(last["ordered_power_w"], "status/last/ordered_power_w", kWatts),
              "by " + escaped(last["reason"])) +
         tile("Measured",
              html_number(last["battery_power_w"], "status/last/battery_power_w", kWatts),
              "charging is positive") +
         tile("Price", html_number(last["price_centi_eur_per_mwh"],
                                   "status/last/price_centi_eur_per_mwh", kPriceOfCenti)) +
         break_even_tile(last) +
         tile("Earned", html_number(day["earned_eur"], day_path, kEur),
              "on " + escaped(day["date"])) +
         tile("Mode", escaped(last["mode"])) + "</dl>\n";
}

std::string margins(JsonValue why) {
  const JsonValue at = why["margins"];
  if (!at.is_object()) return "<p>The student was not asked: nothing to tell of its margins.</p>\n";
  std::string text =
      "<p>It charges up to " +
      html_number(at["charge_up_to_eur_per_mwh"], "why/margins/charge_up_to_eur_per_mwh", kPrice) +
      " and discharges from " +
      html_number(at["discharge_from_eur_per_mwh"], "why/margins/discharge_from_eur_per_mwh",
                  kPrice) +
      " on; between them it rests.</p>\n";
  const JsonValue charge = at["charge_up_to_soc_percent"];
  const JsonValue discharge = at["discharge_from_soc_percent"];
  if (charge.number()) {
    text += "<p>At this price it would charge up to " +
            html_number(charge, "why/margins/charge_up_to_soc_percent", kPercent) +
            " of charge.</p>\n";
  }
  if (discharge.number()) {
    text += "<p>At this price it would discharge from " +
            html_number(discharge, "why/margins/discharge_from_soc_percent", kPercent) +
            " of charge on.</p>\n";
  }
  return text;
}

std::string why_section(const ControllerView& view) {
  const JsonValue why = view.why.json.value();
  if (!view.why.trouble.empty()) return trouble_of(view.why);
  std::string text =
      "<p>At " + escaped(why["local"]) + " it ordered " +
      html_number(why["ordered_power_w"], "why/ordered_power_w", kWatts) + ", decided by <strong>" +
      escaped(why["reason"]) + "</strong>, which has held for " +
      html_number(why["cycles_with_reason"], "why/cycles_with_reason", kCount) + " cycles";
  const std::string ends = why["ends"].text_or("");
  text += (ends.empty() ? "" : "; " + html_escaped(ends)) + ".</p>\n";
  text += "<p>Price " + html_number(why["price_eur_per_mwh"], "why/price_eur_per_mwh", kPrice) +
          ", state of charge " + html_number(why["soc_percent"], "why/soc_percent", kPercent) +
          ". The student would <strong>" + escaped(why["student"]) + "</strong>.</p>\n";
  return text + margins(why);
}

std::string next_decision(JsonValue next) {
  if (!next.is_object()) return "<p>No controller runs: nothing is decided next.</p>\n";
  std::string text = "<p>At " + escaped(next["local"]);
  if (next["power_w"].number()) {
    text += " it would <strong>" + escaped(next["action"]) + "</strong>, " +
            html_number(next["power_w"], "status/next/power_w", kWatts) +
            ", if price and state of charge stay.";
  } else {
    text += " nothing is driven without a price and a measurement.";
  }
  const std::string reason = next["reason"].text_or("");
  if (!reason.empty()) {
    text += " <strong>" + html_escaped(reason) + "</strong> stands above it";
    const std::string ends = next["ends"].text_or("");
    text += (ends.empty() ? "" : ", " + html_escaped(ends)) + ".";
  }
  text += "</p>\n";
  std::size_t index = 0;
  for (const JsonValue change : next["reserve_changes"]) {
    text +=
        "<p>Reserve from " + escaped(change["utc"]) + ": " +
        html_number(change["soc_percent"],
                    formatted("status/next/reserve_changes/%zu/soc_percent", index++), kPercent) +
        ".</p>\n";
  }
  const JsonValue days = next["full_charge_in_days"];
  if (!days.number()) return text;
  return text + "<p>Days to the next full charge: " +
         html_number(days, "status/next/full_charge_in_days", kCount) + ".</p>\n";
}

std::string next_section(const ControllerView& view) {
  const JsonValue status = view.status.json.value();
  std::string text = next_decision(status["next"]);
  const JsonValue no_effect = status["no_effect"];
  if (no_effect.size() == 0) return text;
  text += "<p>Set, and without effect:</p>\n<ul>\n";
  for (const JsonValue key : no_effect) text += "<li>" + escaped(key) + "</li>\n";
  return text + "</ul>\n";
}

std::string legend(bool has_idle) {
  return std::string("<ul class=\"legend\"><li><i class=\"charge\"></i>charging</li>") +
         (has_idle ? "<li><i class=\"idle\"></i>resting</li>" : "") +
         "<li><i class=\"discharge\"></i>discharging</li></ul>\n";
}

std::string scrolling(const char* name, const std::string& picture) {
  return formatted("<div class=\"wide\" role=\"region\" tabindex=\"0\" aria-label=\"%s\">\n",
                   name) +
         picture + "</div>\n";
}

std::string day_section(const ControllerView& view) {
  if (view.day_records.empty()) return "<p>The decision log holds nothing yet.</p>\n";
  return "<p>" + html_escaped(local_text(view.day_records.front().utc_s).view().substr(0, 10)) +
         ", " + std::to_string(view.day_records.size()) + " cycles, local time.</p>\n" +
         legend(false) + scrolling("The day", day_picture(view.day_records, view.day));
}

std::string map_section(const ControllerView& view) {
  if (!view.map) return "<p>Nothing was decided by the student in the newest cycle.</p>\n";
  return "<p>What the student would do at this minute, at other prices and states of charge: its "
         "own integers, "
         "proved to be monotone. Limits of the battery, the house and people stand above "
         "it.</p>\n" +
         legend(true) +
         scrolling("Decisions around the present", decision_map_picture(*view.map, view.now));
}

std::string month_row(JsonValue day, std::size_t index) {
  const auto cell = [&](const char* label, const char* key, const NumberStyle& style) {
    return formatted("<td data-label=\"%s\">", label) +
           html_number(day[key], formatted("month/days/%zu/%s", index, key), style) + "</td>";
  };
  return "<tr><th scope=\"row\">" + escaped(day["date"]) + "</th>" +
         cell("earned", "earned_eur", kEur) + cell("charged", "charged_kwh", kKwh) +
         cell("discharged", "discharged_kwh", kKwh) + cell("full cycles", "full_cycles", kCycles) +
         cell("cycles driven", "driven_cycles", kCount) +
         cell("mean price", "mean_price_eur_per_mwh", kPrice) +
         cell("of it an estimate", "estimated_eur", kEur) + cell("contract", "contract_eur", kEur) +
         cell("net", "net_eur", kEur) +
         cell("quarter-hours settled", "settled_quarter_hours", kCount) + "</tr>\n";
}

/// What kept the student from deciding, and what that cost.
std::string stops_of(JsonValue month) {
  const JsonValue stops = month["stops"];
  if (!stops.is_object()) return "";
  std::string text = "<p>Driven " +
                     html_number(stops["driven_share"], "month/stops/driven_share", kPercentOfOne) +
                     " of the time.";
  std::size_t index = 0;
  for (const JsonValue stop : stops["by_reason"]) {
    const std::string path = formatted("month/stops/by_reason/%zu/", index++);
    text += " " + escaped(stop["reason"]) + ": " +
            html_number(stop["cycles"], path + "cycles", kCount) + " cycles, cost ";
    text += stop["cost_eur"].number() ? html_number(stop["cost_eur"], path + "cost_eur", kEur)
                                      : std::string("not known");
    text += ".";
  }
  return text + "</p>\n";
}

std::string month_table(const ControllerView& view) {
  if (!view.month.trouble.empty()) return trouble_of(view.month);
  const JsonValue month = view.month.json.value();
  std::string text =
      "<p>" + html_number(month["earned_eur"], "month/earned_eur", kEur) +
      " earned by quarter-hours, " +
      html_number(month["settled_quarter_hours"], "month/settled_quarter_hours", kCount) + " of " +
      html_number(month["quarter_hours"], "month/quarter_hours", kCount) +
      " at their settled price, the others at the last of their minutes: " +
      html_number(month["estimated_eur"], "month/estimated_eur", kEur) +
      " is an estimate. The contract takes " +
      html_number(month["contract_eur"], "month/contract_eur", kEur) + ": " +
      html_number(month["net_eur"], "month/net_eur", kEur) +
      " net; with the same charge at both ends " +
      html_number(month["earned_at_equal_soc_eur"], "month/earned_at_equal_soc_eur", kEur) +
      ".</p>\n" + stops_of(month) +
      "<div class=\"wide\" role=\"region\" tabindex=\"0\" aria-label=\"The month by "
      "days\"><table>\n<caption>Local days</caption>\n<thead><tr>";
  for (const char* const head :
       {"day", "earned", "charged", "discharged", "full cycles", "cycles driven", "mean price",
        "of it an estimate", "contract", "net", "quarter-hours settled"}) {
    text += formatted("<th scope=\"col\">%s</th>", head);
  }
  text += "</tr></thead>\n<tbody>\n";
  std::size_t index = 0;
  for (const JsonValue day : month["days"]) text += month_row(day, index++);
  return text + "</tbody></table></div>\n";
}

std::string fact(const char* name, const std::string& value) {
  return formatted("<dt>%s</dt><dd>", name) + value + "</dd>\n";
}

std::string version_section(const ControllerView& view) {
  const JsonValue status = view.status.json.value();
  const JsonValue update = status["update"];
  std::string text =
      "<dl class=\"facts\">\n" + fact("version", escaped(status["version"])) +
      fact("student", escaped(status["student"])) +
      fact("learnt from", escaped(status["provenance"])) +
      fact("battery", escaped(status["battery"]) + ", map " + escaped(status["map"])) +
      fact("since", escaped(status["start_utc"]));
  if (update.is_object()) text += fact("update", escaped(update["phase"]));
  JsonValue newest;
  for (const JsonValue event : view.history.json.value()) newest = event;
  if (newest.exists()) {
    text += fact("last change", escaped(newest["utc"]) + ": " + escaped(newest["event"]) + " " +
                                    escaped(newest["version"], "") + ", certificate " +
                                    escaped(newest["header_sha256"]));
  }
  return text + "</dl>\n";
}

std::string field(const char* id, const char* label, const char* name, const char* attributes) {
  return formatted("<label for=\"%s\">%s</label><input id=\"%s\" name=\"%s\" %s/>\n", id, label, id,
                   name, attributes);
}

std::string order_form(const char* order, const char* button, const std::string& fields) {
  return "<form method=\"post\" action=\"orders\">\n" + fields +
         field(formatted("token-%s", order).c_str(), "token", "token",
               "type=\"password\" autocomplete=\"current-password\" required=\"required\"") +
         formatted("<button name=\"order\" value=\"%s\">%s</button></form>\n", order, button);
}

std::string orders_section(const OrderOutcome& outcome) {
  constexpr const char* kMinutes =
      "type=\"number\" min=\"2\" max=\"10080\" value=\"30\" required=\"required\"";
  std::string text;
  if (!outcome.text.empty()) {
    text = formatted("<p role=\"alert\" class=\"%s\">", outcome.is_refused ? "bad" : "good-text") +
           html_escaped(outcome.text) + "</p>\n";
  }
  text += order_form("hold", "hold this power",
                     field("hold-w", "W, negative discharges", "power_w",
                           "type=\"number\" step=\"1\" value=\"0\" required=\"required\"") +
                         field("hold-m", "minutes", "minutes", kMinutes));
  text += order_form("release", "end the hold", "");
  text += order_form(
      "limit", "limit the power",
      field("limit-c", "charge at most, W", "charge_w", "type=\"number\" min=\"0\"") +
          field("limit-d", "discharge at most, W", "discharge_w", "type=\"number\" min=\"0\"") +
          field("limit-m", "minutes", "minutes", kMinutes));
  text += order_form("unlimit", "end the limit", "");
  text += order_form("clear", "drive again after a trip", "");
  return text;
}

std::string head(const std::string& title) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
         "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"/>\n<title>" +
         html_escaped(title) +
         "</title>\n<link rel=\"stylesheet\" href=\"page.css\"/>\n<link rel=\"icon\" "
         "href=\"data:,\"/>\n"
         "<script src=\"page.js\" defer=\"defer\"></script>\n</head>\n<body>\n";
}

std::string foot(const ControllerView& view) {
  return "<footer><p>Seen at " + html_escaped(local_text(view.made_utc_s).view()) + " local, " +
         html_escaped(utc_text(view.made_utc_s).view()) +
         ". As numbers: <a href=\"api/status\">status</a>, <a href=\"api/why\">why</a>, "
         "<a href=\"api/month\">month</a>, <a href=\"api/today\">today</a>, <a "
         "href=\"api/map\">map</a>, "
         "<a href=\"metrics\">metrics</a>. <a href=\"statement\">Statement to "
         "print</a>.</p></footer>\n"
         "</body>\n</html>\n";
}

}  // namespace

std::string page_html(const ControllerView& view, const PageSettings& settings,
                      const OrderOutcome& outcome) {
  std::string text = head(settings.name + ": battery") + "<main id=\"live\">\n<header><h1>" +
                     html_escaped(settings.name) + "</h1>\n" + health_badge(view) + "</header>\n" +
                     alarms(view);
  text += section("now", "Now", now_tiles(view));
  text += section("why", "Why", why_section(view));
  text += section("next", "What next", next_section(view));
  text += section("day", "Today", day_section(view));
  text += section("map", "What would change it", map_section(view));
  text += section("month", "This month", month_table(view));
  text += section("versions", "What runs", version_section(view));
  text += "</main>\n";
  if (!settings.tokens.is_empty()) {
    text += "<div class=\"orders\">" + section("orders", "Orders", orders_section(outcome)) +
            "</div>\n";
  }
  return text + foot(view);
}

std::string statement_html(const ControllerView& view, const PageSettings& settings) {
  return head(settings.name + ": statement") + "<main>\n<header><h1>Statement of " +
         html_escaped(settings.name) + "</h1></header>\n" +
         section("month", "This month", month_table(view)) +
         section("versions", "What runs", version_section(view)) + "</main>\n" + foot(view);
}

}  // namespace bess
