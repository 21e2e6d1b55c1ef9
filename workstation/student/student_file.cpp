#include "workstation/student/student_file.h"

#include <cJSON.h>
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <cmath>
#include <memory>
#include <span>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "shared/nn/exported_student.h"
#include "workstation/student/quantise.h"

namespace bess {
namespace {

constexpr int kFormatVersion = 2;
constexpr int kVersionWithoutCounts = 1;  ///< it had the thresholds beside the weights
using Json = std::unique_ptr<cJSON, decltype(&cJSON_Delete)>;

/// One named array of the net. All arrays are listed once, for reading and for writing.
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

/// Reads fields of one JSON object; every complaint names the file and the key.
class FieldReader {
 public:
  FieldReader(const cJSON* object, const std::string& name) : object_(object), name_(name) {}

  [[nodiscard]] double number(const char* key) const {
    const cJSON* item = field(key);
    if (!cJSON_IsNumber(item)) fail("{}: \"{}\" is not a number", name_, key);
    return item->valuedouble;
  }
  /// A threshold: whole EUR/MWh, as plausible as any price.
  [[nodiscard]] int price(const char* key) const {
    return static_cast<int>(whole(key, -kThresholdMaxEurPerMwh, kThresholdMaxEurPerMwh));
  }
  [[nodiscard]] std::int64_t count(const char* key) const {
    constexpr std::int64_t kExactInDouble = std::int64_t{1} << 53;
    return whole(key, 0, kExactInDouble);
  }
  [[nodiscard]] FieldReader object(const char* key) const {
    const cJSON* item = field(key);
    if (!cJSON_IsObject(item)) fail("{}: \"{}\" is not an object", name_, key);
    return {item, name_};
  }
  [[nodiscard]] std::string text(const char* key) const {
    const cJSON* item = field(key);
    if (!cJSON_IsString(item)) fail("{}: \"{}\" is not a text", name_, key);
    return item->valuestring;
  }
  template <typename T, std::size_t kExtent>
  void integers(const char* key, std::span<T, kExtent> out) const {
    const cJSON* array = field(key);
    if (!cJSON_IsArray(array) || cJSON_GetArraySize(array) != static_cast<int>(out.size())) {
      fail("{}: \"{}\" is not an array of {} integers", name_, key, out.size());
    }
    const cJSON* item = array->child;
    for (T& value : out) {
      const double x = cJSON_IsNumber(item) ? item->valuedouble : 0.5;
      value = static_cast<T>(
          clamp_to<double>(x, std::numeric_limits<T>::min(), std::numeric_limits<T>::max()));
      if (static_cast<double>(value) != x) {
        fail("{}: \"{}\" holds something else than integers of {} bits", name_, key, 8 * sizeof(T));
      }
      item = item->next;
    }
  }

