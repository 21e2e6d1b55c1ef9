#include "workstation/policy/rl/teacher.h"

#include <cmath>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "workstation/base/binary_file.h"
#include "workstation/data/env/context_fit.h"

namespace bess {
namespace {

constexpr std::string_view kMagic = "BESSTCHR";
constexpr std::uint32_t kVersion = 4;
constexpr std::uint32_t kVersionWithoutNetworkOnOutlook = 3;  ///< still written for all others
constexpr std::uint32_t kVersionWithoutLearntFor = 2;
constexpr std::uint32_t kLearntForMax = 1000;
constexpr int kTeacherHidden1 = 256;
constexpr int kTeacherHidden2 = 128;
constexpr std::size_t kProvenanceMax = 4096;
constexpr int kAtomsMax = 10'000;
constexpr float kResidualQuantum = 1e-6F;  ///< of network_values(), relative to the support
/// In the file with the method number: a program follows the parameters.
constexpr std::uint32_t kResidualFlag = 0x100;
/// Additional inputs of teachers until November 2026.
constexpr std::uint32_t kOwnInputsMask = 0x1F000;

bool is_possible(const Support& support) {
  return std::isfinite(support.v_min) && std::isfinite(support.v_max) &&
         support.v_min < support.v_max && support.count >= 2 && support.count <= kAtomsMax;
}

PriceMap take_price_map(BinaryReader& in) {
  const auto table = in.take<std::array<std::int16_t, kPriceCount>>();
  try {
    return PriceMap(table);
  } catch (const UserError& error) {
    fail("{}: {}", in.name(), error.what());
  }
}

ContextClasses take_context(BinaryReader& in) {
  ContextClasses context;
  const auto kind = in.take<std::uint32_t>();
  context.kind = static_cast<ContextKind>(kind);
  for (std::int16_t& edge : context.level_edge_eur_per_mwh) edge = in.take<std::int16_t>();
  if (kind > static_cast<std::uint32_t>(ContextKind::kOutlook) || !context.is_valid()) {
    in.damaged("has impossible context classes");
  }
  return context;
}

Entries take_learnt_for(BinaryReader& in) {
  if (in.version() == kVersionWithoutLearntFor) return {};
  const auto count = in.take<std::uint32_t>();
  if (count > kLearntForMax) in.damaged("has an impossible training scope");
  Entries learnt_for(count);
  for (auto& [name, value] : learnt_for) {
    name = in.take_text();
    value = in.take_text();
  }
  return learnt_for;
}

/// Whole number before scaling to an input.
int unscaled(float input, int scale) {
  return static_cast<int>(
      std::lround(input * static_cast<float>(kInputOne) / static_cast<float>(scale)));
}

/// Program state for five inputs.
StochasticProgram::MarketState market_state_at(const Teacher& teacher, const float* x) {
  const StochasticProgram& program = *teacher.program;
  const int minute = unscaled(x[0], kMinuteOfQuarterHourScale);
  const int quarter_hour = unscaled(x[1], kQuarterHourScale);
  const int context_class = 1 + unscaled(x[2], kContextClassScale);
  return {.step_of_day = (quarter_hour * kMinutesPerQuarterHour + minute) / kMinutesPerStep,
          .row_quarter_hour = program.row_quarter_hour(quarter_hour, minute),
          .price_eur_per_mwh = teacher.price_map.price_of(x[4]),
          .level_eur_per_mwh = teacher.context.kind == ContextKind::kLevel
                                   ? class_level_eur_per_mwh(teacher.context, context_class)
                                   : program.mean_level_eur_per_mwh()};
}

/// The program's values in learned units: EUR over a step -> scaled EUR/h of the paper's 4 MW.
Matrix program_values(const Teacher& teacher, const MatrixRef& x) {
  const StochasticProgram& program = *teacher.program;
  const double scale = learned_per_eur(program.battery());
  Matrix values(kActionCount, x.cols());
  for (Eigen::Index c = 0; c < x.cols(); ++c) {
    const auto worth =
        program.action_values(market_state_at(teacher, x.col(c).data()),
                              double{x(3, c)} * kInputOne / kSocScale / (kSocCount - 1));
    for (int a = 0; a < kActionCount; ++a) {
      values(a, c) = static_cast<float>((worth[a] - worth[1]) * scale);
    }
  }
  return values;
}

}  // namespace

Method parse_method(std::string_view name) {
  if (name == "c51") return Method::kC51;
  if (name == "dqn") return Method::kDqn;
  if (name == "sdp") return Method::kSdp;
  fail("unknown method \"{}\": use c51, dqn or sdp", name);
}

std::string_view method_name(Method method) {
  constexpr std::string_view kNames[] = {"c51", "dqn", "sdp"};
  return kNames[static_cast<int>(method)];
}

MlpShape teacher_shape(Method method, const Support& support) {
  if (method == Method::kSdp) return {};
  const int outputs = method == Method::kC51 ? kActionCount * support.count : kActionCount;
  return {kNetworkInputs, kTeacherHidden1, kTeacherHidden2, outputs};
}

Matrix Teacher::action_values(const MatrixRef& x, MlpTile& tile) const {
  if (outlook) {
    if (x.rows() != kNetworkInputs + kActionCount) {
      fail(
          "a teacher with context = \"outlook\" has values by time, not by lattice point: it "
          "has no map and serves distil only");
    }
    return x.bottomRows(kActionCount);
  }
  if (!program) return network_values(x, tile);
  Matrix values = program_values(*this, x);
  if (is_residual()) values += network_values(x, tile);
  return values;
}

Matrix Teacher::network_values(const MatrixRef& x, MlpTile& tile) const {
  const ConstMlp mlp(shape, parameters.data());
  Matrix z;
  forward_hidden(mlp, x, tile);
  forward_head(mlp, tile, z);
  if (method == Method::kDqn) return z;
  Matrix values = mean_values(support, z);
  if (!is_residual()) return values;
  const float quantum = support.v_max * kResidualQuantum;
  return (values.array() / quantum).round() * quantum;
}

void Teacher::add_network(const MarketStep& step, double soc_frac, Matrix& x, MlpTile& tile,
                          std::array<double, kActionCount>& worth_eur) const {
  write_inputs(step, soc_frac, x.data());
  const Matrix added = network_values(x, tile);
  const double unit_per_eur = learned_per_eur(base_programs().battery());
  for (int a = 0; a < kActionCount; ++a) worth_eur[a] += double{added(a)} / unit_per_eur;
}

void begin_at_zero(Method method, const Support& support, const MlpShape& shape,
                   Parameters& parameters) {
  MutableMlp mlp(shape, parameters.data());
  mlp.w3.setZero();
  mlp.b3.setZero();
  if (method != Method::kC51) return;
  const double others = support.count - 1;
  mlp.b3.setConstant(static_cast<float>(std::log(kPriorMass / (1 - kPriorMass) / others)));
  for (int a = 0; a < kActionCount; ++a) mlp.b3[a * support.count + support.count / 2] = 0;
}

Action TeacherPolicy::decide(const MarketStep& step, std::size_t, double soc_frac) const {
  if (!teacher_.has_program()) {
    teacher_.write_inputs(step, soc_frac, x_.data());
    return argmax_action(teacher_.action_values(x_, tile_).data());
  }
  // The program gets the step itself, not the network's inputs.
  auto worth_eur = outlook_ ? outlook_->action_values(step, soc_frac)
                            : teacher_.program->action_values(
                                  StochasticProgram::market_state_of(step), soc_frac);
  if (teacher_.is_residual()) teacher_.add_network(step, soc_frac, x_, tile_, worth_eur);
  return argmax_action(worth_eur.data());
}

void save_teacher(const std::filesystem::path& path, const Teacher& teacher) {
  BinaryWriter out(kMagic, teacher.outlook && teacher.is_residual()
                               ? kVersion
                               : kVersionWithoutNetworkOnOutlook);
  out.put(static_cast<std::uint32_t>(teacher.method) | (teacher.is_residual() ? kResidualFlag : 0));
  out.put(teacher.support);
  out.put(teacher.shape);
  out.put(teacher.price_map.table());
  out.put(static_cast<std::uint32_t>(teacher.context.kind));
  out.put(teacher.context.level_edge_eur_per_mwh);
  out.put_text(std::string_view(teacher.provenance).substr(0, kProvenanceMax));
  out.put(static_cast<std::uint32_t>(teacher.learnt_for.size()));
  for (const auto& [name, value] : teacher.learnt_for) {
    out.put_text(name);
    out.put_text(value);
  }
  put_parameters(out, teacher.parameters);  // empty for a program
  if (teacher.program) teacher.program->save(out);
  if (teacher.outlook) teacher.outlook->save(out);
  out.save(path);
}

bool is_teacher_file(const std::filesystem::path& path) {
  return std::string_view(read_file(path)).starts_with(kMagic);
}

Teacher load_teacher(const std::filesystem::path& path) {
  BinaryReader in(path, kMagic, kVersion, "teacher file", "make one with 'bess-train train'",
                  kVersionWithoutLearntFor);
  const auto written_method = in.take<std::uint32_t>();
  const bool is_residual = (written_method & kResidualFlag) != 0;
  if ((written_method & kOwnInputsMask) != 0) {
    in.damaged("has more inputs than the student's five ([train] input_...): no longer supported");
  }
  const std::uint32_t method_number = written_method & ~kResidualFlag;
  const auto support = in.take<Support>();
  // The checksum is correct, so another program wrote this: report it before use.
  if (method_number > static_cast<std::uint32_t>(Method::kSdp) ||
      (is_residual && method_number == static_cast<std::uint32_t>(Method::kSdp)) ||
      (method_number != static_cast<std::uint32_t>(Method::kSdp) && !is_possible(support))) {
    in.damaged("has an impossible method or value range");
  }
  const auto method = static_cast<Method>(method_number);
  const auto shape = in.take<MlpShape>();
  if (!(shape == teacher_shape(method, support))) in.damaged("has another network shape");
  const PriceMap price_map = take_price_map(in);
  const ContextClasses context = take_context(in);
  std::string provenance = in.take_text();
  Entries learnt_for = take_learnt_for(in);
  Parameters parameters(shape.parameter_count());
  std::shared_ptr<const StochasticProgram> program;
  take_parameters(in, parameters);
  std::shared_ptr<const OutlookProgram> outlook;
  if (context.is_outlook()) {
    const bool is_sound = is_residual ? in.version() >= kVersion : method == Method::kSdp;
    if (!is_sound) in.damaged("has an outlook network without a plan");
    outlook = std::make_shared<const OutlookProgram>(in);
  } else if (is_residual || method == Method::kSdp)
    program = std::make_shared<const StochasticProgram>(in);
  in.finish();
  Teacher teacher{method,
                  support,
                  shape,
                  price_map,
                  std::move(parameters),
                  std::move(provenance),
                  std::move(program),
                  context,
                  std::move(learnt_for)};
  if (outlook) set_outlook(std::move(outlook), teacher);
  return teacher;
}

void set_outlook(std::shared_ptr<const OutlookProgram> program, Teacher& teacher) {
  teacher.plan_cache = PlanCache::of(outlook_integers(*program));
  teacher.outlook = std::move(program);
}

}  // namespace bess
