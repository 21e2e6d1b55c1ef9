#include "workstation/report/page_data.h"

#include <fmt/core.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <span>
#include <stdexcept>

#include "shared/host/csv.h"
#include "shared/utc_text.h"
#include "workstation/correction/rules/rule.h"
#include "workstation/correction/student/certificate.h"
#include "workstation/correction/student/student_policy.h"
#include "workstation/data/env/context_fit.h"
#include "workstation/report/figures/curves.h"
#include "workstation/report/figures/html.h"
#include "workstation/report/headline.h"

namespace bess {

namespace {

constexpr std::array<const char*, kRuleInputCount> kInputNames{"minute", "quarterHour",
                                                               "contextClass", "soc", "price"};

Json forbidden_actions(const Rule& rule) {
  Json list = Json::list();
  for (int a = 0; a < kActionCount; ++a) {
    if (!allows(rule.actions(), static_cast<Action>(a))) list.add(a);
  }
  return list;
}

Json rule_json(const Rule& rule, ContextKind kind) {
  Json json = Json::object({{"name", rule.name},
                            {"text", rule.text()},
                            {"held_by", held_by(rule, kind)},
                            {"binds_student", binds_student(rule, kind)}});
  if (const Direction direction = rule.demand->direction(); direction.sign != 0) {
    json.set("direction",
             Json::object({{"input", kInputNames[static_cast<std::size_t>(direction.input)]},
                           {"sign", direction.sign}}));
    return json;
  }
  const LatticeBox box = lattice_box_of(rule.box, kind);
  json.set("hours", Json::list_of(rule.box.quarter_hour_first, rule.box.quarter_hour_count));
  json.set("classes", box.classes);
  json.set("soc", Json::list_of(box.soc_first, box.soc_last));
  if (overlaps_lattice(rule.box)) {
    json.set("price", Json::list_of(kLatticePriceMinEurPerMwh + box.price_first,
                                    kLatticePriceMinEurPerMwh + box.price_last));
  }
  if (rule.restricts_actions() && !rule.is_threshold) {
    json.set("forbidden", forbidden_actions(rule));
  }
  return json;
}

/// Operator rules for the page (page/rule_boxes.js): region on the lattice, demand and scope.
/// One object per rule, in order:
///   name, text, held_by, binds_student
///   hours      [first quarter-hour, count], may pass midnight
///   classes    bit c - 1 of the student's context; all if the student has no month input
///   soc        [first, last] lattice index
///   price      [first, last] EUR/MWh of the lattice; omitted for a rule outside it
///   forbidden  actions that break it; omitted for rules on pairs of states and for thresholds
///              (properties 1 and 2)
///   direction  {input, sign} as in Direction; only for such rules, which have no box
Json rules_json(const RuleSet& rules, ContextKind kind) {
  return Json::list_from(rules.rules, [kind](const Rule& rule) { return rule_json(rule, kind); });
}

/// Calls `look` with each step on the page and its index among all records.
template <typename Look>
void for_each_step(const RunResults& in, const PageSteps& steps, Look look) {
  std::size_t first = 0;
  for (std::size_t d = 0; d < steps.days.size(); ++d) {
    const auto of_day = in.market.of(steps.days[d]);
    if (std::ranges::binary_search(steps.kept, d)) {
      for (std::size_t s = 0; s < of_day.size(); ++s) look(of_day[s], first + s);
    }
    first += of_day.size();
  }
}

PictureFile step_file(const RunResults& in, const PageSteps& steps) {
  std::string csv = "utc,observed_eur_per_mwh,paid_eur_per_mwh";
  for (const PolicySteps& policy : steps.policies) {
    for (const char* what : {"soc_frac", "action", "power_w", "profit_eur"}) {
      csv += "," + csv_field(fmt::format("{} {}", policy.name, what));
    }
  }
  for_each_step(in, steps, [&](const MarketStep& step, std::size_t i) {
    csv += fmt::format("\n{},{:.2f},{:.3f}", utc_text(step.utc_s).view(), step.observed_eur_per_mwh,
                       step.paid_eur_per_mwh);
    for (const PolicySteps& policy : steps.policies) {
      const StepRecord& r = policy.records[i];
      csv += fmt::format(",{:.4f},{},{:.1f},{:.4f}", r.soc_frac, action_name(r.action),
                         r.power_w + 0.0, r.profit_eur + 0.0);
    }
  });
  return {"steps.csv.gz", csv + "\n"};
}

constexpr int kNoonQuarterHour = 48;
constexpr int kMiddleMinute = 7;

/// Class of a step; by outlook for a battery in the middle of its SoC window.
int context_class_of(const RunResults& in, const MarketStep& step) {
  const StudentFile& student = in.corrected;
  const double middle_frac = 0.5 * (in.battery.soc_min_frac + in.battery.soc_max_frac);
  return student.net.context.class_of(
      step.month, student.outlook ? student.outlook->break_even_centi(step, middle_frac)
                                  : step.level_centi_eur_per_mwh);
}

/// Initial state of the map: most frequent class of the test days, at noon.
LatticeState first_map(const RunResults& in) {
  std::array<std::size_t, kContextClassCount + 1> steps{};
  for (const MarketDay& day : in.market.days_of(Split::kTest)) {
    for (const MarketStep& step : in.market.of(day)) {
      ++steps[static_cast<std::size_t>(context_class_of(in, step))];
    }
  }
  const auto most = std::max_element(steps.begin() + 1, steps.end()) - steps.begin();
  return lattice_context(kMiddleMinute, kNoonQuarterHour, static_cast<int>(most));
}

/// One row per interval of prices with the same action, at each SoC.
PictureFile map_file(const RunResults& in) {
  std::string csv =
      "student,context_class,quarter_hour,minute,soc_frac,price_from_eur_per_mwh,"
      "price_to_eur_per_mwh,action\n";
  const LatticeState context = first_map(in);
  const auto add = [&](const char* name, const StudentNet& net) {
    ActionGrid grid;
    fill_action_grid(net, context, false, grid);
    const auto prices = static_cast<int>(grid.size()) / kSocCount;
    for (int soc = 0; soc < kSocCount; ++soc) {
      const std::int8_t* row = &grid[static_cast<std::size_t>(soc) * prices];
      for (int from = 0, p = 1; p <= prices; ++p) {
        if (p < prices && row[p] == row[from]) continue;
        csv += fmt::format("{},{},{},{},{:.3f},{},{},{}\n", name, context.context_class,
                           context.quarter_hour, context.minute_of_quarter_hour,
                           static_cast<double>(soc) / (kSocCount - 1),
                           kLatticePriceMinEurPerMwh + from, kLatticePriceMinEurPerMwh + p - 1,
                           action_name(static_cast<Action>(row[from])));
        from = p;
      }
    }
  };
  add(own_student_name(in.corrected.certificate), in.corrected.net);
  add(kPlainName, in.plain->net);
  return {"policy_map.csv", std::move(csv)};
}

constexpr double kWattHoursPerMegawattHour = 1e6;
constexpr std::size_t kCounterexamplesShown = 200;

Json policies_json(const std::vector<NamedEvaluation>& evaluations) {
  Json list = Json::list();
  for (const NamedEvaluation& named : evaluations) {
    const std::vector<DayResult>& days = named.carried_over.days;
    if (days.empty() || is_under_rules(named.name)) continue;
    Json policy = Json::object({{"name", named.name}});
    const auto of_days = [&](const char* key, auto field) {
      policy.set(key, Json::list_from(days, field));
    };
    of_days("profit_eur", [](const DayResult& d) { return d.profit_eur; });
    of_days("throughput_mwh", [](const DayResult& d) { return d.throughput_mwh; });
    of_days("cycles", [](const DayResult& d) { return Decimals{d.cycles, 3}; });
    list.add(std::move(policy));
  }
  return list;
}

/// Day-reset accounting, as in the section on the profit gap.
std::vector<PolicySteps> all_steps(const RunResults& in, const std::vector<MarketDay>& days) {
  std::vector<PolicySteps> all;
  const auto add = [&](const std::string& name, Policy& policy) {
    all.push_back({name, {}});
    evaluate(in.market, days, policy, {in.battery, in.initial_soc_frac, false},
             &all.back().records);
  };
  StudentPolicy plain(in.plain->net, in.plain->outlook);
  TeacherPolicy teacher(in.teacher);
  add(own_student_name(in.corrected.certificate), *exported_policy(in.corrected));
  add(kPlainName, plain);
  add("teacher", teacher);
  return all;
}

std::vector<double> profits_by_day(const std::vector<MarketDay>& days, const PolicySteps& policy) {
  std::vector<double> profits;
  auto record = policy.records.begin();
  for (const MarketDay& day : days) {
    double profit_eur = 0;
    for (std::size_t s = 0; s < day.step_count; ++s) profit_eur += (record++)->profit_eur;
    profits.push_back(profit_eur);
  }
  return profits;
}

/// Profits minus those of perfect foresight, if evaluated: the ranking of days on the page.
std::vector<double> against_foresight(const RunResults& in, std::vector<double> profits) {
  const NamedEvaluation* bound = find_evaluation(in.evaluations, kForesightName);
  if (bound == nullptr || bound->day_reset.days.size() != profits.size()) {
    return profits;
  }
  for (std::size_t d = 0; d < profits.size(); ++d) {
    profits[d] -= bound->day_reset.days[d].profit_eur;
  }
  return profits;
}

template <int kInputs, int kOutputs>
Json layer_json(const Affine<kInputs, kOutputs>& layer) {
  Json weight = Json::list();
  for (const auto& row : layer.weight) {
    for (const std::int16_t w : row) weight.add(w);
  }
  return Json::object({{"weight", std::move(weight)}, {"bias", std::span(layer.bias)}});
}

/// Integers of a net.
Json student_json(const char* name, const StudentNet& net) {
  Json layer1 = layer_json(net.layer1);
  layer1.set("shift", net.relu1.shift);
  Json layer2 = layer_json(net.layer2);
  layer2.set("shift", net.relu2.shift);
  return Json::object({{"name", name},
                       {"net", Json::object({{"price_map", std::span(net.price_map)},
                                             {"layer1", std::move(layer1)},
                                             {"layer2", std::move(layer2)},
                                             {"layer3", layer_json(net.layer3)}})}});
}

/// Scales of the inputs of a net.
Json lattice_json() {
  return Json::object({{"minute_scale", kMinuteOfQuarterHourScale},
                       {"quarter_hour_scale", kQuarterHourScale},
                       {"context_scale", kContextClassScale},
                       {"soc_scale", kSocScale},
                       {"soc_count", kSocCount},
                       {"price_min", kLatticePriceMinEurPerMwh},
                       {"price_max", kLatticePriceMaxEurPerMwh}});
}

Json state_json(const LatticeState& s) {
  const std::int16_t state[] = {s.minute_of_quarter_hour, s.quarter_hour, s.context_class,
                                s.soc_index, s.price_eur_per_mwh};
  return std::span(state);
}

/// Student whose counterexamples are shown: the corrected one if it has any, else the plain one.
const Certificate& shown_as_wrong(const RunResults& in) {
  const Certificate& corrected = in.corrected.certificate;
  return corrected.counterexamples.empty() ? in.plain->certificate : corrected;
}

Json counterexamples_json(const RunResults& in) {
  Json list = Json::list();
  const auto& found = shown_as_wrong(in).counterexamples;
  const std::size_t stride = found.size() / kCounterexamplesShown + 1;
  for (std::size_t i = 0; i < found.size(); i += stride) list.add(state_json(found[i]));
  return list;
}

/// Profit of the paper's rule on the validation days, SoC carried over, as for the teacher.
double rule_validation_profit(const MarketSteps& market, const BatteryParameters& battery) {
  RuleBasedPolicy rule(kPaperRuleLowEurPerMwh, kPaperRuleHighEurPerMwh);
  const EvaluationOptions options{.battery = battery, .carry_soc = true};
  return evaluate(market, market.days_of(Split::kValidation), rule, options)
      .profit_eur_per_day_per_mwh();
}

Json learning_json(const RunResults& in) {
  const auto training = [&](const CurvePoint& p) {
    const bool is_kept = &p == &kept_point(in.training_curve);
    return Json::list_of(static_cast<double>(p.step), p.validation_eur_per_day_per_mwh,
                         is_kept ? 1.0 : 0.0, p.loss);
  };
  const auto distil = [](const DistilPoint& p) {
    return Json::list_of(static_cast<double>(p.epoch), p.teacher_loss, p.correction_loss,
                         p.visited_loss);
  };
  const auto checkpoint = [](const StudentCheckpoint& c) {
    return Json::list_of(c.epoch, c.validation_eur_per_day_per_mwh, checkpoint_state_name(c.state));
  };
  const bool by_construction =
      !in.distil_curve.empty() &&
      std::ranges::all_of(in.distil_curve, &DistilPoint::is_by_construction);
  return Json::object({{"by_construction", by_construction},
                       {"checkpoints", Json::list_from(in.checkpoints, checkpoint)},
                       {"training", Json::list_from(in.training_curve, training)},
                       {"rule", rule_validation_profit(in.market, in.battery)},
                       {"distil", Json::list_from(in.distil_curve, distil)}});
}

Json prices_json(const MarketSteps& market) {
  const PriceHistogram histogram = price_histogram(market);
  return Json::object({{"low", histogram.low},
                       {"bin", kPriceBinEurPerMwh},
                       {"train", Json::list_from(histogram.percent_by_bin(histogram.train))},
                       {"test", Json::list_from(histogram.percent_by_bin(histogram.test))},
                       {"outside_train", histogram.percent_outside(histogram.train)},
                       {"outside_test", histogram.percent_outside(histogram.test)}});
}

Json battery_json(const BatteryParameters& battery) {
  return Json::object({{"capacity_mwh", battery.capacity_wh / kWattHoursPerMegawattHour},
                       {"power_w", battery.power_w_max},
                       {"soc_min", battery.soc_min_frac},
                       {"soc_max", battery.soc_max_frac},
                       {"wear_eur_per_mwh", battery.wear_eur_per_mwh}});
}

static_assert(std::endian::native == std::endian::little, "the page's arrays are little-endian");

constexpr double kMilliPerEur = 1000;
constexpr int kSecondsPerMinute = 60;
/// Larger prices are refused when steps are made.
static_assert(1'000'000 * kMilliPerEur < std::numeric_limits<std::int32_t>::max());

/// One array: `value` of each item.
template <typename Number, typename Items, typename Value>
void append(std::string& bytes, const Items& items, Value value) {
  for (const auto& item : items) {
    const auto number = static_cast<Number>(std::invoke(value, item));
    bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
  }
}

std::int32_t milli_of(double eur_per_mwh) {
  return static_cast<std::int32_t>(std::lround(eur_per_mwh * kMilliPerEur));
}

void append_market(std::span<const MarketStep> steps, const ClassOfStep& class_of,
                   std::string& bytes) {
  using Step = const MarketStep&;
  append<std::int32_t>(bytes, steps, [](Step s) { return s.utc_s / kSecondsPerMinute; });
  append<std::int32_t>(bytes, steps, [](Step s) { return price_centi_of(s.observed_eur_per_mwh); });
  append<std::int32_t>(bytes, steps, [](Step s) { return milli_of(s.paid_eur_per_mwh); });
  append<std::int16_t>(bytes, steps, [](Step s) {
    return s.quarter_hour * kMinutesPerQuarterHour + s.minute_of_quarter_hour;
  });
  append<std::int8_t>(bytes, steps, class_of);
}

void append_policy(std::span<const StepRecord> records, std::string& bytes) {
  using Record = const StepRecord&;
  append<float>(bytes, records, &StepRecord::profit_eur);
  append<float>(bytes, records, &StepRecord::power_w);
  append<std::int16_t>(bytes, records,
                       [](Record r) { return std::lround(r.soc_frac * kSocFullE4); });
  append<std::int8_t>(bytes, records, &StepRecord::action);
}

std::string deflated(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string packed(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(),
                Z_BEST_COMPRESSION) != Z_OK) {
    throw std::runtime_error("zlib could not compress the steps of the days");
  }
  packed.resize(size);
  return packed;
}

}  // namespace