 private:
  [[nodiscard]] std::int64_t whole(const char* key, std::int64_t min, std::int64_t max) const {
    const double value = number(key);
    const bool inside = value >= static_cast<double>(min) && value <= static_cast<double>(max);
    if (!inside || value != std::trunc(value)) {
      fail("{}: \"{}\" is not a whole number in {}..{}", name_, key, min, max);
    }
    return static_cast<std::int64_t>(value);
  }
  [[nodiscard]] const cJSON* field(const char* key) const {
    const cJSON* item = cJSON_GetObjectItemCaseSensitive(object_, key);
    if (item == nullptr) fail("{}: not a student file: \"{}\" is missing", name_, key);
    return item;
  }
  const cJSON* object_;
  const std::string& name_;
};

PriceThresholds parse_thresholds(const FieldReader& in, const std::string& name) {
  const PriceThresholds thresholds{in.price("low_price_eur_per_mwh"),
                                   in.price("high_price_eur_per_mwh")};
  if (!thresholds.are_ordered()) {
    fail("{}: \"low_price_eur_per_mwh\" is not below \"high_price_eur_per_mwh\"", name);
  }
  return thresholds;
}

Certificate parse_certificate(const FieldReader& in, const std::string& name) {
  return {.thresholds = parse_thresholds(in, name),
          .states_checked = in.count("states_checked"),
          .states_evaluated = in.count("states_evaluated"),
          .violations_property_1 = in.count("violations_property_1"),
          .violations_property_2 = in.count("violations_property_2"),
          .violations_property_3 = in.count("violations_property_3")};
}

std::string certificate_text(const Certificate& c) {
  return fmt::format(
      "{{\n\"low_price_eur_per_mwh\": {},\n\"high_price_eur_per_mwh\": {},\n"
      "\"states_checked\": {},\n\"states_evaluated\": {},\n\"violations_property_1\": {},\n"
      "\"violations_property_2\": {},\n\"violations_property_3\": {}\n}}",
      c.thresholds.low_eur_per_mwh, c.thresholds.high_eur_per_mwh, c.states_checked,
      c.states_evaluated, c.violations_property_1, c.violations_property_2,
      c.violations_property_3);
}

}  // namespace

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

void save_student(const std::filesystem::path& path, const StudentFile& student) {
  check_net(student.net, path.string());
  Json provenance(cJSON_CreateString(student.provenance.c_str()), cJSON_Delete);
  const std::unique_ptr<char, decltype(&cJSON_free)> quoted(
      cJSON_PrintUnformatted(provenance.get()), cJSON_free);
  std::string text = fmt::format(
      "{{\n\"format\": \"bess-student\",\n\"version\": {},\n\"architecture_hash\": {},\n"
      "\"weights_hash\": {},\n\"provenance\": {},\n\"certificate\": {}",
      kFormatVersion, student_architecture_hash(), student_weights_hash(student.net), quoted.get(),
      certificate_text(student.certificate));
  visit_arrays(student.net, [&text](const char* key, auto values) {
    text += fmt::format(",\n\"{}\": [{}]", key, fmt::join(values, ","));
  });
  write_file(path, text + "\n}\n");
}

StudentFile load_student(const std::filesystem::path& path) {
  return parse_student(read_file(path), path.string());
}

StudentFile parse_student(const std::string& text, const std::string& name) {
  const char* end = nullptr;
  const Json json(cJSON_ParseWithLengthOpts(text.data(), text.size(), &end, 0), cJSON_Delete);
  const bool whole = json != nullptr &&
                     std::string_view(end).find_first_not_of(" \t\r\n") == std::string_view::npos;
  if (!whole || !cJSON_IsObject(json.get())) {
    fail("{}: not a student file (JSON); make one with 'bess-train distil'", name);
  }
  const FieldReader in(json.get(), name);
  if (in.text("format") != "bess-student") fail("{}: \"format\" is not \"bess-student\"", name);
  const double version = in.number("version");
  if (version != kFormatVersion && version != kVersionWithoutCounts) {
    fail("{}: version {}, this program reads {} and {}; distil again", name, version,
         kVersionWithoutCounts, kFormatVersion);
  }
  if (in.number("architecture_hash") != student_architecture_hash()) {
    fail("{}: made for another student architecture; distil again", name);
  }
  StudentFile student{};
  visit_arrays(student.net, [&in](const char* key, auto values) { in.integers(key, values); });
  check_net(student.net, name);
  if (in.number("weights_hash") != student_weights_hash(student.net)) {
    fail("{}: damaged: the weights do not match their hash; copy it again or distil again", name);
  }
  if (version == kVersionWithoutCounts) {
    student.certificate.thresholds = parse_thresholds(in, name);
  } else {
    student.certificate = parse_certificate(in.object("certificate"), name);
  }
  student.provenance = in.text("provenance");
  return student;
}

StudentFile compiled_student() {
  return {kExportedStudent,
          {.thresholds = kExportedThresholds,
           .states_checked = BESS_STUDENT_STATES_CHECKED,
           .states_evaluated = BESS_STUDENT_STATES_EVALUATED},
          BESS_STUDENT_PROVENANCE};
}

}  // namespace bess
