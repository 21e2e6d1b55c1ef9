#include "workstation/rl/teacher.h"

#include <cmath>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "workstation/base/binary_file.h"
#include "workstation/rl/c51.h"

namespace bess {
namespace {

constexpr std::string_view kMagic = "BESSTCHR";
constexpr std::uint32_t kVersion = 2;
constexpr int kTeacherHidden1 = 256;
constexpr int kTeacherHidden2 = 128;
constexpr std::size_t kProvenanceMax = 4096;
constexpr int kAtomsMax = 10'000;

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
  if (kind > static_cast<std::uint32_t>(ContextKind::kLevel) || !context.is_valid()) {
    in.damaged("has impossible context classes");
  }
  return context;
}

}  // namespace

Method parse_method(std::string_view name) {
  if (name == "c51") return Method::kC51;
  if (name == "dqn") return Method::kDqn;
  fail("unknown method \"{}\": use c51 or dqn", name);
}

std::string_view method_name(Method method) { return method == Method::kC51 ? "c51" : "dqn"; }

MlpShape teacher_shape(Method method, const Support& support) {
  const int outputs = method == Method::kC51 ? kActionCount * support.count : kActionCount;
  return {kNetworkInputs, kTeacherHidden1, kTeacherHidden2, outputs};
}

Matrix Teacher::action_values(const MatrixRef& x, MlpTile& tile) const {
  const ConstMlp mlp(shape, parameters.data());
  Matrix z;
  forward_hidden(mlp, x, tile);
  forward_head(mlp, tile, z);
  if (method == Method::kDqn) return z;
  return risk.is_mean() ? mean_values(support, z) : risk_values(support, z, risk);
}

Action TeacherPolicy::decide(const MarketStep& step, std::size_t, double soc_frac) const {
  write_input(network_context(step, teacher_.price_map, teacher_.context), soc_frac, x_.data());
  const Matrix values = teacher_.action_values(x_, tile_);
  return argmax_action(values.data());
}

void save_teacher(const std::filesystem::path& path, const Teacher& teacher) {
  BinaryWriter out(kMagic, kVersion);
  out.put(static_cast<std::uint32_t>(teacher.method));
  out.put(teacher.support);
  out.put(teacher.shape);
  out.put(teacher.price_map.table());
  out.put(static_cast<std::uint32_t>(teacher.context.kind));
  out.put(teacher.context.level_edge_eur_per_mwh);
  out.put_text(std::string_view(teacher.provenance).substr(0, kProvenanceMax));
  put_parameters(out, teacher.parameters);
  out.save(path);
}

bool is_teacher_file(const std::filesystem::path& path) {
  return std::string_view(read_file(path)).starts_with(kMagic);
}

Teacher load_teacher(const std::filesystem::path& path) {
  BinaryReader in(path, kMagic, kVersion, "teacher file", "make one with 'bess-train train'");
  const auto method_number = in.take<std::uint32_t>();
  const auto support = in.take<Support>();
  // The checksum is right, so this was written by another program; say so before using any of it.
  if (method_number > static_cast<std::uint32_t>(Method::kDqn) || !is_possible(support)) {
    in.damaged("has an impossible method or value range");
  }
  const auto method = static_cast<Method>(method_number);
  const auto shape = in.take<MlpShape>();
  if (!(shape == teacher_shape(method, support))) in.damaged("is of another network shape");
  const PriceMap price_map = take_price_map(in);
  const ContextClasses context = take_context(in);
  std::string provenance = in.take_text();
  Parameters parameters(shape.parameter_count());
  take_parameters(in, parameters);
  in.finish();
  return {method, support, shape, price_map, std::move(parameters), std::move(provenance), context};
}

Teacher load_teacher(const std::filesystem::path& path, const Risk& risk) {
  Teacher teacher = load_teacher(path);
  if (teacher.method == Method::kDqn && !risk.is_mean()) {
    fail(
        "{}: a dqn teacher knows means only, not how returns are distributed; train a c51 one for "
        "--risk",
        path.string());
  }
  teacher.risk = risk;
  return teacher;
}

}  // namespace bess