std::vector<PictureFile> page_pictures(const RunResults& in, const PageSteps& steps) {
  return {step_file(in, steps), map_file(in), histogram_file(price_histogram(in.market))};
}

std::string teacher_name(const Teacher& teacher) {
  return fmt::format("{} teacher", method_name(teacher.method));
}

const char* own_student_name(const Certificate& certificate) {
  return certificate.violations() == 0 ? kCorrectedName : kUnprovedName;
}

std::vector<std::size_t> days_with_steps(const std::vector<double>& profit_eur, std::size_t most) {
  std::vector<std::size_t> order(profit_eur.size());
  std::iota(order.begin(), order.end(), 0);
  if (order.size() <= most) return order;
  std::ranges::stable_sort(order, {}, [&](std::size_t day) { return profit_eur[day]; });
  const auto newest = order.begin() + static_cast<long>(std::min(kWorstDaysKept, most));
  std::sort(newest, order.end(), std::greater<>());
  order.resize(most);
  std::ranges::sort(order);
  return order;
}

PageSteps page_steps(const RunResults& in) {
  PageSteps steps{in.market.days_of(Split::kTest), {}, {}};
  steps.policies = all_steps(in, steps.days);
  steps.kept = days_with_steps(
      against_foresight(in, profits_by_day(steps.days, steps.policies.front())), kDaysWithSteps);
  return steps;
}

