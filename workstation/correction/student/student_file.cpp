#include "workstation/correction/student/student_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <numeric>
#include <span>
#include <vector>

#include "shared/host/file.h"
#include "shared/host/json_reader.h"
#include "shared/host/user_error.h"
#include "shared/nn/exported_student.h"
#include "shared/outlook/exported_outlook.h"
#include "shared/utc_text.h"
#include "workstation/correction/distillation/distil.h"

namespace bess {

namespace {

constexpr int kInputBits = 14;  // inputs are Q14
static_assert(kInputOne == 1 << kInputBits);
/// Accumulators keep one bit of headroom for the rounding constant and the bias.
constexpr double kAccumulatorMax = 1 << 30;

/// Bounds of a layer's activations over all inputs, by interval arithmetic in float.
struct Range {
  Eigen::VectorXd low, high;
};

Range affine_range(const Eigen::MatrixXd& w, const Eigen::VectorXd& b, const Range& x) {
  const Eigen::MatrixXd positive = w.cwiseMax(0.0);
  const Eigen::MatrixXd negative = w.cwiseMin(0.0);
  return {positive * x.low + negative * x.high + b, positive * x.high + negative * x.low + b};
}

Range relu_range(const Range& x, double saturation) {
  return {x.low.cwiseMax(0.0).cwiseMin(saturation), x.high.cwiseMax(0.0).cwiseMin(saturation)};
}

/// Largest f with max|w| * 2^f inside int16 and every accumulator at scale 2^(f + input_bits)
/// inside int32 headroom.
int weight_bits(const Eigen::MatrixXd& w, const Eigen::VectorXd& b, const Range& x,
                int input_bits) {
  const double accumulator =
      (w.cwiseAbs() * x.high.cwiseAbs().cwiseMax(x.low.cwiseAbs()) + b.cwiseAbs()).maxCoeff();
  for (int f = 15; f >= 0; --f) {
    const double scale = std::ldexp(1.0, f);
    const bool weights_fit = w.cwiseAbs().maxCoeff() * scale < INT16_MAX - 1;
    if (weights_fit && accumulator * std::ldexp(scale, input_bits) < kAccumulatorMax) return f;
  }
  fail("the student's weights are too large for int16; distil again with a smaller learning rate");
}

/// Largest scale at which the activation's upper bound stays inside int16; for saturating
/// activations, the scale at which the saturation equals the int16 limit.
int activation_bits(const Range& x, double saturation) {
  constexpr int kInt16Bits = 15;
  if (std::isfinite(saturation)) return kInt16Bits - static_cast<int>(std::log2(saturation));
  const double highest = std::max(x.high.maxCoeff(), 1e-6);
  if (highest > INT16_MAX) {
    fail(
        "the student's activations are too large for int16; distil again with a smaller learning "
        "rate");
  }
  return std::clamp(static_cast<int>(std::floor(std::log2(INT16_MAX / highest))), 0, 20);
}

template <int kInputs, int kOutputs>
void quantise_layer(const Eigen::MatrixXd& w, const Eigen::VectorXd& b, int bits, int input_bits,
                    Affine<kInputs, kOutputs>& layer) {
  for (int i = 0; i < kInputs; ++i) {
    for (int o = 0; o < kOutputs; ++o) {
      layer.weight[i][o] = static_cast<std::int16_t>(std::lround(std::ldexp(w(o, i), bits)));
    }
  }
  for (int o = 0; o < kOutputs; ++o) {
    layer.bias[o] = static_cast<std::int32_t>(std::lround(std::ldexp(b[o], bits + input_bits)));
  }
}

/// Largest magnitude of the layer's sums, given the largest value of each (non-negative) input.
template <int kInputs, int kOutputs>
std::int64_t sum_bound(const Affine<kInputs, kOutputs>& layer,
                       const std::vector<std::int64_t>& input_max) {
  std::int64_t bound = 0;
  for (int o = 0; o < kOutputs; ++o) {
    std::int64_t sum = std::abs(std::int64_t{layer.bias[o]});
    for (int i = 0; i < kInputs; ++i) sum += std::abs(layer.weight[i][o] * input_max[i]);
    bound = std::max(bound, sum);
  }
  return bound;
}

/// Largest value of each activation after the layer, exact in integers.
template <int kInputs, int kOutputs>
std::vector<std::int64_t> activation_bound(const Affine<kInputs, kOutputs>& layer, int shift,
                                           const std::vector<std::int64_t>& input_max) {
  std::vector<std::int64_t> bound(kOutputs);
  for (int o = 0; o < kOutputs; ++o) {
    std::int64_t sum = layer.bias[o];
    for (int i = 0; i < kInputs; ++i) {
      sum += std::max<std::int64_t>(0, layer.weight[i][o]) * input_max[i];
    }
    bound[o] = std::clamp<std::int64_t>((sum >> shift) + 1, 0, INT16_MAX);
  }
  return bound;
}

constexpr const char* kFormat = "bess-student";
constexpr int kFormatVersion = 5;
constexpr int kVersionWithoutOutlook = 4;  ///< still written for other contexts
constexpr int kVersionWithoutRules = 3;    ///< still written without rules
constexpr int kVersionWithoutCounts = 1;   ///< thresholds next to the weights
constexpr int kVersionWithoutContext = 2;  ///< context: month

/// Visits every named array of the net; the one list for reading and writing.
template <typename Net, typename Visit>
void visit_arrays(Net& net, Visit visit) {
  visit("price_map", std::span(net.price_map));
  visit("layer1_weight", std::span(&net.layer1.weight[0][0], kStudentInputs * kStudentHidden1));
  visit("layer1_bias", std::span(net.layer1.bias));
  visit("relu1_shift", std::span(&net.relu1.shift, 1));
  visit("layer2_weight", std::span(&net.layer2.weight[0][0], kStudentHidden1 * kStudentHidden2));
  visit("layer2_bias", std::span(net.layer2.bias));
  visit("relu2_shift", std::span(&net.relu2.shift, 1));
  visit("layer3_weight", std::span(&net.layer3.weight[0][0], kStudentHidden2 * kActionCount));
  visit("layer3_bias", std::span(net.layer3.bias));
}

PriceThresholds parse_thresholds(const JsonReader& in, const std::string& name) {
  const auto price = [&in](const char* key) {
    return static_cast<int>(in.whole(key, -kThresholdMaxEurPerMwh, kThresholdMaxEurPerMwh));
  };
  const PriceThresholds thresholds{price("low_price_eur_per_mwh"), price("high_price_eur_per_mwh")};
  if (!thresholds.are_ordered()) {
    fail("{}: \"low_price_eur_per_mwh\" is not below \"high_price_eur_per_mwh\"", name);
  }
  return thresholds;
}

constexpr std::int64_t kExactInDouble = std::int64_t{1} << 53;

std::string violations_key(int property) { return fmt::format("violations_property_{}", property); }

Certificate parse_certificate(const JsonReader& in, const std::string& name) {
  const auto count = [&in](const char* key) { return in.whole(key, 0, kExactInDouble); };
  Certificate certificate{.thresholds = parse_thresholds(in, name),
                          .states_checked = count("states_checked"),
                          .states_evaluated = count("states_evaluated")};
  for (int property = 1; property <= kPropertyCount; ++property) {
    certificate.set_violations_of(property, count(violations_key(property).c_str()));
  }
  return certificate;
}

ContextClasses parse_context_classes(const JsonReader& in, const std::string& name) {
  ContextClasses classes;
  const std::string written = in.text("context");
  const auto* const kind = std::ranges::find(kContextKinds, written, context_name);
  if (kind == std::end(kContextKinds)) {
    fail("{}: \"context\" is neither \"level\" nor \"month\" nor \"outlook\"", name);
  }
  classes.kind = *kind;
  in.wholes("level_edge_eur_per_mwh", std::span(classes.level_edge_eur_per_mwh));
  if (!classes.is_valid()) {
    fail("{}: \"level_edge_eur_per_mwh\" must rise strictly (level, outlook) or be 0 (month)",
         name);
  }
  return classes;
}

std::vector<std::int64_t> parse_counts(const JsonValue& file, const char* key, std::size_t count,
                                       const std::string& name) {
  std::vector<std::int64_t> counts;
  for (const JsonValue item : file[key]) {
    const double number = item.number().value_or(-1);
    if (!(number >= 0 && number <= static_cast<double>(kExactInDouble))) break;
    counts.push_back(static_cast<std::int64_t>(number));
  }
  if (counts.size() != count || file[key].size() != count) {
    fail("{}: \"{}\" is not an array of {} counts", name, key, count);
  }
  return counts;
}

/// The rules as the text of a rule file, and their counts. Older files have only the sum: if it is
/// 0, so is each count; otherwise the counts are unknown.
void parse_rule_claims(const JsonValue& file, const JsonReader& in, const std::string& name,
                       ContextKind kind, Certificate& certificate) {
  certificate.rules = parse_rules(in.text("rules"), name + ": rules");
  const std::int64_t sum = in.whole("violations_of_rules", 0, kExactInDouble);
  const bool has_counts = file["rule_violations"].exists();
  if (!has_counts && sum > 0) return;
  const std::size_t rules = certificate.rules.rules.size();
  const std::vector<std::int64_t> none(rules);
  const auto states = has_counts ? parse_counts(file, "rule_states", rules, name) : none;
  const auto violations = has_counts ? parse_counts(file, "rule_violations", rules, name) : none;
  for (std::size_t r = 0; r < rules; ++r) {
    certificate.counts.push_back(
        {binds_student(certificate.rules.rules[r], kind), states[r], violations[r]});
  }
}

void add_rule_claims(const Certificate& certificate, Json& json) {
  std::vector<std::int64_t> states;
  std::vector<std::int64_t> violations;
  for (const RuleCount& count : certificate.rule_counts()) {
    states.push_back(count.states);
    violations.push_back(count.violations);
  }
  json.set("rules", format_rules(certificate.rules));
  json.set("violations_of_rules", std::accumulate(violations.begin(), violations.end(), 0LL));
  if (violations.empty()) return;  // not checked
  json.set("rule_states", std::span<const std::int64_t>(states));
  json.set("rule_violations", std::span<const std::int64_t>(violations));
}

Json outlook_json(const OutlookModel& model) {
  Json json = Json::object({{"hash", model.hash()}});
  OutlookModel::visit(model, [&json](const char* key, const std::int32_t* values, int count) {
    json.set(key, std::span(values, static_cast<std::size_t>(count)));
  });
  return json;
}

std::shared_ptr<const PlanCache> parse_outlook(const JsonReader& in, const std::string& name) {
  OutlookModel model;
  OutlookModel::visit(model, [&in](const char* key, std::int32_t* values, int count) {
    in.wholes(key, std::span(values, static_cast<std::size_t>(count)));
  });
  if (in.number("hash") != model.hash() || !model.is_sound()) {
    fail(
        "{}: damaged: \"outlook\" does not match its hash, or has impossible values; copy it "
        "again or distil again",
        name);
  }
  return PlanCache::of(model);
}

Entries parse_learnt_for(const JsonValue& object, const std::string& name) {
  Entries learnt_for;
  for (const JsonValue member : object) {
    if (member.text() == nullptr) fail("{}: \"learnt_for\" must contain only texts", name);
    learnt_for.emplace_back(member.key(), member.text());
  }
  return learnt_for;
}

Json certificate_json(const Certificate& c) {
  Json json = Json::object({{"low_price_eur_per_mwh", c.thresholds.low_eur_per_mwh},
                            {"high_price_eur_per_mwh", c.thresholds.high_eur_per_mwh},
                            {"states_checked", c.states_checked},
                            {"states_evaluated", c.states_evaluated}});
  add_property_violations(c, json);
  return json;
}

}  // namespace

StudentNet quantise_student(const Parameters& student, const PriceMap& price_map,
                            double saturation) {
  const ConstMlp mlp(kStudentShape, student.data());
  const Eigen::MatrixXd w1 = mlp.w1.cast<double>();
  const Eigen::MatrixXd w2 = mlp.w2.cast<double>();
  const Eigen::MatrixXd w3 = mlp.w3.cast<double>();
  const Eigen::VectorXd b1 = mlp.b1.cast<double>();
  const Eigen::VectorXd b2 = mlp.b2.cast<double>();
  const Eigen::VectorXd b3 = mlp.b3.cast<double>();
  const Range input{Eigen::VectorXd::Zero(kStudentInputs), Eigen::VectorXd::Ones(kStudentInputs)};
  const Range hidden1 = relu_range(affine_range(w1, b1, input), saturation);
  const Range hidden2 = relu_range(affine_range(w2, b2, hidden1), saturation);

  StudentNet net{};
  std::ranges::copy(price_map.table(), net.price_map);
  const int bits1 = weight_bits(w1, b1, input, kInputBits);
  const int hidden1_bits = std::min(activation_bits(hidden1, saturation), bits1 + kInputBits);
  quantise_layer(w1, b1, bits1, kInputBits, net.layer1);
  net.relu1.shift = bits1 + kInputBits - hidden1_bits;
  const int bits2 = weight_bits(w2, b2, hidden1, hidden1_bits);
  const int hidden2_bits = std::min(activation_bits(hidden2, saturation), bits2 + hidden1_bits);
  quantise_layer(w2, b2, bits2, hidden1_bits, net.layer2);
  net.relu2.shift = bits2 + hidden1_bits - hidden2_bits;
  const int bits3 = weight_bits(w3, b3, hidden2, hidden2_bits);
  quantise_layer(w3, b3, bits3, hidden2_bits, net.layer3);
  return net;
}

std::int64_t accumulator_bound(const StudentNet& net) {
  const std::vector<std::int64_t> input(kStudentInputs, kInputOne);
  const auto hidden1 = activation_bound(net.layer1, net.relu1.shift, input);
  const auto hidden2 = activation_bound(net.layer2, net.relu2.shift, hidden1);
  const auto rounding = [](int shift) { return shift > 0 ? std::int64_t{1} << (shift - 1) : 0; };
  return std::max({sum_bound(net.layer1, input) + rounding(net.relu1.shift),
                   sum_bound(net.layer2, hidden1) + rounding(net.relu2.shift),
                   sum_bound(net.layer3, hidden2)});
}

void add_property_violations(const Certificate& certificate, Json& json) {
  for (int property = 1; property <= kPropertyCount; ++property) {
    json.set(violations_key(property).c_str(), certificate.violations_of(property));
  }
}

void check_net(const StudentNet& net, const std::string& name) {
  constexpr int kShiftMax = 30;
  for (const int shift : {net.relu1.shift, net.relu2.shift}) {
    if (shift < 0 || shift > kShiftMax)
      fail("{}: shift {} is not in 0..{}", name, shift, kShiftMax);
  }
  for (int i = 0; i < kPriceCount; ++i) {
    if (net.price_map[i] < 0 || net.price_map[i] > kInputOne ||
        (i > 0 && net.price_map[i] <= net.price_map[i - 1])) {
      fail("{}: price map does not rise strictly within 0..{} at {} EUR/MWh", name, kInputOne,
           i + kLatticePriceMinEurPerMwh);
    }
  }
  if (accumulator_bound(net) > INT32_MAX) {
    fail("{}: weights so large that a 32-bit accumulator could overflow", name);
  }
}

std::optional<UtcSpan> learnt_span(const Entries& learnt_for) {
  const std::string prices = value_in(learnt_for, "prices");  // empty: no match
  std::int64_t minutes = 0;
  char from[32] = {};
  std::int64_t from_utc_s = 0;
  if (std::sscanf(prices.c_str(), "crc32 %*8x, %" SCNd64 " minutes from %31s", &minutes, from) !=
          2 ||
      !parse_utc(from, from_utc_s)) {
    return {};
  }
  return UtcSpan{from_utc_s, from_utc_s + 60 * minutes};
}

void save_student(const std::filesystem::path& path, const StudentFile& student) {
  check_net(student.net, path.string());
  const bool has_rules = !student.certificate.rules.empty();
  Json json = Json::object({{"format", kFormat},
                            {"version", student.outlook ? kFormatVersion
                                        : has_rules     ? kVersionWithoutOutlook
                                                        : kVersionWithoutRules},
                            {"architecture_hash", student_architecture_hash()},
                            {"weights_hash", student_weights_hash(student.net)},
                            {"provenance", student.provenance},
                            {"certificate", certificate_json(student.certificate)},
                            {"context", context_name(student.net.context.kind)}});
  if (!student.learnt_for.empty()) json.set("learnt_for", json_of(student.learnt_for));
  if (student.cycles_per_day) json.set("cycles_per_day", Decimals{*student.cycles_per_day, 2});
  if (has_rules) add_rule_claims(student.certificate, json);
  json.set("level_edge_eur_per_mwh", std::span(student.net.context.level_edge_eur_per_mwh));
  visit_arrays(student.net, [&json](const char* key, auto values) { json.set(key, values); });
  if (student.outlook) json.set("outlook", outlook_json(student.outlook->model()));
  write_file(path, json.text());
}

StudentFile load_student(const std::filesystem::path& path) {
  return parse_student(read_file(path), path.string());
}

StudentFile parse_student(const std::string& text, const std::string& name) {
  const Json json = Json::parse(text);
  if (!json.value().is_object()) {
    fail("{}: not a student file (JSON); make one with 'bess-train distil'", name);
  }
  const JsonReader in(json.value(), name, "a student file");
  if (in.text("format") != kFormat) fail("{}: \"format\" is not \"{}\"", name, kFormat);
  const double version = in.number("version");
  if (version != kFormatVersion && version != kVersionWithoutOutlook &&
      version != kVersionWithoutRules && version != kVersionWithoutContext &&
      version != kVersionWithoutCounts) {
    fail("{}: version {}, this program reads {} to {}; distil again", name, version,
         kVersionWithoutCounts, kFormatVersion);
  }
  if (in.number("architecture_hash") != student_architecture_hash()) {
    fail("{}: made for another student architecture; distil again", name);
  }
  StudentFile student{};
  visit_arrays(student.net, [&in](const char* key, auto values) { in.wholes(key, values); });
  if (version >= kVersionWithoutRules) student.net.context = parse_context_classes(in, name);
  check_net(student.net, name);
  if (in.number("weights_hash") != student_weights_hash(student.net)) {
    fail("{}: damaged: the weights do not match their hash; copy it again or distil again", name);
  }
  if (version == kVersionWithoutCounts) {
    student.certificate.thresholds = parse_thresholds(in, name);
  } else {
    student.certificate = parse_certificate(in.object("certificate"), name);
  }
  if (version >= kVersionWithoutOutlook) {
    parse_rule_claims(json.value(), in, name, student.net.context.kind, student.certificate);
  }
  if (student.net.context.is_outlook()) student.outlook = parse_outlook(in.object("outlook"), name);
  student.provenance = in.text("provenance");
  student.learnt_for = parse_learnt_for(json.value()["learnt_for"], name);
  student.cycles_per_day = json.value()["cycles_per_day"].number();
  if (student.cycles_per_day.value_or(0) < 0 || student.cycles_per_day.value_or(0) > 1000) {
    fail("{}: \"cycles_per_day\" is not in 0..1000", name);
  }
  return student;
}

StudentFile compiled_student() {
  StudentFile student{};
  student.net = kExportedStudent;  // as an initialiser, g++ 12 compiles it for 17 s
  student.certificate = {.thresholds = kExportedThresholds,
                         .states_checked = BESS_STUDENT_STATES_CHECKED,
                         .states_evaluated = BESS_STUDENT_STATES_EVALUATED};
  student.provenance = BESS_STUDENT_PROVENANCE;
  if (const OutlookModel* const outlook = exported_outlook()) {
    student.outlook = PlanCache::of(*outlook);
  }
#ifdef BESS_STUDENT_RULES
  student.certificate.rules = parse_rules(BESS_STUDENT_RULES, "compiled rules");
#endif
  for (const Rule& rule : student.certificate.demands().rules) {
    student.certificate.counts.push_back({binds_student(rule, student.net.context.kind)});
  }
  return student;
}

}  // namespace bess