Json page_data(const RunResults& in, const PageSteps& steps) {
  const std::vector<MarketDay>& days = steps.days;
  const Certificate& certificate = in.corrected.certificate;
  const ContextClasses& classes = in.corrected.net.context;
  const char* const own_name = own_student_name(certificate);
  std::vector<std::string> dates;
  for (const MarketDay& day : days) dates.push_back(day.date());
  Json data = Json::object({{"exported", own_name}, {"foresight", kForesightName}});
  data.set("battery", battery_json(in.battery));
  data.set("dates", Json::list_from(dates));
  data.set("marks", regime_marks(dates));
  data.set("policies", policies_json(in.evaluations));
  // Name and colour of each baseline drawn with the exported policy.
  data.set("rivals", Json::list_from(rival_names(), [](const std::string& name) {
             return Json::object({{"name", name}, {"colour", find_baseline(name)->colour}});
           }));
  Json archive = step_archive(in.market, days, steps.policies, steps.kept,
                              [&](const MarketStep& step) { return context_class_of(in, step); });
  archive.set("days_left_out", days.size() - steps.kept.size());
  data.set("archive", std::move(archive));
  data.set("lattice", lattice_json());
  Json contexts = Json::list();
  for (int c = 1; c <= kContextClassCount; ++c) contexts.add(context_text(classes, c));
  data.set("contexts", std::move(contexts));
  data.set("thresholds", Json::object({{"low", certificate.thresholds.low_eur_per_mwh},
                                       {"high", certificate.thresholds.high_eur_per_mwh}}));
  data.set("students", Json::list_of(student_json(own_name, in.corrected.net),
                                     student_json(kPlainName, in.plain->net)));
  data.set("counterexamples", counterexamples_json(in));
  data.set("counterexamples_of", &shown_as_wrong(in) == &certificate ? own_name : kPlainName);
  // State of each broken demand (null if unknown), for the buttons of failure_html().
  data.set("broken", Json::list_from(in.broken, [](const BrokenDemand& demand) {
             return demand.state ? state_json(*demand.state) : Json(NAN);
           }));
  data.set("rules", rules_json(certificate.rules, classes.kind));
  const LatticeState map = first_map(in);
  data.set("first_map", Json::object({{"context_class", map.context_class},
                                      {"quarter_hour", map.quarter_hour},
                                      {"minute", map.minute_of_quarter_hour}}));
  data.set("learning", learning_json(in));
  data.set("prices", prices_json(in.market));
  return data;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t b = 0; b < 3; ++b) {
      group = group << 8 | (b < count ? static_cast<std::uint8_t>(bytes[i + b]) : 0u);
    }
    for (std::size_t d = 0; d < 4; ++d) {
      text += d <= count ? kDigits[group >> (18 - 6 * d) & 63] : '=';
    }
  }
  return text;
}

Json step_archive(const MarketSteps& market, const std::vector<MarketDay>& days,
                  const std::vector<PolicySteps>& policies, const std::vector<std::size_t>& kept,
                  const ClassOfStep& class_of) {
  std::vector<std::size_t> first_record{0};  // by day
  for (const MarketDay& day : days) first_record.push_back(first_record.back() + day.step_count);
  std::string bytes;
  Json index = Json::list();
  for (const std::size_t d : kept) {
    const MarketDay& day = days[d];
    append_market(market.of(day), class_of, bytes);
    for (const PolicySteps& policy : policies) {
      append_policy({policy.records.data() + first_record[d], day.step_count}, bytes);
    }
    index.add(Json::object({{"date", day.date()}, {"steps", day.step_count}}));
  }
  return Json::object({{"policies", Json::list_from(policies, &PolicySteps::name)},
                       {"days", std::move(index)},
                       {"data", base64(deflated(bytes))}});
}

}  // namespace bess
